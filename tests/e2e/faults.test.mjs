// SPDX-License-Identifier: GPL-3.0-or-later
// Numerical trouble, made at will: the daemon on the double of the core (tests/server/double), which
// faults on a force of 1,000 N.
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
