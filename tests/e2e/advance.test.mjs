// SPDX-License-Identifier: GPL-3.0-or-later
// Lock-step: session.advance, what begins and what ends it, silence counted in ticks, what it writes and answers.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';
import { AT_REST, smallScene, smallSession } from './wire/scene.mjs';

const STEP_S = 1 / 60;
const SLOW = process.env.E2E_SLOW === '1'; // with a sanitizer: fewer repeats, the same kinds of input
const STEPS = SLOW ? 60 : 300, CUT_STEPS = SLOW ? 50 : 100, LONG_STEPS = 2500;
const DEADLINE_TICKS = 15; // of 1/60 s, in the deadline of 250 ms
const EPISODES = Number(process.env.E2E_EPISODES ?? (SLOW ? 3 : 10)), LOAD = Number(process.env.E2E_LOAD ?? 4);

let daemon, watcher;
before(async () => {
	daemon = await Daemon.start({ settings: { browser_deadline_s: 0.25, resume_s: 0.3 } });
	watcher = await daemon.connect();
});
after(async () => {
	await watcher.close();
	await daemon.end();
});

const hook = (session) => ({ session, tool: 'hook' });
const move = (x, z = 0.001) => ({ method: 'tool.move', tool: 'hook', position_m: [x, 0, z], rotation: AT_REST });
const energy = (energized, more = {}) => ({ method: 'tool.energize', tool: 'hook', energized, ...more });
const TOOLS = { channels: ['tools'] };
const advance = (client, session, commands = [], more = {}) =>
	client.call('session.advance', { session, commands, observe: TOOLS, ...more });
const writtenBytes = (of = daemon) => Number(/^write_bytes: (\d+)$/m.exec(readFileSync(`/proc/${of.process.pid}/io`, 'utf8'))[1]);
const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

// The hash after so many ticks of the log, as the simulator computes it.
function simulated(folder, definition, log) {
	const [scene, script] = [join(folder, 'scene.json'), join(folder, 'script.jsonl')];
	writeFileSync(scene, JSON.stringify(definition));
	writeFileSync(script, log);
	const run = spawnSync(process.env.CAUTERY_SIM,
		['--scene', scene, '--script', script, '--seconds', String((STEPS + CUT_STEPS + 1) * definition.step_s), '--json'], { encoding: 'utf8' });
	assert.equal(run.status, 0, run.stderr);
	return JSON.parse(run.stdout.trim().split('\n').at(-1)).hash;
}

// In lock-step, the hook on.
async function energized(client, name, options = {}) {
	const session = await smallSession(client, name, { paused: true, ephemeral: true, ...options });
	await client.call('tool.take_over', hook(session));
	const { tools: [tool] } = await advance(client, session, [move(-0.02), energy(true)]);
	assert.equal(tool.energized, true);
	return session;
}

test('commands, ticks and what came of them in one answer', async () => {
	const client = await daemon.connect();
	const session = await smallSession(client, 'whole', { paused: true, ephemeral: true });
	await client.call('tool.take_over', hook(session));
	const stream = await client.join(session, { rate_hz: 1000 });
	const count = stream.description.vertex_count;
	const regions = [{ name: 'middle', center_m: [0, 0, 0], radius_m: 0.01 }, { name: 'all', least_m: [-1, -1, -1], most_m: [1, 1, 1] }];
	const first = await client.call('session.advance', { session, ticks: 0, observe: { channels: ['positions'], regions } });
	assert.deepEqual({ ...first, positions_m: first.positions_m.length }, {
		tick: 0, time_s: 0, ticks: 0, stored: false, positions_m: 3 * count,
		regions: regions.map(({ name }) => ({ name,
			inside: { removed_count: 0, removed_m3: 0, damaged_m3: 0 }, outside: { removed_count: 0, removed_m3: 0, damaged_m3: 0 } })),
	});
	for (let x = -0.02; x < 0.0201; x += 0.001)
		await advance(client, session, [move(x), energy(true, { sequence: 7 })], { ticks: 10 });
	const vertices = [3, 1, 200];
	const last = await client.call('session.advance', { session, ticks: 3, commands: [energy(false)],
		observe: { channels: ['positions', 'mask', 'tools', 'exposure', 'temperature'], vertices, regions } });
	await client.until(() => stream.tick === last.tick, 'the frame of the last tick');
	assert.equal(last.ticks, 3);
	assert.deepEqual(last.mask, [...stream.mask].map((word) => word >>> 0));
	vertices.forEach((v, i) => stream.position(v).forEach((x, axis) =>
		assert.ok(Math.abs(x - last.positions_m[3 * i + axis]) <= stream.description.step_m)));
	assert.deepEqual(last.scalars.map(({ channel, values }) => [channel, values.length]), [['exposure', 3], ['temperature', 3]]);
	const [{ tool, energized, energy_off: off, sequence, position_m: at }] = last.tools;
	assert.deepEqual({ tool, energized, off, sequence }, { tool: 'hook', energized: false, off: 'commanded', sequence: 7 });
	assert.ok(Math.abs(at[0] - 0.02) < 0.002);
	const [middle, all] = last.regions;
	const removed = stream.mask.reduce((sum, word) => sum + (word >>> 0).toString(2).replaceAll('0', '').length, 0);
	assert.ok(middle.inside.removed_count > 0 && middle.outside.removed_count > 0);
	assert.equal(all.inside.removed_count, removed);
	assert.equal(middle.inside.removed_count + middle.outside.removed_count, removed);
	assert.deepEqual(all.outside, { removed_count: 0, removed_m3: 0, damaged_m3: 0 });
	const face = 0.12 / 24 * 0.1 / 20 / 2 * 0.0005; // a triangle of the sheet, times its thickness
	assert.ok(Math.abs(all.inside.removed_m3 - removed * face) < 0.01 * removed * face);
	assert.ok(all.inside.damaged_m3 > 0 && all.inside.damaged_m3 < 0.12 * 0.1 * 0.0005);
	await client.close();
});

test('all of the commands or none, with the place of the first that is wrong', async () => {
	const client = await daemon.connect();
	const session = await energized(client, 'all-or-none');
	const { tick } = await advance(client, session, [], { ticks: 0 });
	const bad = [
		[[move(0.01), { method: 'tool.move', tool: 'hook', position_m: [0, 0, 0] }], 'params.commands[1].rotation'],
		[[move(0.01), { ...move(0), rotation: [1, 1, 0, 0] }], 'params.commands[1].rotation'],
		[[move(0.01), { method: 'tool.grasp', tool: 'nothing' }], 'params.commands[1].tool'],
		[[energy(true), energy(false)], 'params.commands[1].tool'],
		[[{ ...energy(true), jaw: 1 }], 'params.commands[0].jaw'],
		[[{ method: 'tool.remove', tool: 'hook' }], 'params.commands[0].method'],
	];
	for (const [commands, path] of bad)
		await assert.rejects(advance(client, session, commands), (error) => error.data.path === path || assert.fail(JSON.stringify(error.data)));
	for (const [observe, path] of [[{ channels: ['statistics'] }, 'params.observe.channels'], [{ vertices: [1e6] }, 'params.observe.vertices[0]'],
		[{ regions: [{ name: 'half', least_m: [0, 0, 0] }] }, 'params.observe.regions[0]']])
		await assert.rejects(advance(client, session, [], { observe }), (error) => error.data.path === path || assert.fail(JSON.stringify(error.data)));
	const now = await advance(client, session, [], { ticks: 0 });
	assert.equal(now.tick, tick);
	assert.equal(now.tools[0].energized, true); // that some were refused has changed nothing
	await client.close();
});

test('one client alone advances; another that drives nothing must not use its tools', async () => {
	const [client, other] = [await daemon.connect(), await daemon.connect()];
	const session = await energized(client, 'alone');
	await assert.rejects(advance(other, session), (error) => error.data.status === 'bad_state' && /lock-step/.test(error.data.reason));
	await client.call('session.step', { session, ticks: 1 });
	await assert.rejects(advance(other, session, [move(0)]), (error) => error.code === -32045 && error.data.path === 'params.commands[0].tool');
	assert.equal((await advance(other, session)).ticks, 1);
	await Promise.all([client.close(), other.close()]);
});

test('each way out turns energy off, and frames say so', async () => {
	const ways = {
		'another client steps': (session) => watcher.call('session.step', { session, ticks: 2 }),
		'another client resumes': (session) => watcher.call('session.resume', { session }),
		'another client pauses': (session) => watcher.call('session.pause', { session }),
		'its client steps': (session, client) => client.call('session.step', { session, ticks: 2 }),
		'its client resumes': (session, client) => client.call('session.resume', { session }),
		'its page hides': (session, client) => client.notify('heartbeat', { visible: false }),
		'its connection is lost': (session, client) => client.terminate(),
	};
	for (const [way, leave] of Object.entries(ways)) {
		const client = await daemon.connect();
		const session = await energized(client, 'left', { ephemeral: false });
		const stream = await watcher.join(session, { rate_hz: 1000, channels: ['mask', 'tools'] });
		await watcher.until(() => stream.tools[0].energized, `${way}: energy on`);
		const { tick } = stream;
		await leave(session, client);
		await watcher.until(() => !stream.tools[0].energized, `${way}: energy off`);
		if (!(await watcher.call('session.list')).sessions.some((one) => one.session === session && one.state === 'running'))
			await watcher.call('session.step', { session, ticks: 3 });
		await watcher.until(() => stream.tick > tick + 1, `${way}: later ticks`);
		assert.equal(stream.tools[0].energized, false, way);
		await watcher.call('session.destroy', { session });
		if (way !== 'its connection is lost')
			await client.close();
	}
});

test('a restore ends it, energy off, and the next advance begins it again', async () => {
	const client = await daemon.connect();
	const session = await smallSession(client, 'restored', { paused: true, ephemeral: true });
	await client.call('tool.take_over', hook(session));
	await client.call('session.snapshot', { session, name: 'start' });
	await advance(client, session, [move(-0.02), energy(true)], { ticks: 5 });
	await client.call('session.restore', { session, name: 'start' });
	const { tick, tools: [tool] } = await advance(client, session);
	assert.deepEqual([tick, tool.energized], [1, false]);
	assert.equal((await advance(client, session, [energy(true)])).tools[0].energized, true);
	await client.close();
});

test('silence is counted in ticks: not in seconds, and not beyond the deadline', async () => {
	const client = await daemon.connect();
	const session = await energized(client, 'silent');
	await sleep(1000); // four deadlines, and no heartbeat
	assert.equal((await advance(client, session)).tools[0].energized, true);
	const within = await advance(client, session, [], { ticks: DEADLINE_TICKS });
	assert.equal(within.tools[0].energized, true);
	await sleep(500);
	assert.equal((await advance(client, session)).tools[0].energized, true);
	const before = (await advance(client, session, [], { ticks: 0 })).tick;
	const beyond = await advance(client, session, [], { ticks: 3 * DEADLINE_TICKS });
	assert.deepEqual([beyond.ticks, beyond.tools[0].energized, beyond.tools[0].energy_off], [3 * DEADLINE_TICKS, false, 'watchdog']);
	const { events } = await client.call('session.timeline', { session });
	assert.equal(events.find(({ kind }) => kind === 'watchdog').tick, before + DEADLINE_TICKS);
	assert.equal((await advance(client, session)).tools[0].energized, false); // only an enable brings it back
	assert.equal((await advance(client, session, [energy(true)])).tools[0].energized, true);
	await client.close();
});

test('a tool that another client drives keeps its seconds', async () => {
	const [client, other] = [await daemon.connect(), await daemon.connect()];
	const session = await smallSession(client, 'two', { paused: true, ephemeral: true });
	await other.call('tool.take_over', hook(session));
	await other.call('tool.energize', { ...hook(session), energized: true });
	assert.equal((await advance(client, session)).tools[0].energized, true);
	await sleep(1000);
	const { energized, energy_off: why } = (await advance(client, session)).tools[0];
	assert.deepEqual([energized, why], [false, 'watchdog']);
	await Promise.all([client.close(), other.close()]);
});

test('off in a request acts even where the request is refused', async () => {
	const [client, other] = [await daemon.connect(), await daemon.connect()];
	const session = await energized(client, 'off');
	await assert.rejects(advance(other, session, [energy(false)]), (error) => error.data.status === 'bad_state');
	assert.equal((await advance(client, session)).tools[0].energized, false);
	await Promise.all([client.close(), other.close()]);
});

test('a pause ends a long advance, which answers with the ticks that it made', async () => {
	const client = await daemon.connect();
	const session = await smallSession(client, 'long', { paused: true, ephemeral: true });
	const asked = advance(client, session, [], { ticks: 100000 });
	while ((await watcher.call('session.describe', { session })).summary.tick === 0)
		await sleep(1);
	await watcher.call('session.pause', { session });
	const { ticks, tick } = await asked;
	assert.ok(ticks < 100000);
	assert.equal(tick, ticks);
	await client.close();
});

test('an ephemeral session writes nothing; all of a stored one is there after kill -9, and replays to the same bits', async () => {
	const own = await Daemon.start({ settings: { browser_deadline_s: 0.25 } });
	const client = await own.connect();
	const drive = async (session, i) => { // first above the tissue, then through it with energy
		const commands = i < STEPS ? [move(-0.02 + 0.0001 * i, 0.02)] : [move(-0.02 + 0.0004 * (i - STEPS)), energy(i % 50 < 40)];
		const { stored, tick } = await advance(client, session, commands);
		assert.deepEqual([stored, tick], [session !== 'd1-memory', i + 1]);
	};
	const memory = await smallSession(client, 'memory', { paused: true, ephemeral: true });
	await client.call('tool.take_over', hook(memory));
	await sleep(1000); // earlier writes have reached the disk
	let before = writtenBytes(own);
	for (let i = 0; i < STEPS + CUT_STEPS; i++)
		await drive(memory, i);
	assert.equal(writtenBytes(own) - before, 0);
	const definition = await smallScene(client, [60, 50]);
	const { summary: { session: disk } } = await client.call('session.create', { name: 'disk', definition, paused: true });
	await client.call('tool.take_over', hook(disk));
	for (let i = 0; i < STEPS + CUT_STEPS; i++)
		await drive(disk, i);
	await own.kill();
	const next = await Daemon.start({ folder: own.folder });
	const again = await next.connect();
	const { summary } = await again.call('session.describe', { session: disk });
	assert.equal(summary.tick, STEPS + CUT_STEPS);
	// The energy that the restart turned off is logged at the last tick, whose commands a replay leaves out: one more.
	await again.call('session.step', { session: disk, ticks: 1 });
	const { hash } = await again.call('session.snapshot', { session: disk });
	assert.equal(simulated(next.folder, definition, await again.file('session.log', { session: disk })), hash);
	await again.close();
	await next.end();
});

// Long enough that checkpoints, the folding of the log into the file, and thinning are in the mean.
test('a stored step that moves a tool writes at most 16 KiB', { skip: SLOW && 'sanitizers write the same' }, async () => {
	const own = await Daemon.start({ settings: { browser_deadline_s: 0.25 } });
	const client = await own.connect();
	const session = await smallSession(client, 'long', { paused: true });
	await client.call('tool.take_over', hook(session));
	await sleep(1000); // earlier writes have reached the disk
	const before = writtenBytes(own);
	for (let i = 0; i < LONG_STEPS; i++)
		assert.equal((await advance(client, session, [move(-0.02 + 0.04 * i / LONG_STEPS, 0.02)])).tick, i + 1);
	const each = (writtenBytes(own) - before) / LONG_STEPS;
	console.log(`a stored step that moves a tool writes ${each.toFixed(0)} bytes`);
	assert.ok(each <= 16384);
	await client.close();
	await own.end();
});

test('where the energy of instruments went is reported where that is asked for, and adds up', async () => {
	const client = await daemon.connect();
	const definition = { ...await smallScene(client), energy: 'tissue', parting: 'elements', cell_m: 5e-4 };
	const { summary: { session } } = await client.call('session.create', { name: 'energy', definition, paused: true, ephemeral: true });
	await client.call('tool.take_over', hook(session));
	const before = await advance(client, session, [move(0, 0)], { observe: { energy: true } });
	assert.deepEqual(new Set(Object.values(before.energy)), new Set([0]));
	assert.equal((await advance(client, session)).energy, undefined);
	let given = 0;
	for (let i = 0; i < 60; i++) {
		const { tools: [tool] } = await advance(client, session, [energy(true)]);
		given += tool.power_w * STEP_S;
		assert.equal(tool.power_w > 0, tool.load_ohm > 0);
	}
	const { energy: spent } = await advance(client, session, [energy(false)], { observe: { energy: true } });
	const parts = spent.stored_j + spent.boiled_j + spent.perfused_j + spent.ambient_j + spent.shed_j;
	// Cells take no more than dries them, so it may be less than the generator gave.
	assert.ok(given > 1 && spent.delivered_j > 0 && spent.delivered_j <= 1.001 * given, `${spent.delivered_j} J, by the tool's power ${given} J`);
	assert.ok(Math.abs(spent.delivered_j + spent.blade_j - parts) <= 0.01 * spent.delivered_j, JSON.stringify(spent));
	assert.ok(spent.coagulated_m3 > 0);
	const { energy: again } = await advance(client, session, [energy(true)], { observe: { energy: true } });
	// By the enthalpy of evaporation, and the warmth of water between 37 and 100 degC.
	const boiled = again.vapour_kg_s * STEP_S * (2.257e6 + 4186 * 63);
	assert.ok(Math.abs(boiled - (again.boiled_j - spent.boiled_j)) <= 1e-6 * (1e-6 + boiled), JSON.stringify(again));
	await client.close();
});

test('equal episodes, to the last bit, on a busy machine', async () => {
	const client = await daemon.connect();
	const session = await smallSession(client, 'episodes', { paused: true, ephemeral: true });
	await client.call('tool.take_over', hook(session));
	await client.call('session.snapshot', { session, name: 'start' });
	const load = Array.from({ length: LOAD }, () => spawn(process.execPath, ['-e', 'for (;;);'], { stdio: 'ignore' }));
	const episode = async () => {
		await client.call('session.restore', { session, name: 'start' });
		const answers = [];
		for (let i = 0; i < 20; i++)
			answers.push(await advance(client, session, [move(-0.02 + 0.002 * i), energy(i % 7 > 1)],
				{ ticks: 2, observe: { channels: ['positions', 'mask', 'tools', 'exposure'] } }));
		for (const { tools: [tool] } of answers)
			delete tool.energy_off; // before the first enable it is another reason than later
		return JSON.stringify(answers);
	};
	try {
		const first = await episode();
		for (let i = 1; i < EPISODES; i++)
			assert.ok(await episode() === first, `episode ${i} is another`);
	} finally {
		load.forEach((one) => one.kill());
	}
	await client.close();
});
