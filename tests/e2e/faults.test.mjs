// SPDX-License-Identifier: GPL-3.0-or-later
// Numerical trouble. Faults are made at will: the daemon on the double of the core
// (tests/server/double), which faults on a force of 1,000 N. What is wrong and no fault comes from scenes.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';

const all = { kind: 'box', least_m: [-1, -1, -1], most_m: [1, 1, 1] };

test('a fault stays in its session, is told, outlives a restart, and a rewind heals it', async () => {
	let daemon = await Daemon.start({ program: process.env.CAUTERYD_DOUBLE });
	const client = await daemon.connect(), neighbour = await daemon.connect();
	for (const name of ['sick', 'well'])
		await client.call('session.create', { name, scene: 'fascia' });
	const session = 'd1-sick';
	const stream = await client.join(session), other = await neighbour.join('d1-well');
	await client.until(() => stream.tick > 10, 'running');
	await client.call('force.set', { session, selection: all, force_n: [1000, 0, 0] });
	const told = await client.until(() => client.notice('session.faulted'), 'the news');
	assert.equal(told.params.session, session);
	assert.match(told.params.reason, /beyond reason/);
	await client.until(() => stream.flags & 2, 'the faulted frame');
	await assert.rejects(client.call('session.resume', { session }), { code: -32012 });
	await assert.rejects(client.call('gravity.set', { session, gravity_m_s2: [0, 0, 0] }), { code: -32012 });
	const { sessions } = await client.call('session.list');
	assert.equal(sessions.find((s) => s.session === session).state, 'faulted');
	assert.match(sessions.find((s) => s.session === session).fault, /beyond reason/);
	// What stands still keeps no pace, whatever it did before.
	assert.equal(sessions.find((s) => s.session === session).realtime_factor, 0);
	assert.equal(await daemon.metric('session_realtime_factor', session), 0);
	assert.equal(await daemon.metric('session_faulted', session), 1);
	const tick = other.tick;
	await neighbour.until(() => other.tick > tick + 20, 'the neighbour goes on');
	const back = await client.call('session.rewind', { session, tick: 5 });
	assert.equal(back.tick, 5);
	await client.call('session.resume', { session });
	await client.until(() => stream.tick > 20 && !(stream.flags & 2), 'healed');
	await Promise.all([client.close(), neighbour.close()]);
	await daemon.stop();
	daemon = await Daemon.start({ folder: daemon.folder, program: process.env.CAUTERYD_DOUBLE });
	const again = await daemon.connect();
	assert.equal((await again.call('session.list')).sessions.length, 2);
	await again.close();
	await daemon.end();
});

const slab = (size_m, cells, material) => ({
	meshes: [{ source: 'slab', name: 'slab', size_m, cells }],
	layers: [{ kind: 'fat', name: 'soft', mesh: 'slab', young_modulus_pa: 3000, ...material }],
	tools: [{ name: 'ball', shape: 'sphere', position_m: [0, 0, 0.15] }],
});
// StVK's law holds tetrahedra that were turned inside out, also when the force is gone.
const squashed = { ...slab([0.04, 0.04, 0.01], [8, 8, 2], { model: 'stvk' }), name: 'squashed',
	pins: [{ kind: 'box', layer: 'soft', least_m: [-1, -1, -0.0101], most_m: [1, 1, -0.0099] }] };
const middle = { kind: 'box', layer: 'soft', least_m: [-0.011, -0.011, -0.0005], most_m: [0.011, 0.011, 0.0005] };
// A beam that swings, by steps of one iteration, which is far too few.
const swinging = { ...slab([0.1, 0.02, 0.02], [10, 2, 2], { model: 'corotated' }), name: 'swinging', damping_per_s: 0,
	gravity_m_s2: [0, 0, -9.81], iterations: 1, accuracy: 0,
	pins: [{ kind: 'box', layer: 'soft', least_m: [-0.0501, -1, -1], most_m: [-0.0499, 1, 1] }] };
const eventsOf = async (client, session, kind) =>
	(await client.call('session.timeline', { session })).events.filter((event) => event.kind === kind);

test('what stays inside out is reported with its layer, once, and the session goes on', async () => {
	const daemon = await Daemon.start();
	const client = await daemon.connect();
	await client.call('session.create', { name: 'one', definition: squashed, paused: true });
	const session = 'd1-one';
	await client.join(session);
	await client.call('session.step', { session, ticks: 5 });
	await client.call('force.set', { session, selection: middle, force_n: [0, 0, -0.02] });
	await client.call('session.step', { session, ticks: 28 });
	assert.deepEqual(await eventsOf(client, session, 'inverted'), [], 'not within half a second');
	await client.call('force.set', { session, selection: middle, force_n: [0, 0, 0] });
	await client.call('session.step', { session, ticks: 60 });
	const [event, ...others] = await eventsOf(client, session, 'inverted');
	assert.deepEqual(others, []);
	assert.equal(event.detail, 'soft');
	assert.ok(event.count > 0, `${event.count} tetrahedra`);
	const pushed = client.notice('event', ({ event }) => event.kind === 'inverted');
	assert.ok(pushed, 'who watches is notified');
	assert.notEqual((await client.call('session.describe', { session })).summary.state, 'faulted');
	await client.close();
	await daemon.end();
});

test('steps that gain energy are reported, once in ten seconds', async () => {
	const daemon = await Daemon.start();
	const client = await daemon.connect();
	await client.call('session.create', { name: 'one', definition: swinging, paused: true });
	const session = 'd1-one';
	await client.call('session.step', { session, ticks: 120 });
	const [event, ...others] = await eventsOf(client, session, 'energy_gain');
	assert.deepEqual(others, []);
	const [gained, had] = event.detail.match(/^(.*) J were gained in a tick that began with (.*) J$/).slice(1).map(Number);
	assert.ok(gained > 0.01 * had, event.detail);
	await client.close();
	await daemon.end();
});
