// SPDX-License-Identifier: GPL-3.0-or-later
// Energy stays off after a cut, whatever came before it: random sequences over real connections, in many
// sessions at once. Two clients take the hook from each other, turn energy on for now and for later ticks,
// hide, pause, and lose their connections. Each sequence ends with a cut. Frames show the core's own flag.
// Rounds end with kill -9. E2E_SEQUENCES sets the number of sequences, E2E_SEED another beginning.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';
import { AT_REST, smallSession } from './wire/scene.mjs';

const SEQUENCES = Number(process.env.E2E_SEQUENCES ?? 240), SEED = Number(process.env.E2E_SEED ?? 1);
const LANES = 8, ROUND = 15; // sessions at once, and sequences of each between two kills
const STEPS_MOST = 10, LATER_MOST = 8; // ticks ahead
const ENERGIZED_LEAST = 0.25; // of the sequences; otherwise the test shows nothing
const CUTS = ['off', 'off_by_other', 'hidden', 'lost', 'taken_over', 'pause', 'reset', 'restore'];

// Mulberry32: each session has its own numbers, so that they do not depend on how the sessions interleave.
function randomOf(seed) {
	let state = seed >>> 0;
	return (most) => {
		state = (state + 0x6d2b79f5) >>> 0;
		let t = Math.imul(state ^ (state >>> 15), state | 1);
		t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
		return ((t ^ (t >>> 14)) >>> 0) % most;
	};
}

const refused = (promise) => promise.catch((error) => {
	if (error.code === undefined && !/^closed/.test(error.message))
		throw error;
});

class Lane {
	constructor(index) {
		this.random = randomOf(1000 * SEED + index);
		this.index = index;
		this.steps = [];
		this.energized = this.count = 0;
	}

	get hook() {
		return { session: this.session, tool: 'hook' };
	}

	async make(daemon) {
		this.daemon = daemon;
		this.watcher = await daemon.connect();
		this.session = await smallSession(this.watcher, `lane-${this.index}`);
		await this.watcher.call('session.snapshot', { session: this.session, name: 'start' });
		await this.enter(daemon);
	}

	async enter(daemon) {
		this.daemon = daemon;
		if (this.watcher.closeCode)
			this.watcher = await daemon.connect();
		this.clients = [await daemon.connect(), await daemon.connect()];
		this.stream = await this.watcher.join(this.session, { rate_hz: 1000, channels: ['mask', 'tools'] });
		this.watcher.onFrame = (stream) => { this.seen ||= stream.tools[0]?.energized; };
	}

	async end() {
		await Promise.all([this.watcher, ...this.clients].map((client) => client.close()));
	}

	energize(who, energized, later = 0) {
		const params = { ...this.hook, energized, ...(later && { tick: this.stream.tick + later }) };
		void refused(this.clients[who].call('tool.energize', params));
	}

	// What a sequence is made of. Nothing here waits for an answer, but for those of the store.
	async step() {
		const who = this.random(2), client = this.clients[who], later = 1 + this.random(LATER_MOST);
		const [name, act] = [
			['take', () => void refused(client.call('tool.take_over', this.hook))],
			['on', () => this.energize(who, true)],
			['on', () => this.energize(who, true)],
			[`on+${later}`, () => this.energize(who, true, later)],
			['off', () => this.energize(who, false)],
			[`off+${later}`, () => this.energize(who, false, later)],
			['move', () => client.notify('tool.move', { ...this.hook, position_m: [0, 0, 0.05], rotation: AT_REST })],
			[`move+${later}`, () => void refused(client.call('tool.move',
				{ ...this.hook, position_m: [0, 0, 0.06], rotation: AT_REST, tick: this.stream.tick + later }))],
			['hide', () => client.notify('heartbeat', { visible: false })],
			['show', () => client.notify('heartbeat', { visible: true })],
			['lose', () => this.replace(who)],
			['pause', () => void refused(client.call('session.pause', { session: this.session }))],
			['resume', () => void refused(client.call('session.resume', { session: this.session }))],
			['tick', () => this.ticks(1)],
		][this.random(14)];
		this.steps.push(`${who}:${name}`);
		await act();
	}

	async replace(who) {
		this.clients[who].terminate();
		this.clients[who] = await this.daemon.connect();
	}

	async ticks(count) {
		const { state } = (await this.watcher.call('session.describe', { session: this.session })).summary;
		if (state !== 'running')
			return;
		const { tick, epoch } = this.stream;
		await this.watcher.until(() => this.stream.epoch !== epoch || this.stream.tick >= tick + count || (this.stream.flags & 1),
			'some ticks');
	}

	// All that a client sent was taken in.
	settle(client) {
		return client.call('session.describe', { session: this.session });
	}

	async cut(kind, who) {
		const { session } = this, client = this.clients[who], other = this.clients[1 - who];
		await this.settle(other);
		if (['off_by_other', 'lost', 'pause', 'reset', 'restore', 'taken_over'].includes(kind))
			await this.settle(client);
		switch (kind) {
		case 'off': return client.call('tool.energize', { ...this.hook, energized: false });
		case 'off_by_other': return other.call('tool.energize', { ...this.hook, energized: false });
		case 'hidden': client.notify('heartbeat', { visible: false }); return this.settle(client);
		case 'lost': return this.lose(who);
		case 'taken_over': return other.call('tool.take_over', this.hook);
		case 'pause': return other.call('session.pause', { session });
		case 'reset': return other.call('session.reset', { session });
		case 'restore': return other.call('session.restore', { session, name: 'start' });
		}
	}

	// The server has noticed when nobody drives the tool.
	async lose(who) {
		const { client: number } = this.clients[who].hello;
		await this.replace(who);
		for (;;) {
			const { drivers } = await this.settle(this.watcher);
			if (!drivers.some((driver) => driver.client === number))
				return;
		}
	}

	// From the tick of the cut on no frame may show energy.
	async staysDark(what) {
		const { summary } = await this.settle(this.watcher);
		const epoch = BigInt(`0x${summary.epoch}`);
		if (summary.state === 'paused')
			await this.watcher.call('session.resume', { session: this.session });
		const until = summary.tick + LATER_MOST + STEPS_MOST;
		await this.watcher.until(() => {
			const { stream } = this;
			if (stream.epoch !== epoch || stream.tick <= summary.tick)
				return false;
			assert.equal(stream.tools[0].energized, false,
				`${this.session}, seed ${SEED}, sequence ${this.count}: energized at tick ${stream.tick}, after ${what} at ${summary.tick}`);
			return stream.tick > until;
		}, 'some ticks');
	}

	async sequence() {
		this.steps = [];
		this.seen = false;
		const who = this.random(2), kind = CUTS[this.random(CUTS.length)];
		for (let left = 1 + this.random(STEPS_MOST); left > 0; left--)
			await this.step();
		await this.settle(this.clients[1 - who]); // else its own take_over may come after this one
		await refused(this.clients[who].call('tool.take_over', this.hook));
		this.energize(who, true);
		this.energize(who, true, 1 + this.random(LATER_MOST));
		await this.ticks(this.random(3));
		await this.cut(kind, who);
		await this.staysDark(`${this.steps.join(' ')} and ${kind} by ${who}`);
		this.energized += this.seen;
		this.count++;
	}

	// What a kill must end: energy that is on, and energy that was asked for.
	async light() {
		await refused(this.watcher.call('session.resume', { session: this.session }));
		await this.watcher.call('tool.take_over', this.hook);
		await this.watcher.call('tool.energize', { ...this.hook, energized: true });
		await this.watcher.until(() => this.stream.tools[0].energized, 'energy on');
		void refused(this.watcher.call('tool.energize', { ...this.hook, energized: true, tick: this.stream.tick + 2 * LATER_MOST }));
	}
}

const settings = { browser_deadline_s: 10, resume_s: 0, quota_admin: 1000000, quota_all: 1000000 };

test(`${SEQUENCES} sequences: no energy after a cut, nor after kill -9`, async (t) => {
	const lanes = Array.from({ length: LANES }, (_, index) => new Lane(index));
	let daemon = await Daemon.start({ settings }), kills = 0;
	await Promise.all(lanes.map((lane) => lane.make(daemon)));
	const sum = (member) => lanes.reduce((total, lane) => total + lane[member], 0);
	while (sum('count') < SEQUENCES) {
		await Promise.all(lanes.map(async (lane) => {
			for (let i = 0; i < ROUND; i++)
				await lane.sequence();
			await lane.light();
		}));
		await daemon.kill();
		kills++;
		daemon = await Daemon.start({ folder: daemon.folder, settings });
		await Promise.all(lanes.map(async (lane) => {
			await lane.watcher.closed;
			await lane.enter(daemon);
			await lane.staysDark('kill -9');
		}));
	}
	t.diagnostic(`${sum('count')} sequences with energy on in ${sum('energized')}, and ${kills} kills, seed ${SEED}: none energized after its cut`);
	assert.ok(sum('energized') >= ENERGIZED_LEAST * sum('count'), `energy was on in ${sum('energized')} alone`);
	await Promise.all(lanes.map((lane) => lane.end()));
	await daemon.end();
});
