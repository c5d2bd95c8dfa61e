// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that writers of ROS 2's sensor data drive, and that a peer that cannot be matched is logged once.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Controller } from './controller.mjs';
import { CYCLONE, DOMAIN } from './domain.mjs';
import { Program } from './program.mjs';
import { Daemon } from './wire/daemon.mjs';
import { far, watchSession } from './watch.mjs';

const DEADLINE_S = 1;
const AT_AIM_M = 1e-4; // quantum of float32 in frames, and the rest of the robot's way, m

let daemon;
before(async () => {
	daemon = await Daemon.start({ settings: { dds: true, dds_domain: DOMAIN, dds_deadline_s: DEADLINE_S } });
});
after(() => daemon.end());

const watched = (t, name) => watchSession(t, daemon, name, { first: () => Controller.killAll() });
const controller = (session, via) => Controller.start({ domain: DOMAIN, session, tool: 'hook', via });
const incompatible = () => daemon.metric('dds_peers_incompatible_total');

// Starts a controller that never finds the daemon.
function stranger(t, session, via) {
	const made = new Program(process.env.CONTROLLER, [DOMAIN, session, 'hook', via, 0], { environment: CYCLONE });
	t.after(() => made.kill());
	return made;
}

test('a writer of best effort drives, with energy by its reliable level, and goes dark when it is silent', async (t) => {
	const { client, session, stream } = await watched(t, 'sensor');
	const robot = await controller(session, 'sensor');
	robot.tell('write on');
	await robot.until((s) => s.driver_name.startsWith('ros '));
	const aim = [0.01, -0.005, 0.015];
	robot.tell(`aim ${aim.join(' ')}`);
	await client.until(() => far(stream.tools[0].position, aim) < AT_AIM_M, 'it follows');
	robot.tell('energy 1');
	await client.until(() => stream.tools[0].energized, 'energy on');
	await robot.ask('write off', 'silent');
	await client.until(() => !stream.tools[0].energized, 'energy off');
	assert.equal(stream.tools[0].energyOff, 'watchdog');
	assert.equal(await incompatible(), 0);
});

test('beside a reader of best effort a sample of a reliable writer counts once', async (t) => {
	const { session } = await watched(t, 'twice');
	const sensor = await controller(session, 'sensor'); // its best-effort writer makes the daemon open a best-effort reader
	const robot = await controller(session, 'ros');
	robot.tell('once lift');
	assert.equal((await robot.until((s) => s.driver_name.startsWith('ros ') && s.sequence > 0)).sequence, 1);
	for (let sent = 2; sent < 10; sent++) {
		robot.tell('once lift');
		assert.equal((await robot.until((s) => s.sequence >= sent)).sequence, sent);
	}
	await sensor.end();
});

for (const [via, policy, type] of [['loose', 'reliability', 'sensor_msgs::msg::dds_::Joy_'], ['mistyped', 'type', 'geometry_msgs::msg::dds_::PoseStamped_']])
	test(`a writer whose ${policy} DDS cannot match is logged and counted once`, async (t) => {
		const before = await incompatible();
		const { session } = await watched(t, via);
		const theirs = stranger(t, session, via);
		const topic = `rt/${session.replaceAll('-', '_')}/hook/energize`;
		await daemon.log(new RegExp(` session=${session} event=dds_incompatible .*topic="${topic}" end=writer policy=${policy} type="${type}"`));
		await theirs.ask('state');
		assert.equal(await incompatible(), before + 1);
		assert.equal(daemon.lines.filter((line) => line.includes(`topic="${topic}"`)).length, 1);
	});

test('one who was there before its session is told of as well', async (t) => {
	const theirs = stranger(t, 'd1-later', 'loose');
	await theirs.ask('state');
	const { session } = await watched(t, 'later');
	assert.equal(session, 'd1-later');
	await daemon.log(/ event=dds_incompatible .*topic="rt\/d1_later\/hook\/energize" end=writer policy=reliability/);
});
