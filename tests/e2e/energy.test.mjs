// SPDX-License-Identifier: GPL-3.0-or-later
// Energy is off when it must be: whatever still waits in a queue, and whatever the store says.
import assert from 'node:assert/strict';
import { chmodSync, closeSync, mkdtempSync, openSync, rmSync, writeFileSync, writeSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';
import { smallSession } from './wire/scene.mjs';

const TRIALS = 30;
const TICKS_LOOKED = 4; // after which an enable that still waited would have shown

let daemon, watcher;
before(async () => {
	// The watchdog is patient, so that energy that is on by mistake stays on and is seen.
	daemon = await Daemon.start({ settings: { browser_deadline_s: 10, resume_s: 0 } });
	watcher = await daemon.connect();
});
after(() => daemon.end());

const hook = (session) => ({ session, tool: 'hook' });
const energize = (client, session, energized = true) => client.call('tool.energize', { ...hook(session), energized });

async function staysDark(stream) {
	const tick = stream.tick;
	await watcher.until(() => {
		assert.equal(stream.tools[0].energized, false, `energized at tick ${stream.tick}`);
		return stream.tick > tick + TICKS_LOOKED;
	}, 'some ticks');
}

test('an enable that its page overtakes by hiding lights nothing', async () => {
	const session = await smallSession(watcher, 'hidden');
	const stream = await watcher.join(session, { rate_hz: 1000, channels: ['mask', 'tools'] });
	const client = await daemon.connect();
	await client.call('tool.take_over', hook(session));
	for (let i = 0; i < TRIALS; i++) {
		const asked = energize(client, session).catch((error) => error);
		client.notify('heartbeat', { visible: false });
		await asked;
		await client.call('session.describe', { session }); // the heartbeat came before it
		await staysDark(stream);
	}
	await energize(client, session); // one that nothing overtakes does
	await watcher.until(() => stream.tools[0].energized, 'energy on');
	await client.close();
});

test('a stream tells what a generator gives, and what it finds', async () => {
	const client = await daemon.connect();
	const { summary: { session } } = await client.call('session.create', { name: 'power', scene: 'fascia-power', paused: true });
	const stream = await client.join(session, { rate_hz: 1000, channels: ['tools'] });
	const needle = { session, tool: 'needle' };
	await client.call('tool.take_over', needle);
	await client.call('tool.energize', { ...needle, energized: true });
	const step = async (ticks) => {
		const { tick } = await client.call('session.step', { session, ticks });
		await client.until(() => stream.tick === tick, 'the frame of the step');
		return stream.tools[0];
	};
	const inAir = await step(1);
	assert.deepEqual([inAir.deliveredW, inAir.loadOhm], [0, 0]);
	await client.call('tool.move', { ...needle, position_m: [-0.02, 0, -0.002], rotation: [1, 0, 0, 0] });
	let on = await step(1);
	while (!(on.deliveredW > 0) && stream.tick < 200)
		on = await step(1);
	assert.ok(on.deliveredW > 0 && on.deliveredW <= 30, `${on.deliveredW} W`);
	assert.ok(on.loadOhm > 10 && on.loadOhm < 1e5, `${on.loadOhm} ohm`);
	await client.call('tool.energize', { ...needle, energized: false });
	const off = await step(1);
	assert.deepEqual([off.energized, off.deliveredW, off.loadOhm], [false, 0, 0]);
	await client.close();
});

test('a tool that is removed while its energy is on is turned off first, and its session goes on', async () => {
	const session = await smallSession(watcher, 'removed');
	const stream = await watcher.join(session, { rate_hz: 1000, channels: ['mask', 'tools'] });
	const client = await daemon.connect();
	await client.call('tool.take_over', hook(session));
	await energize(client, session);
	await watcher.until(() => stream.tools[0].energized, 'energy on');
	await client.call('tool.remove', hook(session));
	const { tick } = stream;
	await watcher.until(() => stream.tools.length === 0 && stream.tick > tick + TICKS_LOOKED, 'ticks without the tool');
	const { summary } = await client.call('session.describe', { session });
	assert.equal(summary.state, 'running');
	const { events } = await client.call('session.timeline', { session });
	assert.deepEqual(events.map(({ kind }) => kind).filter((kind) => /^energy|tool_removed|fault/.test(kind)), ['energy_on', 'energy_off', 'tool_removed']);
	await client.close();
});

test('an enable whose connection is lost lights nothing', async () => {
	const session = await smallSession(watcher, 'lost');
	const stream = await watcher.join(session, { rate_hz: 1000, channels: ['mask', 'tools'] });
	for (let i = 0; i < TRIALS; i++) {
		const client = await daemon.connect();
		await client.call('tool.take_over', hook(session));
		client.notify('tool.energize', { ...hook(session), energized: true });
		client.terminate();
		await watcher.until(() => stream.tools[0].driver === 0, 'the driver is forgotten');
		await staysDark(stream);
	}
});

test('energy that is asked for at a later tick stays off for a driver who is lost before', async () => {
	const session = await smallSession(watcher, 'later');
	const stream = await watcher.join(session, { rate_hz: 1000, channels: ['mask', 'tools'] });
	const client = await daemon.connect();
	await client.call('tool.take_over', hook(session));
	const tick = stream.tick + 40;
	client.notify('tool.energize', { ...hook(session), energized: true, tick });
	client.notify('heartbeat', { visible: false });
	await watcher.until(() => {
		assert.equal(stream.tools[0].energized, false, `energized at tick ${stream.tick}`);
		return stream.tick > tick + TICKS_LOOKED;
	}, 'its tick');
	await client.close();
});

// A store on a small disk of its own, in a mount namespace of the daemon's; null where the system lets
// nobody make one.
async function onSmallDisk() {
	const folder = mkdtempSync(join(tmpdir(), 'cautery-small-disk-'));
	const program = join(folder, 'daemon.sh'), disk = join(folder, 'disk');
	writeFileSync(program, `#!/bin/sh
mkdir -p ${disk}
exec unshare --mount sh -c 'mount -t tmpfs -o size=12m tmpfs ${disk} && exec "$0" "$@"' ${process.env.CAUTERYD} "$@"
`);
	chmodSync(program, 0o755);
	try {
		const small = await Daemon.start({ program, settings: { store: join(disk, 'store.db') } });
		small.ballast = `/proc/${small.process.pid}/root${disk}/ballast`;
		small.disk = folder;
		return small;
	} catch (error) {
		rmSync(folder, { recursive: true, force: true });
		return null;
	}
}

function fillDisk(path) {
	const file = openSync(path, 'a'), block = Buffer.alloc(4096, 1);
	try {
		while (writeSync(file, block) > 0)
			;
	} catch (error) {
		assert.equal(error.code, 'ENOSPC');
	}
	closeSync(file);
}

test('a full store: energy goes off by itself, off and pause are never refused, enables are', async (t) => {
	const small = await onSmallDisk();
	if (!small) {
		t.skip('no mount namespace here');
		return;
	}
	const client = await small.connect(), driver = await small.connect();
	const session = await smallSession(client, 'full');
	const stream = await client.join(session, { rate_hz: 1000, channels: ['mask', 'tools'] });
	await driver.call('tool.take_over', hook(session));
	await energize(driver, session);
	await client.until(() => stream.tools[0].energized, 'energy on');
	fillDisk(small.ballast);
	// A request makes the store notice; it may be the one that does not get in.
	await client.call('session.snapshot', { session, name: 'more' }).catch((error) => assert.equal(error.code, -32048));
	await small.log(/store_state state=full/);
	await client.until(() => !stream.tools[0].energized, 'energy off');
	await assert.rejects(energize(driver, session), { code: -32048 });
	assert.equal((await energize(driver, session, false)).stored, false);
	assert.equal((await energize(client, session, false)).stored, false);
	const paused = await client.call('session.pause', { session });
	assert.deepEqual([paused.state, paused.stored], ['paused', false]);
	await client.until(() => stream.flags & 1, 'paused');
	const room = new Promise((resolve) => small.waiters.push({ pattern: /store_state state=ready/, resolve }));
	rmSync(small.ballast);
	await room;
	await client.call('session.resume', { session });
	await energize(driver, session);
	assert.equal((await energize(driver, session, false)).stored, undefined);
	await Promise.all([client.close(), driver.close()]);
	await small.end();
	rmSync(small.disk, { recursive: true, force: true });
});
