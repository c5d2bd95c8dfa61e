// SPDX-License-Identifier: GPL-3.0-or-later
// A blood vessel through the daemon: its scene is checked, a cut makes it bleed, in frames, answers and events, and a
// reset makes it whole.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';

const UPRIGHT = [1, 0, 0, 0], DEEP_M = -0.007, BESIDE_M = -0.006, TICKS = 60;
const PARTED = 1, BLEEDS = 16;

// A strip of 16 x 4 x 3 mm, with an artery along it and a needle above.
const strip = {
	name: 'strip', energy: 'tissue', cell_m: 0.0004, parting: 'elements',
	meshes: [{ source: 'slab', name: 'strip', size_m: [0.016, 0.004, 0.003], cells: [16, 4, 3] }],
	layers: [{ kind: 'fat', name: 'strip', mesh: 'strip', tissue: 'connective', young_modulus_pa: 60000 }],
	pins: [-1, 1].map((end) => ({
		kind: 'box', layer: 'strip', least_m: [0.008 * end - 0.0001, -1, -1], most_m: [0.008 * end + 0.0001, 1, 1] })),
	tools: [{
		name: 'needle', shape: 'capsule', hot_radius_m: 0.0003, tip_length_m: 0.01, grid_step_m: 0.0003, power_w: 40,
		position_m: [0, BESIDE_M, 0.02] }],
	vessels: [{
		name: 'artery', layer: 'strip', radius_m: 0.001, wall_m: 0.0002, end_pressure_pa: 4000,
		points: [{ at_m: [-0.008, 0, -0.0015] }, { at_m: [0.008, 0, -0.0015] }] }],
};

let daemon;
before(async () => {
	daemon = await Daemon.start();
});
after(() => daemon.end());

const eventsOf = async (client, session) =>
	(await client.call('session.timeline', { session })).events.filter(({ kind }) => kind.startsWith('bleeding') || kind === 'sealed');

// Draws the energized needle across the strip, in lock-step. `seen` gets the observation of each tick.
async function divide(client, session, seen) {
	const advance = async (method, more, ticks) => {
		const commands = [{ method, tool: 'needle', ...more }];
		return client.call('session.advance', { session, ticks, commands, observe: { channels: ['tools', 'vessels', 'blood'] } });
	};
	await client.call('tool.take_over', { session, tool: 'needle' });
	await advance('tool.move', { position_m: [0, BESIDE_M, DEEP_M], rotation: UPRIGHT }, 30);
	await advance('tool.energize', { energized: true }, 1);
	let last;
	for (let k = 1; k <= TICKS; k++) {
		last = await advance('tool.move', { position_m: [0, BESIDE_M - 2 * BESIDE_M * k / TICKS, DEEP_M], rotation: UPRIGHT }, 1);
		await seen(last);
	}
	return advance('tool.energize', { energized: false }, 1);
}

test('a cut vessel bleeds: frames, answers and events say the same, and a reset makes it whole', async () => {
	const client = await daemon.connect();
	const { summary: { session } } = await client.call('session.create', { name: 'cut', definition: strip, paused: true });
	const stream = await client.join(session, { rate_hz: 1000, channels: ['positions', 'vessels', 'blood'] });
	assert.deepEqual(stream.vessels.map(({ name, flags, shedM3 }) => ({ name, flags, shedM3 })), [{ name: 'artery', flags: 0, shedM3: 0 }]);
	assert.equal(stream.vessels[0].points[0][0], Math.fround(-0.008));
	assert.deepEqual(await eventsOf(client, session), []);
	const { vessels: [artery], scalars: [blood] } = await divide(client, session, async ({ tick, vessels: [told] }) => {
		await client.until(() => stream.tick === tick, 'the frame of the tick');
		const [shown] = stream.vessels;
		assert.equal(shown.shedM3, Math.fround(told.shed_m3));
		assert.equal(shown.bleedingM3s, Math.fround(told.bleeding_m3_s));
		assert.equal((shown.flags & BLEEDS) !== 0, told.bleeds);
		assert.equal((shown.flags & PARTED) !== 0, told.parted);
	});
	assert.ok(artery.parted && artery.bleeds && !artery.sealed && artery.burst_pa < 12000, JSON.stringify(artery));
	assert.ok(artery.bleeding_m3_s > 1e-6 && artery.shed_m3 > 0);
	assert.equal(blood.channel, 'blood');
	assert.ok(Math.max(...blood.values) > 1e-4 && Math.min(...blood.values) === 0);
	assert.ok(stream.vessels[0].points.some(([, , , open]) => open < 0), 'a gap in the line');
	assert.deepEqual((await eventsOf(client, session)).map(({ kind, detail }) => [kind, detail]), [['bleeding', 'artery']]);
	await client.call('session.reset', { session });
	await client.until(() => stream.vessels[0].flags === 0 && stream.vessels[0].shedM3 === 0, 'a whole vessel');
	await client.call('session.step', { session, ticks: 1 });
	assert.deepEqual(await eventsOf(client, session), [], 'of the new line');
	await client.close();
});

test('a stream without the channel has no vessels', async () => {
	const client = await daemon.connect();
	const { summary: { session } } = await client.call('session.create', { name: 'plain', definition: strip, paused: true });
	const stream = await client.join(session, { rate_hz: 1000 });
	assert.equal(stream.vessels, undefined);
	await client.close();
});

test('a vessel that is wrong is refused with its place', async () => {
	const client = await daemon.connect();
	const [vessel] = strip.vessels;
	const wrong = [
		[{ ...vessel, points: [{ at_m: [0, 0, 0] }] }, /vessels\[0\]/, /points/],
		[{ ...vessel, layer: 'skin' }, /vessels\[0\]\.layer/, /layer of fat/],
		[{ ...vessel, wall_m: 0.002 }, /vessels\[0\]/, /lumen/],
		[{ ...vessel, radius: 0.001 }, /vessels\[0\]/, /radius_m/],
		[{ ...vessel, points: [{ at_m: [0, 0, -0.0015] }, { at_m: [0, 0.1, -0.0015] }] }, /vessels/, /leaves/],
	];
	for (const [made, path, reason] of wrong) {
		const error = await client.call('session.create', { name: 'wrong', definition: { ...strip, vessels: [made] }, paused: true }).then(() => null, (refusal) => refusal);
		const words = JSON.stringify(error?.data ?? {}) + error?.message;
		assert.ok(error && path.test(words) && reason.test(words), words);
	}
	await client.close();
});
