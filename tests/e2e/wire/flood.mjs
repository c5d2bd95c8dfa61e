// SPDX-License-Identifier: GPL-3.0-or-later
// Clients that ask for more than is good for others, in a process of their own, pinned to one core so that
// what they cost themselves is not taken for what they cost the daemon.
//
// As a program: flood.mjs URL VIEWERS PIPELINE METHOD PARAMS... Each viewer keeps PIPELINE requests under
// way, of the METHODs in turn, and when standard input ends prints {answered, refused: {reason: count}}.
import { spawn } from 'node:child_process';
import { cpus } from 'node:os';
import { createInterface } from 'node:readline';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { Client } from './client.mjs';

export class Flood {
	static async start(url, { viewers = 2, pipeline = 4, role = 'view', requests }) {
		const flood = new Flood();
		const last = String(cpus().length - 1);
		flood.process = spawn('taskset', ['-c', last, process.execPath, fileURLToPath(import.meta.url), url,
			JSON.stringify({ viewers, pipeline, role, requests })], { stdio: ['pipe', 'pipe', 'inherit'] });
		flood.lines = createInterface({ input: flood.process.stdout })[Symbol.asyncIterator]();
		await flood.lines.next(); // it floods
		return flood;
	}

	async stop() {
		this.process.stdin.end();
		const { value } = await this.lines.next();
		return JSON.parse(value);
	}
}

async function flood(url, { viewers, pipeline, role, requests }) {
	const told = { answered: 0, refused: {} };
	let stopping = false;
	const loop = async (client) => {
		for (let i = 0; !stopping; i++) {
			const [method, params] = requests[i % requests.length];
			try {
				await client.call(method, params);
				told.answered++;
			} catch (error) {
				const reason = error.data?.reason ?? error.message;
				told.refused[reason] = (told.refused[reason] ?? 0) + 1;
			}
			client.transfers.clear();
			client.notices.length = 0;
		}
	};
	const loops = [];
	for (let v = 0; v < viewers; v++) {
		const client = await Client.connect(url, { hello: { role } });
		client.onBinary = () => {}; // what comes is not looked at
		for (let p = 0; p < pipeline; p++)
			loops.push(loop(client));
	}
	console.log('{}');
	for await (const line of createInterface({ input: process.stdin }))
		void line;
	stopping = true;
	console.log(JSON.stringify(told));
	process.exit(0);
}

if (import.meta.url === pathToFileURL(process.argv[1]).href)
	await flood(process.argv[2], JSON.parse(process.argv[3]));
