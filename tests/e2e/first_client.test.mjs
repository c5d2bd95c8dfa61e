// SPDX-License-Identifier: GPL-3.0-or-later
// The programs that README.md and protocol/README.md show, run as they stand there but for the port.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { WebSocket as Plain } from 'ws';
import { Client } from './wire/client.mjs';
import { Daemon } from './wire/daemon.mjs';
import { smallSession } from './wire/scene.mjs';

const Run = Object.getPrototypeOf(async () => {}).constructor;
let daemon, client;
before(async () => {
	daemon = await Daemon.start({ settings: { browser_deadline_s: 1 } });
	client = await daemon.connect();
});
after(() => daemon.end());

// The programs of a page in a language.
function blocksOf(page, language) {
	const blocks = new RegExp(`^\`\`\`${language}\\n([^]*?)^\`\`\`$`, 'gm');
	return [...readFileSync(join(process.env.PAGES, page), 'utf8').matchAll(blocks)].map(([, text]) => text);
}

// The one program of a page, and what it logs. As in a browser, text comes as a string.
function run(page) {
	const blocks = blocksOf(page, 'js');
	const [program] = blocks.filter((text) => text.startsWith('const socket = new WebSocket('));
	assert.ok(program.includes('ws://127.0.0.1:8740/v1'));
	const logged = [], sockets = [];
	class Socket extends Plain {
		constructor(...options) {
			super(...options);
			sockets.push(this);
		}
	}
	const over = new Run('WebSocket', 'console', program.replace('127.0.0.1:8740', `127.0.0.1:${daemon.port}`))(
		Socket, { log: (...words) => logged.push(words) });
	return { over, logged, end: () => sockets.forEach((socket) => socket.close()) };
}

test('the first client of README.md sees vertices and frames', async () => {
	await smallSession(client, 'layers');
	const { over, logged, end } = run('README.md');
	await over;
	const said = (word) => logged.some((words) => words.includes(word));
	for (const until = performance.now() + 20_000; !(said('vertices') && said('a frame of')) && performance.now() < until;)
		await new Promise((resolve) => setTimeout(resolve, 50)); // it tells nobody
	end();
	assert.ok(logged.find((words) => words.includes('vertices'))[0] > 100);
	assert.ok(logged.find((words) => words.includes('a frame of'))[1] > 100);
});

const PYTHON = '/usr/bin/python3'; // Debian's, which Debian's packages are for
const noPackage = spawnSync(PYTHON, ['-c', 'import websocket']).status !== 0 && 'python3-websocket is not installed';

test('the first client in Python likewise', { skip: noPackage }, async () => {
	const [program, ...others] = blocksOf('README.md', 'python');
	assert.equal(others.length, 0);
	assert.ok(program.includes('ws://127.0.0.1:8740/v1'));
	const python = spawn(PYTHON, ['-u', '-c', program.replace('127.0.0.1:8740', `127.0.0.1:${daemon.port}`)]);
	let said = '';
	python.stderr.on('data', (text) => (said += text));
	await new Promise((resolve) => {
		const timer = setTimeout(resolve, 20_000);
		python.stdout.on('data', (text) => {
			said += text;
			if (!/^\d+ vertices$/m.test(said) || !/^a frame of \d+ bytes$/m.test(said)) return;
			clearTimeout(timer);
			resolve();
		});
	});
	python.kill();
	assert.ok(Number(/^(\d+) vertices$/m.exec(said)?.[1]) > 100, said);
	assert.ok(Number(/^a frame of (\d+) bytes$/m.exec(said)?.[1]) > 100, said);
});

test('the first cut of protocol/README.md cuts', async () => {
	const { over, logged, end } = run('protocol/README.md');
	await over;
	end();
	const [[cuts]] = logged;
	assert.ok(cuts.length > 0 && cuts.every(({ kind, count }) => kind === 'cut' && count > 0), JSON.stringify(cuts));
	const { summary } = await client.call('session.describe', { session: 'd1-first' });
	assert.equal(summary.state, 'paused');
});

test('as protocol/README.md says, nobody drives a tool of the scene, and bits of the first mask are the faces inside', async () => {
	const { summary } = await client.call('session.create', { name: 'inside', scene: 'layers', paused: true });
	const stream = await client.join(summary.session);
	assert.ok(stream.tools.length > 0 && stream.tools.every(({ driver }) => driver === 0));
	const sides = new Map(); // how many drawn faces have an edge
	let inside = 0;
	for (let face = 0; face < summary.face_count; face++) {
		inside += stream.isRemoved(face);
		const corners = stream.faces.slice(3 * face, 3 * face + 3);
		for (let i = 0; i < 3 && !stream.isRemoved(face); i++) {
			const edge = [corners[i], corners[(i + 1) % 3]].sort((a, b) => a - b).join();
			sides.set(edge, (sides.get(edge) ?? 0) + 1);
		}
	}
	assert.ok(inside > 100 && inside < summary.face_count - 100, `${inside} of ${summary.face_count}`);
	assert.ok([...sides.values()].every((count) => count <= 2), 'what is drawn is a skin: two faces at most meet in an edge');
});

// ---- the dialogue of protocol/examples.md

// [what the client sends, the answers and notices that come then] of each line of the client's.
function dialogue() {
	const page = readFileSync(join(process.env.PAGES, 'protocol', 'examples.md'), 'utf8');
	const turns = [];
	for (const line of /^## A dialogue$[^]*?^```\n([^]*?)^```$/m.exec(page)[1].trim().split('\n')) {
		const message = line.startsWith('{', 2) ? JSON.parse(line.slice(2)) : null;
		if (line.startsWith('> ') && message)
			turns.push({ asked: message, told: [] });
		else if (line.startsWith('< '))
			turns.at(-1).told.push(message ?? line.slice(2));
	}
	return turns;
}

// What a message is made of: its members and their types, whatever their values.
function form(value) {
	if (Array.isArray(value))
		return value.length ? [form(value[0])] : [];
	if (value === null || typeof value !== 'object')
		return typeof value;
	return Object.fromEntries(Object.entries(value).map(([name, member]) => [name, form(member)]));
}

test('a daemon answers the dialogue of protocol/examples.md as it stands there', async () => {
	await smallSession(client, 'demo', { cells: [6, 5] });
	const url = daemon.url();
	const robot = new Client(url), answers = new Map();
	await robot.opened;
	const onText = robot.onText.bind(robot);
	robot.onText = (data) => {
		const message = JSON.parse(data.toString());
		if ('id' in message)
			answers.set(message.id, message);
		onText(data);
	};
	const turns = dialogue();
	assert.ok(turns.length >= 7, `${turns.length} turns`);
	let stream, frames = 0;
	robot.onFrame = () => frames++;
	for (const { asked, told } of turns) {
		const answer = told.find((message) => message.id !== undefined && !message.method);
		assert.equal(Boolean(answer), 'id' in asked, 'a request is answered, a notification never');
		if (!answer) {
			robot.send(asked);
			continue;
		}
		const before = frames;
		robot.calls.set(asked.id, { method: asked.method, resolve: () => {}, reject: () => {} });
		robot.send(asked);
		await robot.until(() => answers.get(asked.id), `an answer to ${asked.method}`);
		const got = answers.get(asked.id);
		assert.deepEqual(form(got), form(answer), asked.method);
		if (answer.error)
			assert.deepEqual(got.error, answer.error);
		for (const shown of told.filter(({ method }) => method)) {
			const { params } = await robot.until(() => robot.notice(shown.method), shown.method);
			assert.deepEqual(form(params), form(shown.params), shown.method);
		}
		if (asked.method === 'session.join')
			stream = robot.streams.get(got.result.session_number);
		if (told.some((message) => typeof message === 'string' && message.startsWith('(binary)')))
			await robot.until(() => frames > before && stream.synced, `a frame after ${asked.method}`);
		if (asked.method === 'tool.energize')
			await robot.until(() => stream.tools.find(({ name }) => name === asked.params.tool).energized, 'energy is on');
	}
	assert.equal(robot.stray, undefined);
	await robot.close();
});
