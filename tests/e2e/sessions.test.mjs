// SPDX-License-Identifier: GPL-3.0-or-later
// Many clients and sessions: no cross-talk, and a slow one harms itself alone.
import assert from 'node:assert/strict';
import net from 'node:net';
import { after, before, test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';
import { AT_REST, cutMiddle, picture, smallSession } from './wire/scene.mjs';

const slow = process.env.E2E_SLOW === '1'; // a sanitizer's build
let daemon;
before(async () => {
	daemon = await Daemon.start({ settings: { slow_close_s: 1.5 } });
});
after(() => daemon.end());

test('two clients in two sessions see their own only', async () => {
	const [a, b] = await Promise.all([daemon.connect(), daemon.connect()]);
	const left = await smallSession(a, 'left', { paused: true }), right = await smallSession(b, 'right', { paused: true });
	const seenA = await a.join(left, { rate_hz: 1000 }), seenB = await b.join(right, { rate_hz: 1000 });
	const { tick } = await cutMiddle(a, left, 60);
	await a.until(() => seenA.tick === tick, 'the cut');
	assert.ok(seenA.removed() > 0);
	assert.equal(seenB.tick, 0);
	assert.equal(seenB.removed(), 0);
	assert.ok(!b.notices.some((n) => n.params.session === left && n.method !== 'session.changed'));
	assert.equal(seenA.counts.skipped + seenB.counts.skipped, 0);
	await Promise.all([a.close(), b.close()]);
});

test('a second session of a scene begins where the first did, and need not settle', async () => {
	const client = await daemon.connect();
	const seen = [];
	for (const name of ['first', 'second', 'third']) {
		const session = await smallSession(client, name, { paused: true, cells: [22, 18] });
		const stream = await client.join(session, { rate_hz: 1000 });
		const { tick } = await cutMiddle(client, session, 60);
		await client.until(() => stream.tick === tick, 'the cut');
		assert.ok(stream.removed() > 0);
		seen.push(picture(stream));
	}
	assert.ok(seen[0].drawn.size > 300);
	assert.deepEqual(seen[1], seen[0]);
	assert.deepEqual(seen[2], seen[0]);
	const spared = daemon.lines.map((line) => /session=\S+-(first|second|third) event=settled_before/.exec(line)?.[1]);
	assert.deepEqual(spared.filter(Boolean), ['second', 'third']);
	const shared = daemon.lines.map((line) => /-(?:first|second|third) event=built .*shared_bytes=(\d+)/.exec(line)?.[1]);
	assert.equal(shared.filter((bytes) => Number(bytes) > 500_000).length, 3);
	await client.close();
});

test('five clients in one session hold the same state', async () => {
	const clients = await Promise.all(Array.from({ length: 5 }, () => daemon.connect()));
	const session = await smallSession(clients[0], 'shared', { paused: true });
	const streams = await Promise.all(clients.map((c) => c.join(session, { rate_hz: 1000 })));
	const { tick } = await cutMiddle(clients[0], session, 60);
	await Promise.all(clients.map((c, i) => c.until(() => streams[i].tick === tick, 'the last frame')));
	for (const stream of streams) {
		assert.deepEqual(picture(stream), picture(streams[0]));
		assert.equal(stream.tools[0].driver, clients[0].hello.client);
	}
	await Promise.all(clients.map((c) => c.close()));
});

// A client that joins and then never reads again: a plain socket, so that nothing reads for it.
async function deaf(session) {
	const socket = net.connect(daemon.port, '127.0.0.1');
	const masked = (value) => {
		const text = Buffer.from(JSON.stringify(value));
		return Buffer.concat([Buffer.from([0x81, 0xfe, text.length >> 8, text.length & 255, 0, 0, 0, 0]), text]);
	};
	socket.write(`GET /v1 HTTP/1.1\r\nHost: 127.0.0.1:${daemon.port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n`
		+ 'Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: cautery.v1\r\n\r\n');
	await new Promise((resolve) => socket.once('data', resolve));
	const pad = ' '.repeat(100);
	socket.write(masked({ jsonrpc: '2.0', id: 1, method: 'hello', params: { version: 1, client: `deaf${pad}`.slice(0, 60) } }));
	socket.write(masked({ jsonrpc: '2.0', id: `join${pad}`.slice(0, 60), method: 'session.join', params: { session, rate_hz: 1000, step_m: 1e-7 } }));
	await new Promise((resolve) => socket.once('data', resolve));
	socket.pause();
	return socket;
}

// The 95th percentile of the time between frames, over so many ticks.
async function gap95(client, stream, ticks) {
	const gaps = [];
	let last = performance.now();
	client.onFrame = () => {
		gaps.push(performance.now() - last);
		last = performance.now();
	};
	const tick = stream.tick;
	await client.until(() => stream.tick > tick + ticks, `${ticks} ticks`);
	client.onFrame = undefined;
	return gaps.sort((x, y) => x - y)[Math.floor(0.95 * gaps.length)];
}

test('one that stops reading changes nothing for the others, stays bounded, and is closed', async (t) => {
	const client = await daemon.connect();
	// Frames must be large enough to fill the sockets' buffers; a slow build needs no real time for it.
	const session = await smallSession(client, 'deaf', { cells: slow ? [30, 25] : [60, 50] });
	const stream = await client.join(session);
	await client.call('tool.take_over', { session, tool: 'hook' });
	let turn = 0;
	const wave = setInterval(() => client.notify('tool.move', {
		session, tool: 'hook', position_m: [0.02 * Math.sin(turn += 0.1), 0, -0.002], rotation: AT_REST,
	}), 16);
	t.after(() => clearInterval(wave));
	const alone = await gap95(client, stream, 100);
	const before = await daemon.metric('resident_bytes');
	const sockets = await Promise.all(Array.from({ length: 8 }, () => deaf(session)));
	const gone = sockets.map((s) => new Promise((resolve) => s.on('close', resolve).on('error', () => {})));
	const beside = await gap95(client, stream, 150);
	assert.equal(stream.counts.skipped, 0);
	const perClient = (await daemon.metric('resident_bytes') - before) / sockets.length;
	if (process.env.E2E_LOG)
		console.error(`p95 ${alone} ms alone, ${beside} ms beside; ${perClient} bytes a deaf client`);
	if (!slow) {
		// Twice, and a tick: the machine is shared. A client that held the others up would do so for
		// as long as it is deaf.
		assert.ok(beside < 2 * alone + 17, `p95 ${alone} ms alone, ${beside} ms beside`);
		assert.ok(perClient < 256 * 1024, `${perClient} bytes a deaf client`);
	}
	await daemon.log(/event=connection_closing connection=\d+ code=4004/);
	sockets.forEach((s) => s.destroy());
	await Promise.all(gone);
	await client.close();
});

test('a flood of one client leaves the others their pace', async (t) => {
	const calm = await daemon.connect(), loud = await daemon.connect();
	const session = await smallSession(calm, 'calm');
	const stream = await calm.join(session);
	const secondsOf = async (ticks) => {
		const tick = stream.tick, started = performance.now();
		await calm.until(() => stream.tick >= tick + ticks, `${ticks} ticks`);
		return (performance.now() - started) / 1000;
	};
	const quiet = await secondsOf(90);
	const flood = setInterval(() => {
		for (let i = 0; i < 20; i++)
			loud.notify('heartbeat', { visible: true });
	}, 16);
	t.after(() => clearInterval(flood));
	const seconds = await secondsOf(90);
	assert.ok(seconds < 1.5 * Math.max(quiet, 1.5) || slow, `${seconds} s for 1.5 s of ticks, ${quiet} s without the flood`);
	await Promise.all([calm.close(), loud.close()]);
});
