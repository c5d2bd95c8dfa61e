// SPDX-License-Identifier: GPL-3.0-or-later
// Clients that ask for more than is good for others, in a process of their own, pinned to one core so that
// what they cost themselves is not taken for what they cost the daemon.
//
// As a program: flood.mjs URL SPEC, the JSON of start()'s second argument. Each of the viewers keeps
// `pipeline` loops going: of requests, in turn; of bursts of one request, which wait for no answer; of
// sessions, created and destroyed; or of fragments without content, which end the connection again and
// again. When standard input ends it prints {asked, answered, refused: {reason: count}}.
import { spawn } from 'node:child_process';
import { cpus } from 'node:os';
import { createInterface } from 'node:readline';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { Client } from './client.mjs';

export class Flood {
	static async start(url, { what = 'requests', viewers = 2, pipeline = 4, hello = { role: 'view' }, join, requests, definition }) {
		const flood = new Flood();
		const last = String(cpus().length - 1);
		flood.process = spawn('taskset', ['-c', last, 'nice', '-n', '19', process.execPath, fileURLToPath(import.meta.url), url,
			JSON.stringify({ what, viewers, pipeline, hello, join, requests, definition })], { stdio: ['pipe', 'pipe', 'inherit'] });
		flood.lines = createInterface({ input: flood.process.stdout })[Symbol.asyncIterator]();
		await flood.lines.next(); // it floods
		return flood;
	}

	async stop() {
		this.process.stdin.end();
		const { value } = await this.lines.next();
		return JSON.parse(value);
	}

	end() {
		this.process.kill('SIGKILL');
	}
}

const told = { asked: 0, answered: 0, refused: {} };

function refuse(error) {
	const reason = (error.data?.reason ?? error.message).replace(/[\d.]+ s$/, 'some s');
	told.refused[reason] = (told.refused[reason] ?? 0) + 1;
}

// What came is not looked at.
async function open(url, hello) {
	const client = await Client.connect(url, { hello });
	client.onBinary = () => {};
	return client;
}

async function ask(client, method, params) {
	told.asked++;
	try {
		const answer = await client.call(method, params);
		told.answered++;
		return answer;
	} catch (error) {
		refuse(error);
		return null;
	} finally {
		client.transfers.clear();
		client.notices.length = 0;
	}
}

// Fragments in one go: more than a second's messages of a client.
const FRAGMENTS = 4000;

// A burst and its period: the most that max_requests_per_s of 2000 allows in any second.
const BURST = 390, BURST_MS = 250;

const count = () => told.answered++; // an answer to a burst, not parsed

// Sends the requests as one batch of packets. A socket that the daemon does not read is left alone.
async function burst({ url, hello, state, requests: [[method, params]] }) {
	if (state.client.closeCode) {
		refuse(new Error(`closed ${state.client.closeCode}`));
		state.client = await open(url, hello);
		state.client.onText = count;
	}
	const { client } = state, began = performance.now();
	if (client.socket.bufferedAmount < 1 << 20) {
		client.socket._socket.cork();
		for (let i = 0; i < BURST; i++)
			client.socket.send(JSON.stringify({ jsonrpc: '2.0', id: 1e6 + i, method, params }));
		client.socket._socket.uncork();
		told.asked += BURST;
	}
	await new Promise((resolve) => setTimeout(resolve, BURST_MS - (performance.now() - began)));
}

// What a loop does in a turn.
const WAYS = {
	requests: async ({ client, turn, requests }) => ask(client, ...requests[turn % requests.length]),
	sessions: async ({ client, definition }) => {
		const made = await ask(client, 'session.create', { definition });
		if (made)
			await ask(client, 'session.destroy', { session: made.summary.session });
	},
	bursts: burst,
	fragments: async ({ url, hello }) => {
		told.asked++;
		const client = await open(url, hello).catch(refuse);
		for (let i = 0; client && i < FRAGMENTS; i++)
			client.socket.send('', { fin: false }, () => {});
		const closed = await client?.closed;
		refuse(new Error(`closed ${closed?.code}`));
	},
};

async function flood(url, { what, viewers, pipeline, hello, join, requests, definition }) {
	for (let v = 0; v < viewers; v++) {
		const client = await open(url, hello);
		if (join)
			await client.call('session.join', { session: join });
		const state = { client };
		if (what === 'bursts')
			client.onText = count;
		const loop = async () => {
			for (let turn = 0; ; turn++)
				await WAYS[what]({ url, hello, client, state, turn, requests, definition });
		};
		for (let p = 0; p < pipeline; p++)
			void loop();
	}
	console.log('{}');
	for await (const line of createInterface({ input: process.stdin }))
		void line;
	console.log(JSON.stringify(told));
	process.exit(0);
}

if (import.meta.url === pathToFileURL(process.argv[1]).href)
	await flood(process.argv[2], JSON.parse(process.argv[3]));
