// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that a robot on another vendor's DDS drives a tool of the real daemon, over native topics and over topics of
// ROS 2.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { setTimeout } from 'node:timers/promises';
import { Daemon } from './wire/daemon.mjs';
import { cutMiddle } from './wire/scene.mjs';
import { DOMAIN } from './domain.mjs';
import { Program } from './program.mjs';
import { far, watchSession } from './watch.mjs';

const DEADLINE_MS = 500; // generous, because this test is not about being late
const BUSY_MS = 300; // longer than the daemon needs to end the session
const AT_AIM_M = 1e-4; // quantum of float32 in frames, and the rest of the robot's way, m

let daemon;
before(async () => {
	daemon = await Daemon.start({ settings: { dds: true, dds_domain: DOMAIN, dds_deadline_s: DEADLINE_MS / 1000 } });
});
after(() => daemon.end());

const watched = (t, name) => watchSession(t, daemon, name);

async function robot(t, session, via) {
	const made = new Program(process.env.INTEROP_ROBOT, [DOMAIN, session, 'hook', via, DEADLINE_MS],
		{ environment: { FASTRTPS_DEFAULT_PROFILES_FILE: process.env.PROFILE } });
	t.after(() => made.end());
	await made.event((e) => e.event === 'matched', 'matched');
	return made;
}

for (const via of ['native', 'ros', 'sensor'])
	test(`Fast DDS drives over ${via} topics and reads the tool's state`, async (t) => {
		const { client, session, stream } = await watched(t, `fast-${via}`);
		const made = await robot(t, session, via);
		made.tell('write on');
		const { native: driven } = await made.until(({ native }) => native.driver_name.startsWith(via === 'native' ? 'dds ' : 'ros '));
		await client.until(() => stream.tools[0].driver === driven.driver, 'a frame tells it too');

		const aim = [0.01, -0.005, 0.015];
		made.tell(`aim ${aim.join(' ')}`);
		await client.until(() => far(stream.tools[0].position, aim) < AT_AIM_M, 'the pose in a frame');
		const { cp } = await made.until(({ native, cp, cf }) =>
			far(native.position_m, aim) < AT_AIM_M && far(cp.position_m, aim) < AT_AIM_M && cf.count > 0);
		assert.equal(cp.frame_id, 'world');

		// The robot presses into the tissue. Both topics must show a force.
		made.tell('aim 0 0 -0.002');
		await made.until(({ native, cf }) => far(cf.force_n, [0, 0, 0]) > 0.001 && far(native.force_n, [0, 0, 0]) > 0.001);

		made.tell('energy 1');
		await client.until(() => stream.tools[0].energized, 'energy on');
		await made.until(({ native }) => native.energized);
		made.tell('energy 0');
		const { native: off } = await made.until(({ native }) => !native.energized);
		assert.equal(off.energy_off, 1, 'commanded');

		assert.equal((await made.end()).code, 0);
		await client.until(() => stream.tools[0].driver === 0, 'nobody drives it');
	});

// Returns the vertices of drawn faces. The stream's values of all other vertices are out of date.
function drawnVertices(stream) {
	const drawn = new Set();
	for (let face = 0; 3 * face < stream.faces.length; face++)
		if (!stream.isRemoved(face))
			for (let corner = 0; corner < 3; corner++)
				drawn.add(stream.faces[3 * face + corner]);
	return [...drawn];
}

test('Fast DDS decodes topology, key frames and deltas to what a browser sees', async (t) => {
	const { client, session, stream } = await watched(t, 'fast-frames');
	await client.call('session.pause', { session });
	await cutMiddle(client, session);
	await client.call('session.resume', { session });
	await client.until(() => stream.removed() > 0, 'faces gone');
	// The robot joins late. It gets the kept key frame and topology, and then deltas.
	const made = await robot(t, session, 'native');
	await made.until(({ stream: s }) => s.gone > 0 && s.applied > 30);
	// state 1: the session runs
	const { status } = await made.until(({ status: s }) => s.session === session && s.tick > 0 && s.state === 1);
	assert.equal(status.vertices, stream.rest.length / 3);

	const { tick } = await client.call('session.pause', { session });
	await client.until(() => stream.tick >= tick, 'the last frame before the pause');
	const { stream: seen } = await made.until(({ stream: s }) => s.tick >= tick);
	assert.equal(seen.refused, 0, seen.reason);
	assert.ok(seen.topologies >= 1 && seen.keys >= 1);
	assert.equal(seen.last_vertex, Math.max(...stream.faces));
	assert.equal(seen.gone, stream.removed());
	const held = await made.ask('positions');
	assert.equal(held.tick, stream.tick);
	for (const vertex of drawnVertices(stream))
		for (let i = 3 * vertex; i < 3 * vertex + 3; i++)
			assert.equal(held.quantised[i], stream.quantised[i], `vertex ${vertex}`);

	await client.call('tool.remove', { session, tool: 'hook' });
	await client.call('session.step', { session });
	await made.until(({ native }) => native.removed);

	// The robot learns that the session has ended, although the robot is stopped at that moment.
	made.process.kill('SIGSTOP');
	await client.call('session.destroy', { session });
	await setTimeout(BUSY_MS);
	made.process.kill('SIGCONT');
	await made.until(({ status: s }) => s.gone); // the status instance was disposed
});
