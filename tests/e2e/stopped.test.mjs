// SPDX-License-Identifier: GPL-3.0-or-later
// A daemon that is stopped (SIGSTOP) while energy is on: what clients sent meanwhile waits in its sockets, and is
// read after it goes on. E2E_STOPS says how many trials of each way; a few by default, one where the daemon is slow.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { setTimeout as sleep } from 'node:timers/promises';
import { Daemon } from './wire/daemon.mjs';
import { now } from './wire/driver.mjs';
import { AT_REST, smallSession } from './wire/scene.mjs';

const slow = process.env.E2E_SLOW === '1', trials = Number(process.env.E2E_STOPS ?? (slow ? 1 : 3));
const DEADLINE_S = slow ? 2.5 : 0.25, STOP_S = 2.8 * DEADLINE_S, BEAT_MS = 200 * DEADLINE_S, MOST_TICKS = 3;

let daemon, watcher;
before(async () => {
	daemon = await Daemon.start({ settings: { browser_deadline_s: DEADLINE_S } });
	watcher = await daemon.connect();
});
after(() => daemon.end());

const beat = (client) => client.notify('heartbeat', { visible: true });
const beatWithClock = (client) => client.notify('heartbeat', { visible: true, client_time_us: Math.round(1e6 * now()) });

// A driver of the hook that gives signs of life by `sign`.
class Hand {
	static async take(session, sign) {
		const hand = new Hand();
		hand.client = await daemon.connect();
		hand.session = session;
		hand.sign = sign;
		await hand.client.call('tool.take_over', { session, tool: 'hook' });
		hand.live();
		return hand;
	}

	live() {
		this.rest();
		this.sign(this.client, this.session);
		this.timer = setInterval(() => this.sign(this.client, this.session), BEAT_MS);
	}

	rest() {
		clearInterval(this.timer);
	}

	energize(energized = true) {
		return this.client.call('tool.energize', { session: this.session, tool: 'hook', energized });
	}

	async leave() {
		this.rest();
		await this.client.close();
	}
}

// Stops the daemon while energy is on. The driver lives on for `lives_s` and does `last` in the end. Returns how many
// ticks were computed with energy after the daemon went on.
async function stop(hand, stream, livesS, last = () => {}) {
	const { session } = hand;
	hand.live();
	await hand.energize();
	await watcher.until(() => stream.tools[0].energized, 'energy on');
	const phase = stream.tick + 5;
	await watcher.until(() => stream.tick > phase, 'energy for a while');
	daemon.process.kill('SIGSTOP');
	await sleep(1000 * livesS);
	hand.rest();
	const answer = last(hand.client, session)?.catch(() => {});
	await sleep(1000 * (STOP_S - livesS));
	const seen = [], goesOn = 1e6 * now();
	const watching = setInterval(() => {}, 1000); // keeps this process
	const on = watcher.until(() => {
		seen.push({ tick: stream.tick, made: stream.published, energized: stream.tools[0].energized });
		return stream.published > goesOn + 2e6 * DEADLINE_S && !stream.tools[0].energized;
	}, 'energy off, and two deadlines over');
	daemon.process.kill('SIGCONT');
	await on;
	await answer;
	clearInterval(watching);
	const before = Math.max(...seen.filter(({ made }) => made < goesOn).map(({ tick }) => tick), phase);
	return Math.max(0, ...seen.filter(({ energized }) => energized).map(({ tick }) => tick - before));
}

async function measure(t, name, sign, livesS, last) {
	const session = await smallSession(watcher, name);
	const stream = await watcher.join(session, { rate_hz: 1000, channels: ['mask', 'tools'] });
	const hand = await Hand.take(session, sign);
	await sleep(10 * BEAT_MS); // some heartbeats, by which the clock is known
	const ticks = [];
	for (let i = 0; i < trials; i++)
		ticks.push(await stop(hand, stream, livesS, last));
	t.diagnostic(`ticks with energy after the stop: ${ticks.join(' ')}`);
	assert.ok(Math.max(...ticks) <= MOST_TICKS, `${Math.max(...ticks)} ticks with energy`);
	await hand.leave();
	await watcher.call('session.destroy', { session });
}

const move = (client, session) => client.notify('tool.move', { session, tool: 'hook', position_m: [0, 0, 0.02], rotation: AT_REST });
const enable = (client, session) => client.call('tool.energize', { session, tool: 'hook', energized: true });

const SIGNS = { 'heartbeats with a clock': beatWithClock, heartbeats: beat, motion: move };
for (const [name, sign] of Object.entries(SIGNS)) {
	const word = name.replaceAll(' ', '-');
	test(`${name} that piled up before the driver fell silent do not keep energy on`, (t) =>
		measure(t, `${word}-piled`, sign, 0.4 * DEADLINE_S));
	test(`${name} that go on through the stop do not either`, (t) =>
		measure(t, `${word}-through`, sign, STOP_S));
	test(`${name} and an enable that piled up do not bring energy back`, (t) =>
		measure(t, `${word}-enable`, sign, 0.4 * DEADLINE_S, enable));
}

test('motion of a driver that sends its clock is no sign of life', async () => {
	const session = await smallSession(watcher, 'motion-alone');
	const stream = await watcher.join(session, { rate_hz: 1000, channels: ['mask', 'tools'] });
	const hand = await Hand.take(session, beatWithClock);
	await hand.energize();
	await watcher.until(() => stream.tools[0].energized, 'energy on');
	hand.rest();
	const moving = setInterval(() => move(hand.client, session), BEAT_MS);
	await watcher.until(() => !stream.tools[0].energized, 'energy off');
	assert.equal(stream.tools[0].energyOff, 'watchdog');
	await assert.rejects(hand.energize(), /no heartbeat/);
	beat(hand.client); // without its clock it does not count either
	await assert.rejects(hand.energize(), /no heartbeat/);
	beatWithClock(hand.client);
	await hand.energize();
	clearInterval(moving);
	await hand.leave();
	await watcher.call('session.destroy', { session });
});

test('a driver that lives keeps its energy, with a clock and without, and gets it back after a stop', async () => {
	for (const [name, sign] of Object.entries(SIGNS)) {
		const session = await smallSession(watcher, `lives-${name.replaceAll(' ', '-')}`);
		const stream = await watcher.join(session, { rate_hz: 1000, channels: ['mask', 'tools'] });
		const hand = await Hand.take(session, sign);
		await stop(hand, stream, STOP_S);
		hand.live();
		await sleep(2000 * DEADLINE_S); // what is read right after a stop is no sign of life
		await hand.energize();
		await watcher.until(() => stream.tools[0].energized, 'energy on again');
		const begun = stream.tick;
		await watcher.until(() => stream.tick > begun + 90 || !stream.tools[0].energized, 'energy for a while');
		assert.ok(stream.tools[0].energized);
		await hand.leave();
		await watcher.call('session.destroy', { session });
	}
});
