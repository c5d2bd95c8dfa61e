// SPDX-License-Identifier: GPL-3.0-or-later
// What a daemon says at its agent_port, as HAProxy's agent-check asks it.
import assert from 'node:assert/strict';
import net from 'node:net';
import { once } from 'node:events';
import { test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';
import { smallSession } from './wire/scene.mjs';

async function freePort() {
	const server = net.createServer().listen(0, '127.0.0.1');
	await once(server, 'listening');
	const { port } = server.address();
	server.close();
	await once(server, 'close');
	return port;
}

async function ask(port) {
	const socket = net.connect(port, '127.0.0.1');
	let text = '';
	for await (const part of socket)
		text += part;
	return text;
}

const free = (line) => Number(/^ready (\d+)%\n$/.exec(line)?.[1]);

/** Asks until `wanted` holds; the load is measured four times a second and there is no event to await. */
async function askUntil(port, wanted) {
	let line;
	for (const until = performance.now() + 30_000; performance.now() < until;) {
		line = await ask(port);
		if (wanted(line))
			return line;
		await new Promise((resolve) => setTimeout(resolve, 50));
	}
	throw new Error(`it went on saying ${line}`);
}

test('sessions make it less, and a signal makes it none', async () => {
	const port = await freePort();
	const daemon = await Daemon.start({ settings: { agent_port: port, max_sessions: 4 } });
	await askUntil(port, (line) => free(line) > 50);
	const client = await daemon.connect();
	for (const name of ['one', 'two', 'three'])
		await smallSession(client, name, { paused: true });
	await askUntil(port, (line) => free(line) >= 1 && free(line) <= 25);
	daemon.process.kill('SIGUSR1');
	assert.equal(await askUntil(port, (line) => !line.startsWith('ready')), 'drain\n');
	assert.equal((await client.call('session.list', {})).sessions.length, 3); // those go on
	daemon.process.kill('SIGUSR2');
	await askUntil(port, (line) => free(line) >= 1);
	await client.close();
	assert.equal((await daemon.end()).code, 0);
});

test('a daemon that was not told a port has none, and a taken one is said', async () => {
	const port = await freePort();
	const daemon = await Daemon.start();
	assert.ok(!daemon.lines.some((line) => line.includes('agent_listening')));
	const taken = net.createServer().listen(port, '127.0.0.1');
	await once(taken, 'listening');
	await assert.rejects(Daemon.start({ settings: { agent_port: port } }), /agent_port.*cannot listen on 127\.0\.0\.1/);
	taken.close();
	await daemon.end();
});
