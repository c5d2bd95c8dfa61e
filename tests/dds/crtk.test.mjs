// SPDX-License-Identifier: GPL-3.0-or-later
// Tests CRTK's operating states and the jaw, as a ROS 2 controller uses them.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Controller } from './controller.mjs';
import { DOMAIN } from './domain.mjs';
import { Daemon } from './wire/daemon.mjs';
import { smallScene } from './wire/scene.mjs';
import { far } from './watch.mjs';

const AT_AIM_M = 1e-4, JAW_OPEN_RAD = 0.5, LIFT_M = 1e-3;

let daemon;
before(async () => {
	daemon = await Daemon.start({ settings: { dds: true, dds_domain: DOMAIN, dds_deadline_s: 1 } });
});
after(() => daemon.end());

// Makes a session with one grasper, and a ROS 2 controller that has found it.
async function found(t, name) {
	const client = await daemon.connect({ hello: { client: 'admin' } });
	const definition = await smallScene(client);
	Object.assign(definition.tools[0], { name: 'grasper', shape: 'grasper', jaw_open_rad: JAW_OPEN_RAD });
	const session = (await client.call('session.create', { name, definition })).summary.session;
	t.after(async () => {
		await Controller.killAll();
		await client.call('session.destroy', { session });
		await client.close();
	});
	const stream = await client.join(session);
	const robot = await controller(session);
	await robot.untilCrtk((c) => c.jaw_topics === 3);
	return { client, session, stream, robot };
}

// Makes a session as found() does. The controller then drives the tool.
async function driven(t, name) {
	const seen = await found(t, name);
	seen.robot.tell('write on');
	await seen.robot.until((s) => s.driver_name.startsWith('ros '));
	return seen;
}

const controller = (session) => Controller.start({ domain: DOMAIN, session, tool: 'grasper', via: 'ros' });

async function energize({ client, stream, robot }) {
	robot.tell('energy 0');
	const { sequence } = await robot.state();
	await robot.until((s) => s.sequence > sequence + 2);
	robot.tell('energy 1');
	await client.until(() => stream.tools[0].energized, 'energy on');
}

// Checks that the robot's further poses have no effect.
async function refuses({ session, stream, robot }, aim) {
	const refused = await daemon.metric('session_refused_total', session);
	const from = stream.tools[0].position;
	robot.tell(`aim ${aim.join(' ')}`);
	while (await daemon.metric('session_refused_total', session) < refused + 20)
		await robot.state();
	const to = stream.tools[0].position;
	assert.ok(far(to, from) < 2 * AT_AIM_M, `from ${from} to ${to}`);
	assert.equal(stream.tools[0].energized, false);
}

// Makes the robot silent, and waits until all its samples have been taken: its last sample moves the tool.
async function fallSilent(robot) {
	const { position_m: [, , z] } = await robot.crtk();
	robot.tell('write off');
	robot.tell('once lift');
	await robot.until((s) => Math.abs(s.position_m[2] - (z + LIFT_M)) < AT_AIM_M);
}

// Makes the robot write one sample that is refused, while no other refused sample is under way.
async function refusesOne(session, robot, line) {
	const refused = await daemon.metric('session_refused_total', session);
	robot.tell(line);
	while (await daemon.metric('session_refused_total', session) === refused)
		await robot.state();
	assert.equal(await daemon.metric('session_refused_total', session), refused + 1);
}

async function follows({ client, stream, robot }, aim) {
	robot.tell(`aim ${aim.join(' ')}`);
	await client.until(() => far(stream.tools[0].position, aim) < AT_AIM_M, 'it follows');
	await robot.until((s) => far(s.position_m, aim) < AT_AIM_M); // DDS sends the state a little later
}

test('the operating state is there for who comes late, enabled and homed', async (t) => {
	const { robot } = await driven(t, 'first');
	const told = await robot.crtk();
	assert.deepEqual([told.state, told.homed, told.busy], ['ENABLED', true, false]);
});

// Turns energy off by a command of the controller. If the machine stalls for a second, the driver's deadline may come
// first. That is correct, but the test is of something else, so the trial is then repeated.
async function commandedOff(seen, stop) {
	const { client, stream, robot } = seen;
	for (let tries = 3; ; tries--) {
		await energize(seen);
		robot.tell(`command ${stop}`);
		await client.until(() => !stream.tools[0].energized, 'energy off');
		if (stream.tools[0].energyOff !== 'watchdog' || tries === 1)
			return stream.tools[0].energyOff;
		const { state } = await robot.untilCrtk((c) => c.state !== 'ENABLED');
		robot.tell(`command ${state === 'PAUSED' ? 'resume' : 'enable'}`);
		await robot.untilCrtk((c) => c.state === 'ENABLED');
	}
}

for (const [stop, state, go] of [['pause', 'PAUSED', 'resume'], ['disable', 'DISABLED', 'enable']])
	test(`${stop} stops the tool and its energy, ${go} lets it move, energy wants its own enable`, async (t) => {
		const seen = await driven(t, stop);
		const { stream, robot } = seen;
		await follows(seen, [0.01, 0, 0.02]);
		assert.equal(await commandedOff(seen, stop), 'commanded');
		await robot.untilCrtk((c) => c.state === state);
		await refuses(seen, [-0.01, 0, 0.02]);
		robot.tell(`command ${go}`);
		await robot.untilCrtk((c) => c.state === 'ENABLED');
		await follows(seen, [-0.01, 0.01, 0.02]);
		assert.equal(stream.tools[0].energized, false); // the level was 1 all the time
		await energize(seen);
	});

test('a second button limits the energy in ticks; energy comes back with a new rise alone', async (t) => {
	const TICKS = 30;
	const world = await driven(t, 'limited');
	const { client, stream, robot, session } = world;
	robot.tell(`ticks ${TICKS}`);
	await energize(world);
	await client.until(() => !stream.tools[0].energized, 'energy off');
	assert.equal(stream.tools[0].energyOff, 'commanded');
	const { events } = await client.call('session.timeline', { session });
	const [on, off] = ['energy_on', 'energy_off'].map((kind) => events.find((event) => event.kind === kind).tick);
	assert.equal(off - on, TICKS);
	const { tick } = stream; // the level is written as 1 all the while
	await client.until(() => {
		assert.equal(stream.tools[0].energized, false);
		return stream.tick > tick + TICKS;
	}, 'some ticks');
});

test('unhome and home; commands without a transition change nothing, unknown ones are refused', async (t) => {
	const seen = await driven(t, 'homing');
	const { session, robot } = seen;
	await follows(seen, [0.01, 0, 0.02]);
	robot.tell('command unhome');
	await robot.untilCrtk((c) => c.state === 'ENABLED' && !c.homed);
	await refuses(seen, [-0.01, 0, 0.02]);
	robot.tell('command home');
	await robot.untilCrtk((c) => c.homed);
	await follows(seen, [0, 0.01, 0.02]);

	robot.tell('write off');
	await refusesOne(session, robot, 'command dance');
	robot.tell('command resume');
	robot.tell('command enable');
	robot.tell('command disable');
	await robot.untilCrtk((c) => c.state === 'DISABLED');
	robot.tell('command pause');
	robot.tell('command resume');
	robot.tell('command enable');
	await robot.untilCrtk((c) => c.state === 'ENABLED');
	assert.equal((await robot.crtk()).states, 5); // a command without a transition in CRTK publishes no state
});

test('a stranger may stop a tool that another drives, and not set it going', async (t) => {
	const seen = await driven(t, 'stranger');
	const { session, robot } = seen;
	const stranger = await controller(session);
	await follows(seen, [0, 0, 0.02]);
	await fallSilent(robot);
	stranger.tell('command pause');
	await robot.untilCrtk((c) => c.state === 'PAUSED');
	await refusesOne(session, stranger, 'command resume');
	assert.equal((await robot.crtk()).state, 'PAUSED');
	robot.tell('write on');
	robot.tell('command resume');
	await stranger.untilCrtk((c) => c.state === 'ENABLED');
	await follows(seen, [0, 0.01, 0.02]);
});

test('a paused session is told as paused tools', async (t) => {
	const { client, session, robot } = await driven(t, 'stands');
	await client.call('session.pause', { session });
	await robot.untilCrtk((c) => c.state === 'PAUSED');
	await client.call('session.resume', { session });
	await robot.untilCrtk((c) => c.state === 'ENABLED');
});

test('topics of the jaw are there while the tool has jaws', async (t) => {
	const { client, session, robot } = await found(t, 'jaws');
	const shape = (word) => client.call('tool.configure', { session, tool: 'grasper', shape: word });
	await client.call('tool.take_over', { session, tool: 'grasper' });
	await shape('hook');
	await robot.untilCrtk((c) => c.jaw_topics === 0);
	await shape('grasper');
	await robot.untilCrtk((c) => c.jaw_topics === 3);
	await shape('hook');
	await robot.untilCrtk((c) => c.jaw_topics === 0);
	const late = await controller(session);
	assert.equal((await late.crtk()).jaw_topics, 0);
});

test('the jaw goes where servo_jp says, and measured_js, setpoint_js, measured_cp and setpoint_cp tell', async (t) => {
	const seen = await driven(t, 'jaw');
	const { session, robot } = seen;
	const aim = [0.01, -0.01, 0.02];
	await follows(seen, aim);
	robot.tell('jaw 0.2');
	await robot.untilCrtk((c) => Math.abs(c.jaw_rad - 0.2) < 1e-5 && Math.abs(c.asked_jaw_rad - 0.2) < 1e-5 && far(c.position_m, aim) < AT_AIM_M && far(c.asked_m, aim) < AT_AIM_M);
	await refusesOne(session, robot, 'jaw 0.6');
	assert.ok(Math.abs((await robot.crtk()).jaw_rad - 0.2) < 1e-5);
});

// The jaws are driven by a WebSocket client. Their state is published to every reader.
test('jaws tell how far they are open, how hard they press, what they hold and that it slips', async (t) => {
	const SLIP_N = 0.05, PULL_M = 0.01, NEAR_RAD = 1e-5;
	const client = await daemon.connect({ hello: { client: 'hand' } });
	const definition = await smallScene(client);
	const at = (z) => ({ tool: 'grasper', position_m: [0, 0, z], rotation: [1, 0, 0, 0], jaw: 1 });
	Object.assign(definition.tools[0], { name: 'grasper', shape: 'grasper', jaw_open_rad: JAW_OPEN_RAD, slip_force_n: SLIP_N, ...at(-0.003) });
	for (const word of ['tool', 'jaw']) delete definition.tools[0][word];
	const session = (await client.call('session.create', { name: 'holds', definition })).summary.session;
	t.after(async () => {
		await Controller.killAll();
		await client.call('session.destroy', { session });
		await client.close();
	});
	await client.join(session);
	const listener = await controller(session);
	let sequence = 0;
	const tell = (method, more = {}) => client.call(method, { session, tool: 'grasper', sequence: ++sequence, ...more });
	await listener.until((s) => s.jaw === 1 && s.held === 0 && !s.holding);
	await client.call('tool.take_over', { session, tool: 'grasper' });
	await tell('tool.grasp');
	const held = await listener.until((s) => s.holding && s.held > 0 && s.asked_jaw === 0 && s.jaw < 0.9);
	assert.ok(held.jaw > 0, `open by ${held.jaw}`);
	const told = await listener.untilCrtk((c) => c.asked_jaw_rad === 0 && c.jaw_rad < 0.9 * JAW_OPEN_RAD);
	assert.ok(told.jaw_rad > 0 && told.jaw_nm >= 0);
	await tell('tool.move', at(-0.003 + PULL_M));
	await listener.until((s) => s.slipping);
	await listener.until((s) => s.holding && s.held === 0); // the jaws hold nothing
	await tell('tool.release');
	await listener.until((s) => !s.holding && s.jaw === 1 && s.asked_jaw === 1 && s.jaw_force_n === 0);
	await listener.untilCrtk((c) => Math.abs(c.jaw_rad - JAW_OPEN_RAD) < NEAR_RAD && c.jaw_nm === 0);
});
