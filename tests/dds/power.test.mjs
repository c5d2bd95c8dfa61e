// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the delivered power of a tool's generator, as DDS reports it.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Controller } from './controller.mjs';
import { DOMAIN } from './domain.mjs';
import { Daemon } from './wire/daemon.mjs';
import { AT_REST, smallScene } from './wire/scene.mjs';

const SET_W = 25;

let daemon;
before(async () => {
	daemon = await Daemon.start({ settings: { dds: true, dds_domain: DOMAIN } });
});
after(() => daemon.end());

const listener = (session, tool) => Controller.start({ domain: DOMAIN, session, tool, via: 'native' });

test('power and load are reported while current flows; a tool without energy has no instance', async (t) => {
	const client = await daemon.connect({ hello: { client: 'hand' } });
	const definition = await smallScene(client);
	Object.assign(definition, { energy: 'tissue', parting: 'elements', cell_m: 5e-4 });
	Object.assign(definition.tools[0], { power_w: SET_W });
	definition.tools.push({ ...definition.tools[0], name: 'grasper', shape: 'grasper', position_m: [0, 0.03, 0.05] });
	const session = (await client.call('session.create', { name: 'power', definition })).summary.session;
	t.after(async () => {
		await Controller.killAll();
		await client.call('session.destroy', { session });
		await client.close();
	});
	const stream = await client.join(session);
	const hook = await listener(session, 'hook');
	const before = await hook.until((s) => s.has_power);
	assert.deepEqual([before.set_w, before.power_w, before.load_ohm, before.energy_j, before.power_on], [SET_W, 0, 0, 0, false]);
	await client.call('tool.take_over', { session, tool: 'hook' });
	await client.call('tool.move', { session, tool: 'hook', position_m: [0, 0, 0], rotation: AT_REST });
	await client.call('tool.energize', { session, tool: 'hook', energized: true });
	const given = await hook.until((s) => s.power_w > 0 && s.load_ohm > 0);
	assert.ok(given.power_on && given.power_w <= SET_W * 1.001, `${given.power_w} W of ${SET_W} W`);
	await client.call('tool.energize', { session, tool: 'hook', energized: false });
	const off = await hook.until((s) => !s.power_on && s.power_w === 0 && s.load_ohm === 0);
	assert.ok(off.energy_j > 0, `${off.energy_j} J`);
	assert.ok(stream.tools[0].energyOff === 'commanded');
	const grasper = await listener(session, 'grasper');
	assert.equal((await grasper.state()).has_power, false);
});

test('the participant that drives sets the power, in its range; others are refused, and counted', async (t) => {
	const client = await daemon.connect({ hello: { client: 'operator' } });
	const definition = await smallScene(client);
	const session = (await client.call('session.create', { name: 'set', definition })).summary.session;
	t.after(async () => {
		await Controller.killAll();
		await client.call('session.destroy', { session });
		await client.close();
	});
	const refused = () => daemon.metric('session_refused_total', session);
	for (const [via, names] of [['native', 'dds '], ['ros', 'ros ']]) {
		const robot = await Controller.start({ domain: DOMAIN, session, tool: 'hook', via });
		robot.tell('write on');
		await robot.until((s) => s.driver_name.startsWith(names) && s.has_power);
		robot.tell('power_w 40');
		await robot.until((s) => s.set_w === 40);
		for (const w of [0, 40, 0]) // the newest setting takes effect, even if earlier settings still wait
			robot.tell(`power_w ${w}`);
		await robot.until((s) => s.set_w === 0);
		const other = await listener(session, 'hook');
		for (const [writer, value] of [[other, '12'], [robot, '401'], [robot, 'nan']]) {
			const before = await refused();
			writer.tell(`power_w ${value}`);
			while (await refused() === before)
				await robot.state();
			assert.equal((await robot.state()).set_w, 0);
		}
		await robot.kill();
		await other.kill();
	}
});

test('the participant that drives makes its tool an instrument; unknown names and powers are refused', async (t) => {
	const client = await daemon.connect({ hello: { client: 'operator' } });
	const definition = await smallScene(client);
	const session = (await client.call('session.create', { name: 'becomes', definition })).summary.session;
	t.after(async () => {
		await Controller.killAll();
		await client.call('session.destroy', { session });
		await client.close();
	});
	const { instruments } = await client.call('instrument.list');
	const { modes } = instruments.find(({ name }) => name === 'monopolar-spatula');
	const blend = modes.find(({ mode }) => mode === 'blend');
	const refused = () => daemon.metric('session_refused_total', session);
	const robot = await Controller.start({ domain: DOMAIN, session, tool: 'hook', via: 'native' });
	robot.tell('write on');
	await robot.until((s) => s.driver_name.startsWith('dds ') && s.has_power);
	robot.tell('instrument monopolar-spatula blend -1');
	await robot.until((s) => s.set_w === blend.power_w);
	const tool = async () => (await client.call('session.describe', { session })).definition.tools[0];
	assert.deepEqual([(await tool()).shape, (await tool()).peak_v], ['spatula', blend.peak_v]);
	robot.tell('instrument monopolar-spatula coagulation 20');
	await robot.until((s) => s.set_w === 20);
	for (const wanted of ['spoon cut -1', 'monopolar-spatula seal -1', 'monopolar-spatula cut 399', 'monopolar-spatula cut nan']) {
		const before = await refused();
		robot.tell(`instrument ${wanted}`);
		while (await refused() === before)
			await robot.state();
		assert.equal((await robot.state()).set_w, 20);
	}
	const other = await listener(session, 'hook');
	const before = await refused();
	other.tell('instrument monopolar-hook cut -1');
	while (await refused() === before)
		await other.state();
	assert.equal((await tool()).shape, 'spatula');
});
