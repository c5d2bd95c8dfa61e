// SPDX-License-Identifier: GPL-3.0-or-later
// A session moves between two daemons with all that belongs to it, and whoever is killed when: at most
// one serves it, and one in the end.
import assert from 'node:assert/strict';
import { execFile, spawn } from 'node:child_process';
import { test } from 'node:test';
import { setTimeout } from 'node:timers/promises';
import { Courier } from './wire/courier.mjs';
import { Daemon } from './wire/daemon.mjs';
import { AT_REST, cutMiddle, picture, smallSession } from './wire/scene.mjs';

const settings = (label) => ({ label });
const daemons = async () => Promise.all(['d1', 'd2'].map((label) => Daemon.start({ settings: settings(label) })));
const again = (daemon, label) => Daemon.start({ folder: daemon.folder, settings: settings(label) });
const at = (daemon) => `ws://127.0.0.1:${daemon.port}`; // for the command line
const rejection = (promise) => promise.then(() => null, (error) => error);
const serves = async (client, session) =>
	(await client.call('session.list')).sessions.some((s) => s.session === session && s.state !== 'starting');

async function end(...all) {
	for (const daemon of all)
		assert.equal((await daemon.end()).code, 0);
}

// The command line, while this process goes on answering.
const run = (words) => new Promise((resolve) => execFile(process.env.CAUTERY, words, (error, stdout, stderr) =>
	resolve({ status: error ? error.code : 0, stdout, stderr })));

// The state's hash, by a snapshot that nobody steps past.
const hashOf = async (client, session, name) => (await client.call('session.snapshot', { session, name })).hash;

test('all of a session moves: its state to the bit, history, answers, drivers; its old id leads there', async () => {
	const [d1, d2] = await daemons();
	const one = await d1.connect(), two = await d2.connect();
	const driver = await d1.connect({ hello: { client_id: 'surgeon' } });
	const session = await smallSession(one, 'knee', { paused: true });
	const twin = await smallSession(one, 'twin', { paused: true }); // is not moved
	for (const id of [session, twin])
		await cutMiddle(driver, id, 60);
	await one.call('session.snapshot', { session, name: 'first' });
	await one.call('session.rewind', { session, tick: 40 });
	await one.call('session.rewind', { session: twin, tick: 40 });
	const stepped = await driver.call('session.step', { session, ticks: 7, client_sequence: 91 });
	await driver.call('session.step', { session: twin, ticks: 7 });
	const before = await one.call('session.timeline', { session });
	const stream = await one.join(session);
	await one.call('session.speed', { session, speed: 0.5 });

	const courier = new Courier(one, two, session, 'd2-knee');
	await courier.walk('part');
	await courier.ready();
	assert.equal(courier.stands.exact, true);
	// What comes about meanwhile goes with the rest.
	const late = await driver.call('tool.energize', { session, tool: 'hook', energized: false, client_sequence: 92 });
	await courier.hold();
	const waits = rejection(driver.call('session.step', { session, ticks: 5, client_sequence: 93 }));
	await courier.rest();
	await courier.commit();
	await courier.accept();

	// Whoever waited, and whoever asks, is told; so is who watched.
	const told = await waits;
	assert.deepEqual([told.code, told.data.status, told.data.moved_to], [-32051, 'moved', 'd2-knee']);
	const asked = await rejection(one.call('session.describe', { session }));
	assert.deepEqual([asked.code, asked.data.moved_to, asked.data.path], [-32051, 'd2-knee', 'params.session']);
	await one.until(() => one.notice('session.changed', (p) => p.change === 'moved' && p.moved_to === 'd2-knee'), 'news');
	assert.equal(await serves(one, session), false);
	assert.equal((await rejection(smallSession(one, 'knee'))).data.status, 'already_exists');
	// What was answered before is answered again, here and there, and does nothing.
	assert.equal((await driver.call('session.step', { session, ticks: 7, client_sequence: 91 })).tick, stepped.tick);

	const here = await d2.connect({ hello: { client_id: 'surgeon', resume: driver.hello.resume } });
	const there = 'd2-knee';
	const described = await here.call('session.describe', { session: there });
	assert.equal(described.summary.state, 'paused');
	assert.equal(described.summary.speed, 0.5);
	assert.equal(described.summary.tick, stepped.tick);
	assert.deepEqual(described.drivers.map((d) => [d.tool, d.client, d.energized]), [['hook', here.hello.client, false]]);
	for (const [sequence, tick] of [[91, stepped.tick], [92, late.tick]])
		assert.equal((await here.call(sequence === 91 ? 'session.step' : 'tool.energize', {
			session: there, client_sequence: sequence, ...(sequence === 91 ? { ticks: 7 } : { tool: 'hook', energized: false }),
		})).tick, tick);
	assert.equal((await here.call('session.describe', { session: there })).summary.tick, stepped.tick);
	const after = await here.call('session.timeline', { session: there });
	assert.deepEqual(after.events.slice(0, before.events.length), before.events);
	const now = await here.join(there);
	assert.deepEqual(picture(now), picture(stream));

	// It goes on as one does that was never moved, and back to what was before.
	await here.call('session.step', { session: there, ticks: 30 });
	await driver.call('tool.energize', { session: twin, tool: 'hook', energized: false });
	await driver.call('session.step', { session: twin, ticks: 30 });
	assert.equal(await hashOf(here, there, 'went-on'), await hashOf(driver, twin, 'went-on'));
	const { snapshots } = await here.call('session.snapshots', { session: there });
	assert.ok(snapshots.some(({ name }) => name === 'first'));
	const restored = await here.call('session.restore', { session: there, name: 'first' });
	assert.equal(restored.exact, true);
	assert.equal((await here.call('session.reset', { session: there })).tick, 0);
	await end(d1, d2);
});

// Of a session whose states differ by what was acknowledged: the tick tells.
async function startMove(d1, d2) {
	const one = await d1.connect(), two = await d2.connect();
	const session = await smallSession(one, 'knee', { paused: true, cells: [8, 6] });
	await one.call('session.step', { session, ticks: 3 });
	return { one, two, session };
}

async function settled(d1, d2) {
	const one = await d1.connect(), two = await d2.connect();
	await Courier.settle(one, two);
	const at = [await serves(one, 'd1-knee'), await serves(two, 'd2-knee')];
	assert.equal(at[0] !== at[1], true, `${at} serve it`);
	const [client, session] = at[0] ? [one, 'd1-knee'] : [two, 'd2-knee'];
	assert.equal((await client.call('session.step', { session, ticks: 1 })).tick, 4);
	assert.deepEqual((await two.call('move.list')).moves.filter((m) => m.state !== 'gone'), []);
	return at[1];
}

for (const victim of ['source', 'target', 'courier', 'both'])
	for (const step of Courier.STEPS)
		test(`${victim} killed after ${step}: one serves it in the end, and never two`, async () => {
			let [d1, d2] = await daemons();
			const { one, two, session } = await startMove(d1, d2);
			await new Courier(one, two, session, 'd2-knee').walk(step);
			if (victim === 'courier')
				for (const client of [one, two])
					client.terminate();
			if (victim === 'source' || victim === 'both') {
				await d1.kill();
				d1 = await again(d1, 'd1');
			}
			if (victim === 'target' || victim === 'both') {
				await d2.kill();
				d2 = await again(d2, 'd2');
			}
			// Before anybody asks: the target serves only what it has seen the proof of.
			const early = await d2.connect();
			assert.equal(await serves(early, 'd2-knee'), step === 'accept');
			const moved = await settled(d1, d2);
			assert.equal(moved, step === 'commit' || step === 'accept');
			await end(d1, d2);
		});

// The process kills itself between what is on the disk and what is said of it.
for (const [point, moved] of [['move_stopped', false], ['move_decided', true], ['move_piece', false], ['move_last_piece', false], ['move_accepted', true]])
	test(`killed at ${point}: one serves it in the end`, async () => {
		const atTarget = /piece|accepted/.test(point);
		const dying = { program: process.env.CAUTERYD_DYING, environment: { CAUTERYD_DIES_AT: point } };
		let d1 = await Daemon.start({ settings: settings('d1'), ...(atTarget ? {} : dying) });
		let d2 = await Daemon.start({ settings: settings('d2'), ...(atTarget ? dying : {}) });
		const { one, two, session } = await startMove(d1, d2);
		const failed = await rejection(new Courier(one, two, session, 'd2-knee').walk());
		assert.match(failed.message, /closed/);
		const dead = atTarget ? d2 : d1;
		assert.equal((await dead.exited).signal, 'SIGKILL');
		if (atTarget)
			d2 = await again(d2, 'd2');
		else
			d1 = await again(d1, 'd1');
		assert.equal(await settled(d1, d2), moved);
		await end(d1, d2);
	});

test('a session goes there and back, and is led to where it is', async () => {
	const [d1, d2] = await daemons();
	const { one, two, session } = await startMove(d1, d2);
	await new Courier(one, two, session, 'd2-knee').walk();
	await new Courier(two, one, 'd2-knee', session).walk();
	assert.equal((await one.call('session.step', { session, ticks: 1 })).tick, 4);
	const asked = await rejection(two.call('session.describe', { session: 'd2-knee' }));
	assert.equal(asked.data.moved_to, session);
	await end(d1, d2);
});

test('what does not fit is refused, and nothing is served before its time', async () => {
	const [d1, d2] = await daemons();
	const { one, two, session } = await startMove(d1, d2);
	const courier = new Courier(one, two, session, 'd2-knee');
	assert.equal((await rejection(new Courier(one, two, session, 'd1-knee').begin())).data.path, 'params.target');
	await courier.walk('ready');
	assert.equal((await rejection(new Courier(one, two, session, 'd2-knee').begin())).data.status, 'bad_state');
	assert.equal((await rejection(courier.commit())).data.status, 'bad_state'); // not all has been read
	assert.equal((await rejection(two.call('session.destroy', { session: 'd2-knee' }))).data.status, 'bad_state');
	assert.equal((await rejection(smallSession(two, 'knee'))).data.status, 'already_exists');
	await courier.hold();
	await courier.rest();
	courier.proof = '0'.repeat(64);
	assert.equal((await rejection(courier.accept())).data.path, 'params.proof');
	assert.equal(await serves(two, 'd2-knee'), false);
	// A daemon that the session did not come from must not say that it stays there.
	const stranger = await rejection(two.call('move.cancel', { session, move: courier.move }));
	assert.equal(stranger.data.status, 'not_here');
	await two.upload('piece', 'piece.caum', Buffer.from('no piece at all, though long enough'));
	const refused = await rejection(two.call('move.receive', { session: 'd2-knee', move: courier.move, upload: 'piece' }));
	assert.equal(refused.data.status, 'corrupt');
	const operator = await d1.connect({ hello: { role: 'operate' } });
	assert.equal((await rejection(operator.call('move.list'))).data.status, 'forbidden');
	assert.equal(await settled(d1, d2), false);
	await end(d1, d2);
});

test('a courier that dies before the target has a piece leaves nothing that stands in the way', async () => {
	const [d1, d2] = await daemons();
	const { one, two, session } = await startMove(d1, d2);
	const dead = new Courier(one, two, session, 'd2-knee');
	for (let i = 0; i < 3; i++)
		await dead.begin();
	await one.file('move.read', dead.ofSource());
	assert.equal((await rejection(new Courier(one, two, session, 'd2-knee').begin())).data.status, 'bad_state');
	await setTimeout(10_500); // FIRST_PIECE_MOST_S of server/move/departures.c, and a little
	await new Courier(one, two, session, 'd2-knee').walk('part');
	// The command line also ends a move that only the source knows.
	assert.equal(await settled(d1, d2), false);
	await dead.begin();
	await one.file('move.read', dead.ofSource());
	const cancelled = await run(['move', session, 'd2', '--cancel', '--url', at(d1), '--to-url', at(d2)]);
	assert.equal(cancelled.status, 0, cancelled.stderr);
	assert.deepEqual((await one.call('move.list')).moves, []);
	await end(d1, d2);
});

test('a piece that is sent again is answered again, and a damaged one is refused', async () => {
	const [d1, d2] = await daemons();
	const { one, two, session } = await startMove(d1, d2);
	const courier = new Courier(one, two, session, 'd2-knee');
	const give = async (bytes) => {
		await two.upload('piece', 'piece.caum', bytes);
		return two.call('move.receive', { ...courier.ofTarget(), upload: 'piece' });
	};
	await courier.walk('hold');
	const last = await one.file('move.read', courier.ofSource());
	for (const place of [0, 12, 40, last.length >> 1, last.length - 65, last.length - 1]) {
		const damaged = Buffer.from(last);
		damaged[place] ^= 4;
		assert.match((await rejection(give(damaged))).data.status, /corrupt|unsupported|bad_value/, `at ${place}`);
	}
	assert.equal((await rejection(courier.commit())).data.path, 'params.receipt');
	const [first, second] = [await give(last), await give(last)];
	assert.match(first.receipt, /^[0-9a-f]{64}$/);
	assert.deepEqual(second, first);
	Object.assign(courier, first);
	await courier.commit();
	await courier.accept();
	assert.equal(await settled(d1, d2), true);
	await end(d1, d2);
});

test('what is in doubt is forgotten by the source\'s word alone, or where that is lost for good', async () => {
	let [d1, d2] = await daemons();
	const { one, two, session } = await startMove(d1, d2);
	const courier = new Courier(one, two, session, 'd2-knee');
	await courier.walk('rest');
	const forget = (more) => rejection(two.call('move.forget', { ...courier.ofTarget(), ...more }));
	assert.equal((await forget({})).data.path, 'params.release');
	assert.equal((await forget({ release: '0'.repeat(64) })).data.path, 'params.release');
	assert.equal((await forget({ source_lost: false })).data.path, 'params.release');
	// A source that was killed knows the move by its name alone, and still has the right word.
	await d1.kill();
	d1 = await again(d1, 'd1');
	assert.equal(await settled(d1, d2), false);

	const later = await d1.connect();
	await new Courier(later, two, session, 'd2-knee').walk('rest');
	await d1.kill();
	const lost = await run(['move', session, 'd2', '--source-lost', '--url', at(d2)]);
	assert.equal(lost.status, 0, lost.stderr);
	await d2.log(/session=d2-knee event=forgotten_unproved .* whole=1 risk="if d1 has decided this move, the session is lost"/);
	assert.deepEqual((await two.call('move.list')).moves, []);
	const nothing = await run(['move', session, 'd2', '--source-lost', '--url', at(d2)]);
	assert.equal(nothing.status, 1);
	await end(d2);
});

test('cautery move carries a running session, and the library goes after it', async () => {
	const [d1, d2] = await daemons();
	const one = await d1.connect(), two = await d2.connect();
	const session = await smallSession(one, 'knee');
	const watching = spawn(process.env.CAUTERY, ['events', session, '--follow', '--url', at(d1)]);
	const seen = new Promise((resolve) => watching.stdout.on('data', (text) => /snapshot/.test(text) && resolve()));
	await one.until(() => one.notice('session.changed'), 'the session');
	const mover = await run(['move', session, 'd2', '--url', at(d1), '--to-url', at(d2)]);
	assert.equal(mover.status, 0, mover.stderr);
	assert.match(mover.stdout, /d1-knee is now d2-knee/);
	const stood = Number(/was suspended for ([0-9.]+) s/.exec(mover.stderr)[1]);
	if (process.env.E2E_SLOW !== '1')
		assert.ok(stood < 1, `${stood} s`);
	const { summary } = await two.call('session.describe', { session: 'd2-knee' });
	assert.equal(summary.state, 'running');
	// By the old id, and by one that was watching all the time.
	const info = await run(['pause', session, '--url', at(d1)]);
	assert.equal(info.status, 0, info.stderr);
	assert.equal((await two.call('session.describe', { session: 'd2-knee' })).summary.state, 'paused');
	await two.call('session.snapshot', { session: 'd2-knee', name: 'seen' });
	await seen;
	watching.kill();
	const again = await run(['move', session, 'd2', '--url', at(d1), '--to-url', at(d2)]);
	assert.equal(again.status, 1);
	assert.match(again.stderr, /d2-knee/);
	await end(d1, d2);
});

const OPEN_MOST = 20; // requests without an answer: several in a tick, and fewer a second than a client may send

// Sends moves without waiting for answers, where its session is; what was refused because that moved is asked again
// there, in order.
class Flood {
	constructor(session) {
		Object.assign(this, { session, sequence: 0, acknowledged: new Map(), again: [], open: new Set() });
	}

	send(client, number) {
		const asked = client.call('tool.move', {
			session: this.session, tool: 'hook', sequence: number, client_sequence: number, rotation: AT_REST,
			position_m: [1e-4 * (number % 100), 0, 0.01],
		}).then(({ tick }) => this.acknowledged.set(number, tick), (error) => {
			assert.equal(error.data?.status, 'moved', error.message);
			this.again.push(number);
		}).finally(() => this.open.delete(asked));
		this.open.add(asked);
	}

	// Until its session is elsewhere, and all that was asked is answered.
	async run(client, moved) {
		for (const number of this.again.splice(0))
			this.send(client, number);
		while (!moved()) {
			if (this.open.size < OPEN_MOST)
				this.send(client, ++this.sequence);
			await new Promise(setImmediate); // what comes in is read
		}
		while (this.open.size)
			await Promise.all(this.open);
		this.again.sort((a, b) => a - b);
	}
}

test('what a driver is told was done is in the log, once, wherever its session was', async () => {
	const all = await daemons();
	const clients = await Promise.all(all.map((daemon) => daemon.connect()));
	let session = await smallSession(clients[0], 'knee', { cells: [8, 6] });
	let driver = await all[0].connect({ hello: { client_id: 'surgeon' } });
	await driver.call('tool.take_over', { session, tool: 'hook' });
	const flood = new Flood(session);
	for (let at = 0; at < 4; at++) {
		const [from, to] = [at % 2, (at + 1) % 2], target = `d${to + 1}-knee`;
		const walking = new Courier(clients[from], clients[to], session, target).walk();
		const gone = ({ change, moved_to }) => change === 'moved' && moved_to === target;
		await Promise.all([flood.run(driver, () => driver.notice('session.changed', gone)), walking]);
		driver = await all[to].connect({ hello: { client_id: 'surgeon', resume: driver.hello.resume } });
		flood.session = session = target;
	}
	let rest = 20;
	await flood.run(driver, () => !rest--);
	const log = (await driver.file('session.log', { session })).toString().trim().split('\n').map((line) => JSON.parse(line));
	// The daemon's own lines, of where a tool stays whose driver is away, repeat the last sequence.
	const first = new Map();
	for (const { command, sequence, tick } of log)
		if (command === 'tool.move' && !first.has(sequence))
			first.set(sequence, tick);
	assert.equal(flood.acknowledged.size, flood.sequence);
	const told = [...flood.acknowledged].filter(([number, tick]) => first.get(number) !== tick);
	assert.deepEqual(told, []);
	await end(...all);
});

test('to another kind of processor it goes only where that is asked for, and goes on there', async (t) => {
	const d1 = await Daemon.start({ settings: settings('d1') });
	const d2 = await Daemon.start({ settings: settings('d2'), program: process.env.CAUTERYD_BASELINE });
	const one = await d1.connect(), two = await d2.connect();
	const session = await smallSession(one, 'knee', { paused: true, cells: [8, 6] });
	await cutMiddle(one, session, 40);
	await one.call('tool.energize', { session, tool: 'hook', energized: false });
	await one.call('session.snapshot', { session, name: 'first' });
	const { summary, instruction_set: tier } = await one.call('session.describe', { session });
	if (tier === 'baseline')
		return t.skip('this processor knows the lowest tier alone');
	const stream = await one.join(session);
	const words = ['move', session, 'd2', '--url', at(d1), '--to-url', at(d2)];

	const refused = await run(words);
	assert.equal(refused.status, 1, refused.stderr);
	assert.match(refused.stderr, /another build, or its processor has another instruction set.*--inexact/);
	assert.deepEqual([await serves(one, session), await serves(two, 'd2-knee')], [true, false]);
	for (const client of [one, two])
		assert.deepEqual((await client.call('move.list')).moves, []);
	await one.call('session.step', { session, ticks: 1 });

	const moved = await run([...words, '--inexact']);
	assert.equal(moved.status, 0, moved.stderr);
	assert.match(moved.stderr, /not bit-exact/);
	const there = 'd2-knee';
	const described = await two.call('session.describe', { session: there });
	assert.deepEqual([described.instruction_set, described.summary.tick], ['baseline', summary.tick + 1]);
	await one.until(() => stream.tick === summary.tick + 1, 'the last frame');
	assert.deepEqual(picture(await two.join(there)), picture(stream));
	assert.equal((await two.call('session.step', { session: there, ticks: 5 })).tick, summary.tick + 6);
	// Its past is computed anew from a state that the other one made, and said not to be to the bit.
	const restored = await two.call('session.restore', { session: there, name: 'first' });
	assert.deepEqual([restored.tick, restored.exact], [summary.tick, false]);
	await end(d1, d2);
});

test('cautery-load, driver and viewers, goes after its session and removes it where it is', async () => {
	const [d1, d2] = await daemons();
	const one = await d1.connect(), two = await d2.connect();
	const load = execFile(process.env.CAUTERY_LOAD, ['--url', at(d1), '--viewers', '3', '--seconds', '600', '--warm-up', '0']);
	const ended = new Promise((resolve) => load.on('exit', resolve));
	const made = await one.until(() => one.notice('session.changed', (p) => p.change === 'created'), 'its session');
	const { session } = made.params.summary, target = session.replace('d1-', 'd2-');
	await one.call('session.snapshot', { session, name: 'first' }); // it is on the disk, and what came before it
	await new Courier(one, two, session, target).walk('accept', at(d2));
	await d2.log(new RegExp(`(?=.*event=driver )(?=.*session=${target})(?=.*cautery-load driver)`));
	load.kill('SIGINT');
	assert.equal(await ended, 0);
	await two.until(() => two.notice('session.changed', (p) => p.change === 'destroyed' && p.summary.session === target), 'its end');
	await end(d1, d2);
});
