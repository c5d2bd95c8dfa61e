// SPDX-License-Identifier: GPL-3.0-or-later
// Energy is off when it was turned off, whatever others have queued for later: an operator queues as
// many commands for a tick that never comes as it can, and a driver queues enables and moves for ticks
// that do come. Then energy goes off in every way there is. Frames show the core's own flag.
import assert from 'node:assert/strict';
import { rmSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';
import { AT_REST, smallSession } from './wire/scene.mjs';

const FLOOD = 1100; // more than the core's queue held when it was the place where these waited
const FAR = 1e9;
const OF_CLIENT = 64;
const LOOKED = 40; // ticks after which something that waited would have shown

let daemon, operator, watcher;
const settings = { browser_deadline_s: 5, resume_s: 0, max_requests_per_s: 100000 };
before(async () => {
	daemon = await Daemon.start({ settings });
	operator = await daemon.connect();
	watcher = await daemon.connect();
});
after(() => daemon.end());

const hook = (session) => ({ session, tool: 'hook' });
const energize = (client, session, energized, more = {}) => client.call('tool.energize', { ...hook(session), energized, ...more });
const failed = (promise) => promise.then(() => null, (error) => error);

// The refusals of a flood; what waits stays unanswered.
async function flood(client, session) {
	const refusals = [];
	for (let i = 0; i < FLOOD; i++)
		client.call('gravity.set', { session, gravity_m_s2: [0, 0, -9.81], tick: FAR + i }).catch((error) => refusals.push(error));
	await client.call('session.describe', { session });
	await client.until(() => refusals.length >= FLOOD - OF_CLIENT, 'the refusals');
	return refusals;
}

async function energized(name, options = {}) {
	const session = await smallSession(operator, name, options);
	const stream = await watcher.join(session, { rate_hz: 1000, channels: ['mask', 'tools'] });
	await flood(operator, session);
	const driver = await daemon.connect();
	await driver.call('tool.take_over', hook(session));
	await energize(driver, session, true);
	await watcher.until(() => stream.tools[0].energized, 'energy on');
	return { session, stream, driver };
}

// What the driver has queued for ticks that come.
function queueAhead(driver, session, tick) {
	const far = { ...hook(session), tick };
	return [
		failed(driver.call('tool.energize', { ...far, energized: true })),
		failed(driver.call('tool.move', { ...far, position_m: [0.03, 0.03, 0.05], rotation: AT_REST })),
		failed(driver.call('tool.remove', far)),
	];
}

// For LOOKED ticks, and as many after tick `past`.
async function staysDark(stream, seen = watcher, past = 0) {
	await seen.until(() => !stream.tools[0].energized, 'energy off');
	const tick = stream.tick, at = [...stream.tools[0].position];
	await seen.until(() => {
		assert.equal(stream.tools.length, 1);
		assert.equal(stream.tools[0].energized, false, `energy is on at tick ${stream.tick}`);
		return stream.tick > Math.max(tick, past) + LOOKED;
	}, 'some ticks');
	return at.map((x, axis) => Math.abs(x - stream.tools[0].position[axis]));
}

test('a client has 64 commands for later ticks; they are listed, cancelled, and hurt nobody', async () => {
	const session = await smallSession(operator, 'listed');
	const refusals = await flood(operator, session);
	assert.equal(refusals.length, FLOOD - OF_CLIENT);
	for (const { data } of refusals)
		assert.match(data.reason, /64 commands of this client wait for later ticks/);
	const { commands } = await watcher.call('session.waiting', { session });
	assert.equal(commands.length, OF_CLIENT);
	assert.deepEqual({ method: commands[0].method, tick: commands[0].tick, client: commands[0].client },
		{ method: 'gravity.set', tick: FAR, client: operator.hello.client });
	// another client's commands, for now and for later, are taken
	const other = await daemon.connect({ hello: { role: 'operate' } });
	await other.call('gravity.set', { session, gravity_m_s2: [0, 0, -9.8] });
	const its = other.call('gravity.set', { session, gravity_m_s2: [0, 0, -9.7], tick: FAR });
	await other.call('session.describe', { session });
	// one by its number: not another's, but for an admin
	const number = commands[3].number;
	assert.equal((await failed(other.call('session.cancel', { session, number }))).data.status, 'not_found');
	assert.deepEqual(await watcher.call('session.cancel', { session, number }), { count: 1 }); // without tokens all are admins
	assert.deepEqual(await operator.call('session.cancel', { session }), { count: OF_CLIENT - 1 });
	await operator.until(() => operator.calls.size === 0, 'all are answered');
	assert.deepEqual(await other.call('session.cancel', { session }), { count: 1 });
	assert.match((await failed(its)).data.reason, /cancelled/);
	assert.deepEqual((await watcher.call('session.waiting', { session })).commands, []);
	await other.close();
});

test('off', async () => {
	const { session, stream, driver } = await energized('off');
	const ahead = queueAhead(driver, session, stream.tick + 2 * LOOKED);
	await energize(operator, session, false);
	await staysDark(stream);
	await driver.call('session.cancel', { session });
	await Promise.all(ahead);
	await driver.close();
});

test('a hidden page, a lost connection: what the driver had queued moves and heats nothing', async () => {
	for (const how of ['hidden', 'lost']) {
		const { session, stream, driver } = await energized(how);
		const ahead = queueAhead(driver, session, stream.tick + LOOKED);
		await driver.call('session.describe', { session });
		if (how === 'hidden')
			driver.notify('heartbeat', { visible: false });
		else
			driver.terminate();
		const moved = await staysDark(stream);
		await watcher.until(() => stream.tick > LOOKED + 10, 'its tick');
		for (const way of moved)
			assert.ok(way < 1e-3, `it moved by ${way} m`);
		const errors = await Promise.all(ahead);
		if (how === 'hidden')
			assert.ok(errors.every((error) => error?.data.status === 'bad_state'));
		await driver.close();
	}
});

test('a hand-over, a take-over: nothing of the driver before acts, not even its scheduled off', async () => {
	for (const how of ['hand', 'take']) {
		const { session, stream, driver } = await energized(how);
		const ahead = queueAhead(driver, session, stream.tick + LOOKED);
		const off = failed(energize(driver, session, false, { tick: stream.tick + LOOKED }));
		await driver.call('session.describe', { session });
		const next = await daemon.connect();
		if (how === 'hand')
			await driver.call('tool.hand_over', { ...hook(session), client: next.hello.client });
		else
			await next.call('tool.take_over', hook(session));
		for (const error of await Promise.all([...ahead, off]))
			assert.equal(error?.data.status, 'bad_state');
		await staysDark(stream);
		// the next driver's energy stays on beyond the tick of that off
		await energize(next, session, true);
		await watcher.until(() => stream.tools[0].energized, 'energy on');
		const tick = stream.tick;
		await watcher.until(() => {
			assert.equal(stream.tools[0].energized, true, `energy is off at tick ${stream.tick}`);
			return stream.tick > tick + LOOKED;
		}, 'some ticks');
		await energize(next, session, false);
		await driver.close();
		await next.close();
	}
});

test('a pause', async () => {
	const { session, stream, driver } = await energized('pause');
	const ahead = queueAhead(driver, session, stream.tick + LOOKED);
	await operator.call('session.pause', { session });
	await watcher.until(() => !stream.tools[0].energized, 'energy off');
	await driver.call('session.cancel', { session });
	await Promise.all(ahead);
	await operator.call('session.step', { session, ticks: 2 * LOOKED });
	assert.equal(stream.tools[0].energized, false);
	await driver.close();
});

test('kill -9 and restart', async () => {
	const one = await Daemon.start({ settings });
	const client = await one.connect(), driver = await one.connect();
	const session = await smallSession(client, 'killed');
	const stream = await client.join(session, { rate_hz: 1000, channels: ['mask', 'tools'] });
	await flood(driver, session);
	await driver.call('session.cancel', { session });
	await driver.call('tool.take_over', hook(session));
	await energize(driver, session, true);
	await client.until(() => stream.tools[0].energized, 'energy on');
	const tick = stream.tick + 4 * LOOKED;
	const ahead = queueAhead(driver, session, tick);
	for (const command of ahead)
		command.catch(() => {});
	assert.equal((await driver.call('session.waiting', { session })).commands.length, ahead.length);
	await one.kill();
	const again = await Daemon.start({ settings, folder: one.folder });
	const seer = await again.connect();
	const later = await seer.join(session, { rate_hz: 1000, channels: ['mask', 'tools'] });
	await staysDark(later, seer, tick);
	await again.end();
	rmSync(one.folder, { recursive: true, force: true });
});

test('a limit belongs to its enable', async () => {
	const session = await smallSession(operator, 'limited');
	const stream = await watcher.join(session, { rate_hz: 1000, channels: ['mask', 'tools'] });
	const driver = await daemon.connect();
	await driver.call('tool.take_over', hook(session));
	const { tick } = await energize(driver, session, true, { ticks: 20 });
	await watcher.until(() => stream.tick > tick + 20 + LOOKED, 'its end');
	const off = (await watcher.call('session.timeline', { session })).events.find((event) => event.kind === 'energy_off');
	assert.equal(off.tick, tick + 20);
	assert.equal(stream.tools[0].energized, false);
	assert.equal(stream.tools[0].energyOff, 'commanded');
	// renewed, it goes on; handed over, the next enable knows nothing of it
	const first = await energize(driver, session, true, { ticks: 30 });
	const renewed = await energize(driver, session, true, { ticks: 60 });
	const next = await daemon.connect();
	await watcher.until(() => stream.tick > first.tick + 31, 'the first limit');
	assert.equal(stream.tools[0].energized, stream.tick <= renewed.tick + 60);
	await driver.call('tool.hand_over', { ...hook(session), client: next.hello.client });
	await energize(next, session, true);
	await watcher.until(() => stream.tick > renewed.tick + 60 + LOOKED, 'the second limit');
	assert.equal(stream.tools[0].energized, true);
	await energize(next, session, false);
	await driver.close();
	await next.close();
});

test('the freeze of the server is a command of its own in the log', async () => {
	const session = await smallSession(operator, 'frozen');
	const driver = await daemon.connect();
	await watcher.join(session, { channels: ['tools'] });
	await driver.call('tool.take_over', hook(session));
	await driver.call('tool.move', { ...hook(session), sequence: 41, position_m: [0, 0, 0.03], rotation: AT_REST });
	await energize(driver, session, true, { sequence: 42 });
	driver.notify('heartbeat', { visible: false });
	await watcher.until(() => watcher.notice('event', (params) => params.session === session && params.event.kind === 'watchdog'), 'the cut');
	const lines = (await operator.file('session.log', { session })).toString().trim().split('\n').map((line) => JSON.parse(line));
	const hold = lines.find(({ command }) => command === 'tool.hold');
	assert.deepEqual({ tool: hold.tool, sequence: hold.sequence }, { tool: 'hook', sequence: 0 });
	assert.equal(lines.filter(({ command }) => command === 'tool.move').length, 1);
	assert.deepEqual(lines.filter(({ sequence }) => sequence > 0).map(({ sequence }) => sequence), [41, 42]);
	await driver.close();
});
