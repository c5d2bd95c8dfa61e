// SPDX-License-Identifier: GPL-3.0-or-later
// Forces on tools: raw ones of the tick that names them, filtered ones by the formula of protocol/README.md.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';
import { AT_REST, smallScene } from './wire/scene.mjs';

const ABOVE_M = 0.004, WAY_M = 0.0002; // of the hook's tip; in a tick
const ROUNDING = 1e-12; // N

let daemon;
before(async () => {
	daemon = await Daemon.start();
});
after(() => daemon.end());

// A cold hook above a sheet, in lock-step, and a stream of every tick.
async function pressing(client, name, filterS) {
	const definition = await smallScene(client);
	definition.tools = [{ ...definition.tools[0], position_m: [0, 0, ABOVE_M], ...filterS === undefined ? {} : { force_filter_s: filterS } }];
	const { summary: { session } } = await client.call('session.create', { name, definition, paused: true, ephemeral: true });
	await client.call('tool.take_over', { session, tool: 'hook' });
	return { session, shape: definition.tools[0].shape, stepS: definition.step_s, stream: await client.join(session, { rate_hz: 1000, channels: ['tools'] }) };
}

// One tick on. What the answer says of the tool, and what the frame of the same tick does.
async function press(client, { session, stream }, tick) {
	const commands = [{ method: 'tool.move', tool: 'hook', position_m: [0, 0, ABOVE_M - WAY_M * tick], rotation: AT_REST }];
	const { tick: reached, tools: [told] } = await client.call('session.advance', { session, commands, observe: { channels: ['tools'] } });
	assert.equal(reached, tick);
	await client.until(() => stream.tick === tick, 'the frame of the tick');
	return { told, shown: stream.tools[0] };
}

function expectSame(told, shown) {
	assert.deepEqual(shown.force, told.force_n.map(Math.fround));
	assert.deepEqual(shown.raw.force, told.raw_force_n.map(Math.fround));
	assert.deepEqual(shown.raw.torque, told.raw_torque_nm.map(Math.fround));
}

test('the frame of the tick in which a tool meets tissue has the force, and the filter follows it', async () => {
	const client = await daemon.connect();
	const at = await pressing(client, 'meets', undefined);
	let force = [0, 0, 0], torque = [0, 0, 0], met = 0;
	for (let tick = 1; tick <= 40; tick++) {
		const { told, shown } = await press(client, at, tick);
		expectSame(told, shown);
		assert.equal(shown.raw.filterS, Math.fround(0.02));
		assert.equal(told.contact_vertices > 0, told.raw_force_n[2] > 0); // of the same step
		met ||= told.raw_force_n[2] > 0 ? tick : 0;
		const follow = (value, raw) => value.map((f, c) => f + at.stepS / (at.stepS + 0.02) * (raw[c] - f));
		[force, torque] = [follow(force, told.raw_force_n), follow(torque, told.raw_torque_nm)];
		for (let c = 0; c < 3; c++)
			assert.ok(Math.abs(force[c] - told.force_n[c]) <= ROUNDING && Math.abs(torque[c] - told.torque_nm[c]) <= ROUNDING);
	}
	assert.ok(met > 1 && met < 40, `met in tick ${met}`);
	await client.close();
});

test('a tool without a filter reports one force; tool.configure sets the filter, in its range', async () => {
	const client = await daemon.connect();
	const at = await pressing(client, 'unfiltered', 0);
	for (let tick = 1; tick <= 20; tick++) {
		const { told, shown } = await press(client, at, tick);
		expectSame(told, shown);
		assert.deepEqual([told.force_n, told.torque_nm], [told.raw_force_n, told.raw_torque_nm]);
		assert.equal(shown.raw.filterS, 0);
	}
	const configure = (seconds) => client.call('tool.configure', { session: at.session, tool: 'hook', shape: at.shape, force_filter_s: seconds });
	for (const beyond of [-0.01, 1.01])
		await assert.rejects(configure(beyond), (error) => error.data.path === 'params.force_filter_s' || assert.fail(JSON.stringify(error.data)));
	await configure(1);
	const { told: before } = await press(client, at, 21);
	assert.ok(before.raw_force_n[2] > 0 && Math.abs(before.force_n[2] - before.raw_force_n[2]) > ROUNDING);
	assert.equal(at.stream.tools[0].raw.filterS, 1);
	await client.close();
});
