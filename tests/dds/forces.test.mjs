// SPDX-License-Identifier: GPL-3.0-or-later
// Tests raw and filtered forces on DDS, and the tick to which they belong.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Controller } from './controller.mjs';
import { DOMAIN } from './domain.mjs';
import { Daemon } from './wire/daemon.mjs';
import { AT_REST, smallScene } from './wire/scene.mjs';

const FILTER_S = 0.5, ABOVE_M = 0.004, WAY_M = 0.0002; // ABOVE_M: height of the hook's tip; WAY_M: its way in a tick
const TICKS = 30;

let daemon;
before(async () => {
	daemon = await Daemon.start({ settings: { dds: true, dds_domain: DOMAIN } });
});
after(() => daemon.end());

const listener = (session, tool, via) => Controller.start({ domain: DOMAIN, session, tool, via });

test('both forces of each tick, native and for ROS 2, are those of session.advance', async (t) => {
	const client = await daemon.connect({ hello: { client: 'hand' } });
	const definition = await smallScene(client);
	definition.tools = [{ ...definition.tools[0], position_m: [0, 0, ABOVE_M], force_filter_s: FILTER_S }];
	const session = (await client.call('session.create', { name: 'forces', definition, paused: true, ephemeral: true })).summary.session;
	t.after(async () => {
		await Controller.killAll();
		await client.call('session.destroy', { session });
		await client.close();
	});
	await client.call('tool.take_over', { session, tool: 'hook' });
	const native = await listener(session, 'hook', 'native'), ros = await listener(session, 'hook', 'ros');
	const first = await native.until((s) => s.has_force);
	assert.deepEqual([first.filter_s, first.raw_z_n, first.z_n], [FILTER_S, 0, 0]);
	let met = 0;
	for (let tick = 1; tick <= TICKS; tick++) {
		const commands = [{ method: 'tool.move', tool: 'hook', position_m: [0, 0, ABOVE_M - WAY_M * tick], rotation: AT_REST }];
		const { tools: [told] } = await client.call('session.advance', { session, commands, observe: { channels: ['tools'] } });
		const [raw, filtered] = [told.raw_force_n[2], told.force_n[2]];
		const seen = await native.until((s) => s.force_tick === tick && s.tick === tick);
		assert.deepEqual([seen.raw_z_n, seen.z_n, seen.state_z_n], [raw, filtered, filtered]);
		await ros.untilCrtk((c) => c.raw_z_n === raw && c.z_n === filtered);
		met ||= raw > 0 ? tick : 0;
	}
	assert.ok(met > 1 && met < TICKS, `met in tick ${met}`);
	await client.call('tool.remove', { session, tool: 'hook' });
});
