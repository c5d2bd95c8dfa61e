// SPDX-License-Identifier: GPL-3.0-or-later
// session.frame_at: what was, to the bit, while the session goes on and nobody is rewound.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';
import { AT_REST, picture, smallSession } from './wire/scene.mjs';

function shown(state, faces) {
	return { ...picture(state, faces), tools: state.tools.map(({ position, temperature }) => ({ position, temperature })) };
}

// A sheet that is cut from tick 30 on, and what its stream showed at each tick.
async function recorded(daemon, name, ticks = 120) {
	const client = await daemon.connect();
	const session = await smallSession(client, name, { paused: true });
	const stream = await client.join(session, { rate_hz: 1000 });
	const seen = new Map([[0, shown(stream, stream.faces)]]);
	await client.call('tool.take_over', { session, tool: 'hook' });
	for (let tick = 1; tick <= ticks; tick++) {
		if (tick === 30)
			await client.call('tool.energize', { session, tool: 'hook', energized: true });
		await client.call('tool.move', { session, tool: 'hook', position_m: [0.0005 * tick - 0.03, 0, -0.001], rotation: AT_REST });
		await client.call('session.step', { session, ticks: 1 });
		await client.until(() => stream.tick === tick, 'the state after the step');
		seen.set(tick, shown(stream, stream.faces));
	}
	assert.ok(stream.removed() > 0, 'there is a cut');
	return { client, session, stream, seen, tick: ticks };
}

test('every tick looks as it did, in any order, and the session stays where it is', async () => {
	const daemon = await Daemon.start();
	const { client, session, stream, seen, tick } = await recorded(daemon, 'cut');
	const viewer = await daemon.connect();
	const { epoch } = stream;
	for (const at of [tick, 40, 41, 90, 10, 0, 61, 100, tick - 1]) {
		const past = await viewer.past(session, at);
		assert.equal(past.tick, at);
		assert.ok(past.description.exact);
		assert.deepEqual(shown(past, stream.faces), seen.get(at), `tick ${at}`);
	}
	const { summary } = await client.call('session.describe', { session });
	assert.equal(summary.tick, tick);
	assert.equal(stream.epoch, epoch);
	assert.ok(!client.notices.some((n) => n.method === 'session.changed' && n.params.change === 'rewound'));
	assert.ok(!client.notices.some((n) => n.method === 'session.frame_progress'), 'who did not ask is told nothing');
	const progress = viewer.notices.filter((n) => n.method === 'session.frame_progress').map((n) => n.params);
	assert.deepEqual(new Set(progress.map(({ stage }) => stage)), new Set(['building', 'reading', 'restoring', 'replaying']));
	assert.ok(progress.every(({ from_tick, at_tick, tick: to }) => from_tick <= at_tick && at_tick <= to));
	await daemon.end();
});

test('after a rewind the past is that of the line which is left', async () => {
	const daemon = await Daemon.start();
	const { client, session, stream, seen } = await recorded(daemon, 'branches');
	const { epoch } = stream;
	await client.past(session, 100); // a core stands on the line that is left now
	await client.call('session.rewind', { session, tick: 60 });
	await client.call('session.step', { session, ticks: 60 });
	await client.until(() => stream.tick === 120 && stream.epoch !== epoch, 'the last frame');
	const [present, left] = [shown(stream, stream.faces), seen.get(120)];
	const past = shown(await client.past(session, 120), stream.faces);
	assert.deepEqual(past.mask, present.mask);
	assert.deepEqual(past.drawn, present.drawn);
	assert.notDeepEqual(past.mask, left.mask);
	assert.deepEqual(shown(await client.past(session, 50), stream.faces), seen.get(50));
	await daemon.end();
});

test('who may only look may look back; what is not there is refused in words', async () => {
	const daemon = await Daemon.start();
	const { session, stream, tick } = await recorded(daemon, 'refused');
	const viewer = await daemon.connect({ hello: { role: 'view' } });
	await assert.rejects(viewer.past(session, tick + 1), (error) =>
		error.data.path === 'params.tick' && /later than the session's present tick/.test(error.data.reason));
	const past = await viewer.past(session, 100, { channels: ['positions', 'temperature'], step_m: 1e-3 });
	assert.ok(past.temperature.some((steps) => 0.25 * steps - 20 > 40), 'some of it is hot');
	assert.equal(past.tools.length, 0);
	assert.equal(past.description.step_m, 1e-3);
	assert.equal(stream.description.step_m, 5e-5);
	await viewer.call('session.frame_cancel', { session }); // there is nothing to give up, and that is fine
	await daemon.end();
});

test('a session that runs keeps its tissue while somebody looks back, and shows what its log says', async () => {
	const daemon = await Daemon.start({ settings: { checkpoint_s: 0.5 } });
	const client = await daemon.connect();
	const session = await smallSession(client, 'runs');
	const stream = await client.join(session, { rate_hz: 1000 });
	const seen = new Map();
	client.onFrame = (of) => seen.set(of.tick, shown(of, of.faces));
	await client.call('tool.take_over', { session, tool: 'hook' });
	for (let i = 0; i < 40; i++) {
		const from = stream.tick;
		await client.call('tool.move', { session, tool: 'hook', position_m: [0.001 * i - 0.02, 0, -0.002], rotation: AT_REST });
		await client.until(() => stream.tick >= from + 3, 'three ticks');
	}
	for (const at of [...seen.keys()].filter((_, i) => i % 29 === 3))
		assert.deepEqual(shown(await client.past(session, at), stream.faces), seen.get(at), `tick ${at}`);
	await daemon.end();
});
