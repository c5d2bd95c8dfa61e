// SPDX-License-Identifier: GPL-3.0-or-later
// Profiles of instruments: listed, named by scenes and commands, and numbers from then on.
import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { promisify } from 'node:util';
import { Daemon } from './wire/daemon.mjs';
import { AT_REST, smallScene } from './wire/scene.mjs';

const run = promisify(execFile);

let daemon, client, profiles;
before(async () => {
	const folder = join(process.env.PAGES, 'deploy/instruments');
	profiles = readdirSync(folder).filter((file) => file.endsWith('.json')).map((file) => JSON.parse(readFileSync(join(folder, file))));
	daemon = await Daemon.start();
	client = await daemon.connect();
});
after(() => daemon.end());

async function powered(tools) {
	const definition = await smallScene(client);
	return { ...definition, energy: 'tissue', parting: 'elements', cell_m: 5e-4, tools };
}

const toolOf = async (session, name) =>
	(await client.call('session.describe', { session })).definition.tools.find((tool) => tool.name === name);

function assertIs(tool, profile, mode) {
	const { name, description, power_least_w: _least, power_most_w: _most, sources, ...settings } = mode;
	for (const [member, value] of Object.entries({ ...profile.tool, ...settings }))
		assert.equal(tool[member], value, `${profile.name}, ${mode.name}: ${member}`);
	assert.equal(tool.instrument ?? tool.mode, undefined);
}

test('the profiles of the folder are listed, with their modes', async () => {
	const { instruments } = await client.call('instrument.list');
	assert.deepEqual(instruments.map(({ name }) => name), profiles.map(({ name }) => name).sort());
	for (const { name, description, shape, modes } of instruments) {
		const profile = profiles.find((one) => one.name === name);
		assert.deepEqual([description, shape], [profile.description, profile.tool.shape]);
		assert.deepEqual(modes.map(({ mode, power_w: power }) => [mode, power]), profile.modes.map((mode) => [mode.name, mode.power_w]));
	}
});

test('each instrument in each mode is a tool that a session takes', async () => {
	const made = await client.call('session.create', { name: 'each', definition: await powered([]), paused: true });
	const { session } = made.summary;
	for (const profile of profiles) {
		await client.call('tool.add', { session, name: 'tool', instrument: profile.name });
		assertIs(await toolOf(session, 'tool'), profile, profile.modes[0]);
		for (const mode of profile.modes) {
			await client.call('tool.configure', { session, tool: 'tool', instrument: profile.name, mode: mode.name });
			assertIs(await toolOf(session, 'tool'), profile, mode);
			await client.call('session.step', { session, ticks: 1 });
		}
		await client.call('tool.remove', { session, tool: 'tool' });
	}
	await client.call('session.destroy', { session });
});

test('a scene names an instrument; the session, its log and its replay have the numbers', async () => {
	const hook = profiles.find(({ name }) => name === 'monopolar-hook');
	const tools = [{ name: 'hook', instrument: 'monopolar-hook', mode: 'cut', power_w: 20, position_m: [0, 0, 0.02] }];
	const made = await client.call('session.create', { name: 'named', definition: await powered(tools), paused: true });
	const { session } = made.summary;
	const [cut, blend] = hook.modes;
	assertIs(made.definition.tools[0], hook, { ...cut, power_w: 20 });
	await client.call('tool.configure', { session, tool: 'hook', instrument: 'monopolar-hook', mode: 'blend' });
	await client.call('tool.take_over', { session, tool: 'hook' });
	await client.call('tool.move', { session, tool: 'hook', position_m: [0, 0, 0], rotation: AT_REST });
	await client.call('tool.energize', { session, tool: 'hook', energized: true });
	await client.call('session.step', { session, ticks: 90 });
	assertIs(await toolOf(session, 'hook'), hook, blend);
	const { tools: [{ energy_j: given }] } = await client.call('session.advance', { session, ticks: 1, observe: { channels: ['tools'] } });
	assert.ok(given > 0, `${given} J`);
	const before = (await client.call('session.describe', { session })).definition.tools;
	await client.call('session.rewind', { session, tick: 60 });
	assert.deepEqual((await client.call('session.describe', { session })).definition.tools, before);
	await client.call('session.destroy', { session });
});

test('what is unknown is refused, and the known names are said', async () => {
	const tools = (members) => powered([{ name: 'hook', ...members }]);
	const create = async (members) => client.call('session.create', { definition: await tools(members), ephemeral: true });
	await assert.rejects(create({ instrument: 'monopolar-hok' }), ({ message }) =>
		/definition\.tools\[0\]\.instrument.*monopolar-hok.*none of .*monopolar-needle.*did you mean "monopolar-hook"/.test(message));
	await assert.rejects(create({ instrument: 'monopolar-hook', mode: 'seal' }), ({ message }) => /none of cut, blend, coagulation/.test(message));
	await assert.rejects(create({ shape: 'hook', mode: 'cut' }), ({ message }) => /mode/.test(message));
	await assert.rejects(create({ instrument: 'monopolar-hook', power_w: 200 }), ({ message }) => /1 and 150 W/.test(message));
	await assert.rejects(create({ power_w: 20 }), ({ message }) => /shape/.test(message));
});

test('the command line lists instruments, adds one, and changes a tool to one', async () => {
	const made = await client.call('session.create', { name: 'line', definition: await powered([]), paused: true });
	const { session } = made.summary;
	const cautery = async (...words) => (await run(process.env.CAUTERY, [...words, '--url', `ws://127.0.0.1:${daemon.port}`])).stdout;
	const listed = await cautery('instruments');
	for (const { name, modes } of profiles)
		for (const mode of modes)
			assert.match(listed, new RegExp(`^${name} +${mode.name} +${mode.power_w} W`, 'm'));
	await cautery('tool', session, 'mine', 'add', 'give', '--instrument', 'advanced-bipolar');
	const jaws = profiles.find(({ name }) => name === 'advanced-bipolar');
	assertIs(await toolOf(session, 'mine'), jaws, jaws.modes[0]);
	await cautery('tool', session, 'mine', 'configure', '--instrument', 'monopolar-spatula', '--mode', 'coagulation', '--power-w', '50');
	const spatula = profiles.find(({ name }) => name === 'monopolar-spatula');
	assertIs(await toolOf(session, 'mine'), spatula, { ...spatula.modes[2], power_w: 50 });
	const refusal = async (...words) => run(process.env.CAUTERY, ['tool', session, 'mine', 'configure', ...words, '--url', `ws://127.0.0.1:${daemon.port}`]).then(() => '', ({ stderr }) => stderr);
	assert.match(await refusal('--instrument', 'spoon'), /"spoon" is none of advanced-bipolar/);
	assert.match(await refusal('--instrument', 'monopolar-hook', '--power-w', '399'), /399 is not between 1 and 150 W/);
	assert.match(await refusal(), /--instrument/);
	await client.call('session.destroy', { session });
});
