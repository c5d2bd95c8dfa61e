// SPDX-License-Identifier: GPL-3.0-or-later
// Connections without hello keep nobody out who has a token.
import assert from 'node:assert/strict';
import { fork } from 'node:child_process';
import { once } from 'node:events';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { connect } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { Client } from './wire/client.mjs';
import { Daemon } from './wire/daemon.mjs';
import { AT_REST, smallSession } from './wire/scene.mjs';

const TOKEN = 'driver-token-0123456789', STRANGERS = 1150, CLASS = 40;
const TRIES = process.env.E2E_SLOW === '1' ? 10 : 60;
const WITHIN_S = process.env.E2E_SLOW === '1' ? 10 : 1;
const folder = mkdtempSync(join(tmpdir(), 'cautery-strangers-'));
// The second daemon has no strangers. It measures how long the machine itself keeps a connection waiting.
let daemon, quiet;
before(async () => {
	writeFileSync(join(folder, 'tokens'), `operate ${TOKEN}\n`, { mode: 0o600 });
	const settings = { tokens: join(folder, 'tokens') };
	[daemon, quiet] = [await Daemon.start({ settings }), await Daemon.start({ settings })];
});
after(async () => {
	await Promise.all([daemon.end(), quiet.end()]);
	rmSync(folder, { recursive: true });
});

async function crowd(t, address, kind) {
	const program = fork(new URL('wire/strangers.mjs', import.meta.url), [daemon.port, address, STRANGERS, kind]);
	t.after(() => program.kill('SIGKILL'));
	await new Promise((resolve) => program.once('message', resolve));
}

async function enter(into = daemon) {
	const began = performance.now();
	const client = await into.connect({ hello: { token: TOKEN } });
	return { client, seconds: (performance.now() - began) / 1000 };
}

async function enterAndLeave(into) {
	const { client, seconds } = await enter(into);
	await client.close();
	return seconds;
}

for (const kind of ['silent', 'partial', 'upgrade', 'chatty'])
	for (const address of ['127.0.0.1', '127.0.0.2'])
		test(`beside ${STRANGERS} connections (${kind}) of ${address} that never say hello, a driver gets in each time`, async (t) => {
			await crowd(t, address, kind);
			const failures = [];
			let longest = 0, baseline = 0;
			for (let i = 0; i < TRIES; i++) {
				baseline = Math.max(baseline, await enterAndLeave(quiet));
				await enterAndLeave(daemon).then((seconds) => {
					longest = Math.max(longest, seconds);
				}, (error) => failures.push(error.message));
			}
			t.diagnostic(`longest ${longest.toFixed(3)} s, without strangers ${baseline.toFixed(3)} s, ${failures.length} of ${TRIES} failed`);
			assert.deepEqual(failures, []);
			assert.ok(longest < baseline + WITHIN_S, `${longest} s, without strangers ${baseline} s`);
		});

// A message of such a client takes so long to the daemon: it comes by satellite, or from a busy machine.
const FAR_MS = 250;
for (const kind of ['upgrade', 'chatty'])
	for (const address of ['127.0.0.1', '127.0.0.2'])
		test(`beside ${STRANGERS} connections (${kind}) of ${address} that never say hello, a driver far away gets in`, async (t) => {
			await crowd(t, address, kind);
			await Promise.all(Array.from({ length: 8 }, async () => {
				const client = new Client(daemon.url());
				await client.opened;
				await new Promise((resolve) => setTimeout(resolve, FAR_MS));
				assert.equal(client.closeCode, undefined, 'it is closed before its hello comes');
				await client.call('hello', { version: 1, client: 'e2e', token: TOKEN });
				await client.close();
			}));
		});

test(`${CLASS} drivers of one address get in at once, beside the strangers of another`, async (t) => {
	await crowd(t, '127.0.0.2', 'upgrade');
	const all = await Promise.all(Array.from({ length: CLASS }, () => enter()));
	assert.ok(all.every(({ seconds }) => seconds < 2 * WITHIN_S), `${Math.max(...all.map(({ seconds }) => seconds))} s`);
	await Promise.all(all.map(({ client }) => client.close()));
});

test('a driver that lost its connection comes back to its tools where all places are taken since', async (t) => {
	const own = await Daemon.start({ settings: { max_connections: 2 } });
	t.after(() => own.end());
	const [driver, other] = [await own.connect(), await own.connect()];
	const session = await smallSession(driver, 'kept', { paused: true });
	await driver.call('tool.take_over', { session, tool: 'hook' });
	driver.terminate();
	await driver.closed;
	const third = await own.connect();
	const beyond = new Client(own.url());
	assert.equal((await beyond.closed).code, 1013);
	const again = await own.connect({ hello: { resume: driver.hello.resume } });
	await again.call('tool.move', { session, tool: 'hook', position_m: [0, 0, 0.02], rotation: AT_REST });
	await Promise.all([other, third, again].map((client) => client.close()));
});

const UPGRADE = 'GET /v1 HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n'
	+ 'Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: cautery.v1\r\n\r\n';

/** A socket that is connected, has sent nothing, and has `ended` once the daemon ended it. */
async function rawSocket(port) {
	const socket = connect({ port, host: '127.0.0.1' });
	socket.on('error', () => {});
	socket.ended = false;
	socket.on('close', () => {
		socket.ended = true;
	});
	await once(socket, 'connect');
	return socket;
}

// One address may have 128 connections without a request, and twice as many for a second.
test('who is a moment late with its request is not ended for 200 that its address opened since', async (t) => {
	const own = await Daemon.start();
	t.after(() => own.end());
	const driver = await rawSocket(own.port), strangers = [];
	while (strangers.length < 200)
		strangers.push(await rawSocket(own.port));
	driver.write(UPGRADE);
	assert.match((await once(driver, 'data')).toString(), /^HTTP\/1.1 101 /);
	await new Promise((resolve) => setTimeout(resolve, 1100));
	const last = await rawSocket(own.port);
	await (await own.connect()).close(); // it has met all of them
	if (!strangers[0].ended)
		await once(strangers[0], 'close'); // after a second the oldest is ended
	assert.ok(!last.ended, 'the newest is not');
	[...strangers, last, driver].forEach((socket) => socket.destroy());
});

/** Opens a WebSocket from an address, or is refused, and goes. */
function comeAndGo(port, address, request) {
	return new Promise((resolve) => {
		const socket = connect({ port, host: '127.0.0.1', localAddress: address });
		socket.on('connect', () => socket.write(request));
		socket.once('data', () => socket.destroy());
		socket.on('error', () => {});
		socket.on('close', resolve);
	});
}

test('a shell that gives 1,024 descriptors does not limit the daemon to them', async (t) => {
	const program = join(folder, 'few-files');
	writeFileSync(program, `#!/bin/sh\nulimit -S -n 1024\nexec '${process.env.CAUTERYD}' "$@"\n`, { mode: 0o755 });
	const own = await Daemon.start({ program });
	t.after(() => own.end());
	const most = /^Max open files +(\d+) +(\d+)/m.exec(readFileSync(`/proc/${own.process.pid}/limits`, 'utf8'));
	assert.equal(Number(most[1]), Math.min(8192, Number(most[2])));
});

test('whoever says no hello writes one line a minute, and all beyond 63 addresses write one together', async (t) => {
	const own = await Daemon.start();
	t.after(() => own.end());
	const began = performance.now();
	for (let i = 0; i < 300; i++)
		await comeAndGo(own.port, `127.0.1.${1 + i % 100}`, i % 2 ? UPGRADE : UPGRADE.replace('cautery.v1', 'nobody'));
	await own.log(/event=ended_without_hello address=others/);
	await (await own.connect()).close();
	const addresses = own.lines.filter((line) => line.includes('event=ended_without_hello'))
		.map((line) => /address=(\S+)/.exec(line)[1]);
	assert.ok(performance.now() - began < 60_000, 'all of it came within the first minute');
	assert.equal(new Set(addresses).size, 64);
	assert.equal(addresses.length, 64);
	assert.ok(!own.lines.some((line) => /handshake_refused|connection_closing.*without hello/.test(line)));
});
