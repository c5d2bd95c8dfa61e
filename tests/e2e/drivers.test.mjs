// SPDX-License-Identifier: GPL-3.0-or-later
// Who drives a tool, and how its energy goes off.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';
import { AT_REST, smallSession } from './wire/scene.mjs';

const slow = process.env.E2E_SLOW === '1';

// The watchdog of most tests is patient: this process must not be kept waiting for longer than that.
let daemon, admin;
before(async () => {
	daemon = await Daemon.start({ settings: { resume_s: slow ? 20 : 3 } });
	admin = await daemon.connect();
});
after(() => daemon.end());

const operator = (of = daemon) => of.connect({ hello: { role: 'operate', client: 'operator' } });
const hook = (session) => ({ session, tool: 'hook' });
const move = (client, session, x = 0, sequence = 0) =>
	client.notify('tool.move', { ...hook(session), position_m: [x, 0, 0.02], rotation: AT_REST, sequence });

// Sends motion like a hand does until `stop` is called.
function drive(client, session) {
	let sequence = 0;
	const timer = setInterval(() => move(client, session, 0.001 * (sequence % 10), ++sequence), 16);
	timer.unref(); // a test that fails must not keep the process
	return () => clearInterval(timer);
}

async function energized(client, session) {
	const stream = await client.join(session);
	await client.call('tool.take_over', hook(session));
	const stop = drive(client, session);
	await client.call('tool.energize', { ...hook(session), energized: true });
	await client.until(() => stream.tools[0].energized, 'energy on');
	return { stream, stop };
}

test('a tool without driver is moved by nobody', async () => {
	const client = await operator();
	const session = await smallSession(client, 'nobody');
	await assert.rejects(client.call('tool.move', { ...hook(session), position_m: [0, 0, 0.02], rotation: AT_REST }),
		{ code: -32045 });
	await assert.rejects(client.call('tool.energize', { ...hook(session), energized: true }), { code: -32045 });
	await client.close();
});

test('one driver at a time; only an admin takes a tool from its driver; energy off', async () => {
	const first = await operator(), second = await operator();
	const session = await smallSession(first, 'one');
	const { stream, stop } = await energized(first, session);
	await assert.rejects(second.call('tool.take_over', hook(session)), { code: -32043 });
	await assert.rejects(second.call('tool.energize', { ...hook(session), energized: true }), { code: -32045 });
	const taken = await admin.call('tool.take_over', hook(session));
	assert.equal(taken.client, admin.hello.client);
	assert.equal(taken.energized, false);
	await first.until(() => stream.tools[0].driver === admin.hello.client, 'the new driver in a frame');
	assert.equal(stream.tools[0].energized, false);
	assert.equal(stream.tools[0].energyOff, 'taken_over');
	await first.until(() => first.notice('tool.refused', (p) => p.count > 0), 'refusals of the old driver');
	stop();
	await Promise.all([first.close(), second.close()]);
});

test('anybody who may operate turns energy off, and a driver hands over', async () => {
	const first = await operator(), second = await operator();
	const session = await smallSession(first, 'hand');
	const { stream, stop } = await energized(first, session);
	await second.call('tool.energize', { ...hook(session), energized: false });
	await first.until(() => !stream.tools[0].energized, 'energy off');
	assert.equal(stream.tools[0].energyOff, 'commanded');
	await assert.rejects(second.call('tool.hand_over', hook(session)), { code: -32045 });
	await second.call('tool.request_takeover', hook(session));
	const asked = await first.until(() => first.notice('takeover.requested'), 'the request');
	assert.equal(asked.params.client, second.hello.client);
	stop();
	await first.call('tool.hand_over', { ...hook(session), client: asked.params.client });
	move(second, session, 0.01, 77);
	await first.until(() => stream.tools[0].sequence === 77, 'the new driver\'s motion');
	await Promise.all([first.close(), second.close()]);
});

// How quickly it goes off, to the millisecond and for every way to fall silent, is watchdog.test.mjs.
test('after silence energy is off, and stays off until it is enabled', async (t) => {
	const strict = await Daemon.start({ settings: { browser_deadline_s: slow ? 2.5 : 0.25 } });
	t.after(() => strict.end());
	const client = await operator(strict);
	const session = await smallSession(client, 'silent');
	const { stream, stop } = await energized(client, session);
	stop();
	await client.until(() => !stream.tools[0].energized, 'energy off');
	assert.equal(stream.tools[0].energyOff, 'watchdog');
	assert.ok(stream.tools[0].frozen);
	await strict.log(/session=d1-silent event=watchdog tick=\d+ tool=hook/);
	move(client, session, 0.01, 500);
	await client.until(() => stream.tools[0].sequence === 500, 'motion again');
	assert.equal(stream.tools[0].energized, false);
	assert.equal(stream.tools[0].frozen, false);
	const seen = client.until(() => stream.tools[0].energized, 'energy on again');
	await client.call('tool.energize', { ...hook(session), energized: true });
	await seen;
	await client.close();
});

test('heartbeats keep energy on while the hand rests', async (t) => {
	const deadline = slow ? 10 : 2; // longer than this process can be kept waiting
	const strict = await Daemon.start({ settings: { browser_deadline_s: deadline } });
	t.after(() => strict.end());
	const client = await operator(strict);
	const session = await smallSession(client, 'resting');
	const { stream, stop } = await energized(client, session);
	stop();
	const beat = setInterval(() => client.notify('heartbeat', { visible: true }), 80);
	t.after(() => clearInterval(beat));
	const published = stream.published;
	await client.until(() => stream.published > published + 2e6 * deadline, 'twice the deadline');
	assert.ok(stream.tools[0].energized);
	await client.close();
});

test('a hidden page cuts energy at once', async () => {
	const client = await operator();
	const session = await smallSession(client, 'hidden');
	const { stream, stop } = await energized(client, session);
	stop();
	client.notify('heartbeat', { visible: false });
	await client.until(() => !stream.tools[0].energized, 'energy off, long before the deadline of ten seconds');
	assert.equal(stream.tools[0].energyOff, 'watchdog');
	await daemon.log(/session=d1-hidden event=watchdog .*the driver's page is hidden/);
	await client.close();
});

test('a lost connection cuts energy; its token takes the tool back within the time, energy off', async () => {
	const client = await operator();
	const session = await smallSession(client, 'lost');
	const { stop } = await energized(client, session);
	const watcher = await operator();
	const stream = await watcher.join(session);
	stop();
	client.terminate();
	await watcher.until(() => !stream.tools[0].energized, 'energy off');
	await assert.rejects(watcher.call('tool.take_over', hook(session)), { code: -32043 });
	const again = await daemon.connect({ hello: { role: 'operate', resume: client.hello.resume } });
	assert.equal(again.hello.client, client.hello.client);
	await again.call('tool.move', { ...hook(session), position_m: [0, 0, 0.03], rotation: AT_REST });
	assert.equal(stream.tools[0].energized, false);
	again.terminate();
	await watcher.until(() => stream.tools[0].driver === 0, 'no driver after the time');
	await watcher.call('tool.take_over', hook(session));
	await watcher.close();
});

test('a resumed connection closes the one before it', async () => {
	const first = await operator();
	const second = await daemon.connect({ hello: { resume: first.hello.resume } });
	assert.equal((await first.closed).code, 4007);
	await second.close();
});

test('pausing and rewinding cut energy', async () => {
	const client = await operator();
	const session = await smallSession(client, 'pausing');
	const { stream, stop } = await energized(client, session);
	await client.call('session.pause', { session });
	await client.until(() => !stream.tools[0].energized || stream.tools[0].energyOff === 'commanded', 'the pause');
	await client.call('session.resume', { session });
	await client.call('tool.energize', { ...hook(session), energized: true });
	await client.until(() => stream.tools[0].energized, 'energy on');
	const tick = stream.tick - 2;
	await client.call('session.rewind', { session, tick });
	await client.until(() => !stream.tools[0].energized, 'energy off after the rewind');
	assert.equal(stream.tools[0].energyOff, 'restored');
	stop();
	await client.close();
});

test('motion of a tick is coalesced, and the newest counts', async () => {
	const client = await operator();
	const session = await smallSession(client, 'coalesced');
	const stream = await client.join(session);
	await client.call('tool.take_over', hook(session));
	const before = await daemon.metric('session_motions_total', session), tick = stream.tick;
	for (let i = 1; i <= 500; i++)
		move(client, session, 0.01, i);
	await client.until(() => stream.tools[0].sequence === 500, 'the newest');
	const applied = await daemon.metric('session_motions_total', session) - before;
	const ticks = stream.tick - tick;
	assert.ok(applied >= 1 && applied <= ticks + 2 && applied < 500, `${applied} of 500 applied in ${ticks} ticks`);
	await client.close();
});

test('a viewer may look but not touch', async () => {
	const viewer = await daemon.connect({ hello: { role: 'view' } });
	assert.equal(viewer.hello.role, 'view');
	const session = await smallSession(admin, 'looked-at');
	await viewer.join(session);
	await assert.rejects(viewer.call('session.pause', { session }), { code: -32043 });
	await assert.rejects(viewer.call('tool.take_over', hook(session)), { code: -32043 });
	await assert.rejects(viewer.call('session.create', { scene: 'fascia' }), { code: -32043 });
	await viewer.close();
});
