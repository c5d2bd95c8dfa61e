// SPDX-License-Identifier: GPL-3.0-or-later
// Tests robot controllers on DDS: they drive, they share tools with browsers, they fall silent.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { after, before, test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';
import { AT_REST, smallSession } from './wire/scene.mjs';
import { Controller } from './controller.mjs';
import { DOMAIN } from './domain.mjs';
import { lateness, now_us } from './lateness.mjs';
import { far, watchSession } from './watch.mjs';

// Deadlines, s: `native` is the one that native writers declare, `ros` the one of writers that declare none.
const DEADLINE_S = { native: 0.1, ros: 0.2 };
// TICK_S: a tick of the session. SLACK_S: longest time that a loaded machine may need to compute a tick and to send the
// frame, in addition to the lateness of this program.
const TICK_S = 1 / 60, SLACK_S = 0.1;
// Largest distance between the tool and its aim at rest, m: the quantum of float32. The tool lags behind its aim while
// it moves.
const AT_AIM_M = 1e-4;
// Deadline of a driver beside a standby, s. It is less than the lease. The standby takes the tool as soon as the driver
// is late once.
const STANDBY_DEADLINE_S = 0.4;
// LEASE_S: lease of liveliness that the controller's native writer offers. PARTICIPANT_LEASE_S: Cyclone's lease of a
// participant.
const LEASE_S = 0.5, PARTICIPANT_LEASE_S = 10;
const TRIALS = Number(process.env.DDS_TRIALS ?? 5);

let daemon;
before(async () => {
	daemon = await Daemon.start({ settings: { dds: true, dds_domain: DOMAIN, dds_deadline_s: DEADLINE_S.ros } });
});
after(() => daemon.end());

const hook = (session) => ({ session, tool: 'hook' });
const controller = (session, via = 'native', deadline = via === 'ros' ? 0 : DEADLINE_S.native) =>
	Controller.start({ domain: DOMAIN, session, tool: 'hook', via, deadline });

const watched = (t, name) => watchSession(t, daemon, name, { first: () => Controller.killAll() });

async function writing(session, via, deadline) {
	const robot = await controller(session, via, deadline);
	robot.tell('write on');
	await robot.until((s) => s.driver_name.startsWith(via === 'ros' ? 'ros ' : 'dds '));
	return robot;
}

async function energized({ client, session, stream }, via, deadline) {
	const robot = await writing(session, via, deadline);
	await turnOn({ client, stream }, robot);
	return robot;
}

// Writes a level that falls and rises. Repeats this if the robot was not scheduled within its deadline.
async function turnOn({ client, stream }, robot) {
	for (let trial = 0; !stream.tools[0].energized; trial++) {
		robot.tell('energy 0');
		const from = (await robot.state()).sequence;
		await robot.until((s) => s.sequence > from + 2);
		robot.tell('energy 1');
		await client.until(() => stream.tools[0].energized, 'energy on', trial < 10 ? 1 : 20).catch((error) => {
			if (trial >= 10)
				throw error;
		});
	}
}

for (const via of ['native', 'ros'])
	test(`a ${via} writer drives a tool, and a browser does not at the same time`, async (t) => {
		const { client, session, stream } = await watched(t, `drives-${via}`);
		const robot = await writing(session, via);
		const aim = [0.01, -0.005, 0.015];
		robot.tell(`aim ${aim.join(' ')}`);
		await client.until(() => far(stream.tools[0].position, aim) < AT_AIM_M, 'the pose in a frame');
		const state = await robot.until((s) => far(s.position_m, aim) < AT_AIM_M);
		assert.ok(state.sequence > 0);
		const { drivers } = await client.call('session.describe', { session });
		assert.equal(drivers[0].client, state.driver);

		const operator = await daemon.connect({ hello: { role: 'operate', client: 'operator' } });
		await assert.rejects(operator.call('tool.take_over', hook(session)), { code: -32043 });
		await assert.rejects(operator.call('tool.move', { ...hook(session), position_m: [0, 0, 0.05], rotation: AT_REST }),
			{ code: -32045 });
		await operator.close();
		await robot.end();
		await client.until(() => stream.tools[0].driver === 0, 'nobody drives it');
	});

test('a writer does not move a tool that a browser drives, until it is given up', async (t) => {
	const { client, session, stream } = await watched(t, 'browser');
	await client.call('tool.take_over', hook(session));
	const place = stream.tools[0].position;
	const robot = await controller(session);
	const refused = await daemon.metric('session_refused_total', session);
	robot.tell('aim 0.02 0.02 0.02');
	robot.tell('write on');
	await daemon.log(new RegExp(`session=${session} event=dds_refused .*admin drives the tool`));
	assert.ok(await daemon.metric('session_refused_total', session) > refused);
	assert.equal(stream.tools[0].driver, client.hello.client);
	assert.deepEqual(stream.tools[0].position, place);
	await client.call('tool.hand_over', hook(session));
	await robot.until((s) => s.driver_name.startsWith('dds '));
	await robot.end();
});

// Returns the time from the last sample to the frame that shows energy off, in the server's own clock.
async function offAfter({ client, stream }, last_us) {
	await client.until(() => !stream.tools[0].energized, 'energy off');
	lateness.look();
	assert.equal(stream.tools[0].energyOff, 'watchdog');
	return (stream.published - last_us) / 1e6;
}

const inTime = (seconds, deadline, ticks = 1) =>
	assert.ok(seconds <= deadline + ticks * TICK_S + SLACK_S + lateness.worst_s,
		`off after ${seconds.toFixed(4)} s; this program ran up to ${lateness.worst_s} s late`);

for (const via of ['native', 'ros'])
	test(`energy of a silent ${via} writer that is alive goes off, and stays off until enabled`, async (t) => {
		const seen = await watched(t, `silent-${via}`);
		const robot = await energized(seen, via);
		const times = [];
		for (let trial = 0; trial < TRIALS; trial++) {
			lateness.reset();
			times.push(await offAfter(seen, (await robot.ask('write off', 'silent')).last_us));
			inTime(times.at(-1), DEADLINE_S[via]);
			// The robot still writes the level 1. That does not turn energy on again.
			robot.tell('write on');
			const from = (await robot.state()).sequence;
			await robot.until((s) => s.sequence > from + 20);
			assert.equal((await robot.state()).energized, false);
			await turnOn(seen, robot);
		}
		t.diagnostic(`off after ${times.map((s) => s.toFixed(3)).join(' ')} s`);
		await robot.end();
	});

test('energy of a killed writer goes off', async (t) => {
	const seen = await watched(t, 'killed');
	const { client, session, stream } = seen;
	const times = [];
	for (let trial = 0; trial < TRIALS; trial++) {
		const robot = await controller(session);
		robot.tell('write on');
		// The earlier driver has ended. The next writer becomes the driver, but energy stays off.
		await robot.until((s) => s.driver_name.startsWith('dds ') && s.driver !== robot.firstDriver);
		await turnOn(seen, robot);
		lateness.reset();
		const killed_us = now_us();
		await robot.kill();
		times.push(await offAfter(seen, killed_us));
		inTime(times.at(-1), DEADLINE_S.native);
	}
	t.diagnostic(`off after ${times.map((s) => s.toFixed(3)).join(' ')} s`);
});

test('a killed writer is believed dead: who may operate gets its tool, long before its participant is given up', async (t) => {
	const seen = await watched(t, 'dead');
	const { client, session, stream } = seen;
	const robot = await energized(seen, 'native');
	const operator = await daemon.connect({ hello: { role: 'operate', client: 'operator' } });
	const killed_s = performance.now() / 1000;
	await robot.kill();
	await client.until(() => stream.tools[0].driver === 0, 'nobody drives it');
	const seconds = performance.now() / 1000 - killed_s;
	t.diagnostic(`free after ${seconds.toFixed(3)} s; its writer offered ${LEASE_S} s`);
	assert.ok(seconds < PARTICIPANT_LEASE_S / 2, `free after ${seconds} s`);
	assert.equal(stream.tools[0].energyOff, 'watchdog');
	await operator.call('tool.take_over', hook(session));
	await client.until(() => stream.tools[0].driver === operator.hello.client, 'the operator drives');
	assert.equal(stream.tools[0].energized, false);
	await operator.close();
});

test('a standby gets the tool of a silent driver, energy off', async (t) => {
	const seen = await watched(t, 'standby');
	const { client, session, stream } = seen;
	const robot = await energized(seen, 'native', STANDBY_DEADLINE_S);
	const first = stream.tools[0].driver;
	const standby = await controller(session);
	standby.tell('energy 1');
	standby.tell('write on');
	await daemon.log(new RegExp(`session=${session} event=dds_refused .*drives the tool`));
	assert.equal(stream.tools[0].driver, first);
	lateness.reset();
	const { last_us } = await robot.ask('write off', 'silent');
	await client.until(() => stream.tools[0].driver !== first, 'the standby drives');
	lateness.look();
	inTime((stream.published - last_us) / 1e6, STANDBY_DEADLINE_S, 2);
	assert.equal(stream.tools[0].energized, false);
	const from = (await standby.state()).sequence;
	await standby.until((s) => s.sequence > from + 20);
	assert.equal((await standby.state()).energized, false);
	await robot.end();
	await standby.end();
});

for (const [via, bad] of [['native', ['nan', 'infinite', 'back', 'huge', 'stale', 'leap', 'session']], ['ros', ['nan', 'infinite', 'leap']]])
	test(`bad samples of a ${via} writer are counted and move nothing`, async (t) => {
		const { client, session, stream } = await watched(t, `bad-${via}`);
		const robot = await writing(session, via, 1); // on a busy machine, no good sample must count as too old
		await client.until(() => far(stream.tools[0].position, [0, 0, 0.02]) < AT_AIM_M, 'it is there');
		for (const what of bad) {
			const refused = await daemon.metric('session_refused_total', session);
			const from = (await robot.state()).sequence;
			robot.tell(`once ${what}`);
			await robot.until((s) => s.sequence > from + 10);
			assert.equal(await daemon.metric('session_refused_total', session), refused + 1, what);
			assert.ok(far(stream.tools[0].position, [0, 0, 0.02]) < AT_AIM_M, what);
		}
		await robot.end();
	});

test('a flood of bad samples is counted, and the driver goes on', async (t) => {
	const seen = await watched(t, 'flood');
	const { session, stream } = seen;
	const robot = await energized(seen, 'native', 1); // the robot writes no good samples during the flood
	const refused = await daemon.metric('session_refused_total', session);
	const from = (await robot.state()).sequence;
	const aim = [0.01, 0, 0.015];
	robot.tell('flood 5000');
	robot.tell(`aim ${aim.join(' ')}`);
	await seen.client.until(() => far(stream.tools[0].position, aim) < AT_AIM_M, 'the pose in a frame');
	assert.ok((await robot.state()).sequence > from + 5000);
	assert.ok(await daemon.metric('session_refused_total', session) > refused);
	assert.equal(stream.tools[0].energized, true);
	await robot.end();
});

test('without being told so, DDS does not leave loopback', () => {
	const ended = spawnSync(process.env.CAUTERYD, ['--dds', '--dds-config', '/network.xml'], { encoding: 'utf8' });
	assert.equal(ended.status, 2);
	assert.match(ended.stderr, /path="dds_config" .*dds_network/);
});
