// SPDX-License-Identifier: GPL-3.0-or-later
// What was acknowledged is there after kill -9, in order, and the state equals a replay.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { linkSync, readFileSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';
import { AT_REST, cutMiddle, smallScene, smallSession } from './wire/scene.mjs';

const parse = (bytes) => bytes.toString().split('\n').filter(Boolean).map((line) => JSON.parse(line));

// Changes the store of a daemon that is not running.
function editStore(daemon, ...statements) {
	const script = `import sqlite3, sys
store = sqlite3.connect(sys.argv[1])
for statement in sys.argv[2:]:
    store.execute(statement)
store.commit()`;
	const edited = spawnSync('python3', ['-c', script, join(daemon.folder, 'store.db'), ...statements], { encoding: 'utf8' });
	assert.equal(edited.status, 0, edited.stderr);
}

// The sessions in the store of a daemon that is not running, after a look that no rows are of others.
function storedSessions(daemon) {
	const script = `import json, sqlite3, sys
store = sqlite3.connect(sys.argv[1])
for table in ('checkpoints', 'branches', 'marks', 'commands'):
    strange = store.execute(f'SELECT count(*) FROM {table} WHERE session NOT IN (SELECT key FROM sessions)').fetchone()
    assert strange == (0,), (table, strange)
print(json.dumps([row[0] for row in store.execute('SELECT id FROM sessions WHERE deleted = 0 ORDER BY id')]))`;
	const read = spawnSync('python3', ['-c', script, join(daemon.folder, 'store.db')], { encoding: 'utf8' });
	assert.equal(read.status, 0, read.stderr);
	return JSON.parse(read.stdout);
}

function storedCheckpoints(daemon, session) {
	const script = `import sqlite3, sys
print(sqlite3.connect(sys.argv[1]).execute('SELECT count(*) FROM checkpoints JOIN sessions ON key = session WHERE id = ?', sys.argv[2:]).fetchone()[0])`;
	const read = spawnSync('python3', ['-c', script, join(daemon.folder, 'store.db'), session], { encoding: 'utf8' });
	assert.equal(read.status, 0, read.stderr);
	return Number(read.stdout);
}

// E2E_KILLS repeats it, each time at another moment of the cut.
const kills = Number(process.env.E2E_KILLS ?? 1);
for (let round = 0; round < kills; round++)
	test(`kill -9 during a cut: every acknowledged request is there, and the hash is that of a replay (${round})`, async () => {
		let daemon = await Daemon.start({ settings: { checkpoint_s: 0.3 } });
		const client = await daemon.connect({ hello: { client_id: 'surgeon' } });
		const definition = await smallScene(client);
		const session = await smallSession(client, 'killed');
		const stream = await client.join(session);
		await client.call('tool.take_over', { session, tool: 'hook' });
		await client.call('tool.move', { session, tool: 'hook', position_m: [-0.02, 0, 0.001], rotation: AT_REST });
		await client.call('tool.energize', { session, tool: 'hook', energized: true });
		const acknowledged = [];
		let stop = false;
		const driving = (async () => {
			for (let i = 1; !stop; i++) {
				const params = {
					session, tool: 'hook', position_m: [-0.02 + 0.0004 * (i % 100), 0, 0.001], rotation: AT_REST,
					sequence: i, client_sequence: i,
				};
				const answer = await client.call('tool.move', params).catch(() => null);
				if (!answer)
					return;
				acknowledged.push({ params, answer });
			}
		})();
		await client.until(() => stream.removed() > 4 && acknowledged.length > 40 + (7 * round) % 53, 'a cut under way');
		const epoch = stream.epoch;
		await daemon.kill();
		stop = true;
		await driving;

		daemon = await Daemon.start({ folder: daemon.folder });
		const again = await daemon.connect({ hello: { client_id: 'surgeon' } });
		await again.call('session.pause', { session });
		const after = await again.join(session);
		assert.notEqual(after.epoch, epoch);
		assert.ok(after.removed() > 0, 'the cut is there');
		assert.equal(after.tools[0].energized, false);

		// In the log, in order, at their ticks.
		const log = parse(await again.file('session.log', { session }));
		const moves = log.filter((c) => c.command === 'tool.move' && c.sequence > 0);
		acknowledged.forEach(({ params, answer }, i) => {
			assert.equal(moves[i].sequence, params.sequence);
			assert.equal(moves[i].tick, answer.tick);
			assert.deepEqual(moves[i].position_m, params.position_m);
		});

		// A request sent again acts once and gets its first answer.
		const last = acknowledged.at(-1);
		assert.deepEqual(await again.call('tool.move', last.params), last.answer);
		assert.equal(parse(await again.file('session.log', { session })).length, log.length);

		// An unbroken replay of the log makes the same state. A replay ends before the commands of its last tick, which
		// may have acted here: a tick more comes after them.
		await again.call('session.step', { session, ticks: 1 });
		const snapshot = await again.call('session.snapshot', { session, name: 'resumed' });
		const scene = join(daemon.folder, 'scene.json'), script = join(daemon.folder, 'script.jsonl');
		writeFileSync(scene, JSON.stringify(definition));
		writeFileSync(script, await again.file('session.log', { session }));
		const run = spawnSync(process.env.CAUTERY_SIM,
			['--scene', scene, '--script', script, '--seconds', String(snapshot.tick * definition.step_s), '--json'], { encoding: 'utf8' });
		assert.equal(run.status, 0, run.stderr);
		assert.equal(JSON.parse(run.stdout.trim().split('\n').at(-1)).hash, snapshot.hash);
		await again.close();
		await daemon.end();
	});

test('a create sent again makes one session', async () => {
	let daemon = await Daemon.start();
	const client = await daemon.connect({ hello: { client_id: 'maker' } });
	const params = { scene: 'fascia', client_sequence: 9, paused: true };
	const [first, second] = await Promise.all([
		client.call('session.create', params), client.call('session.create', params)]);
	assert.equal(first.summary.session, second.summary.session);
	await daemon.kill();
	daemon = await Daemon.start({ folder: daemon.folder });
	const again = await daemon.connect({ hello: { client_id: 'maker' } });
	const third = await again.call('session.create', params);
	assert.equal(third.summary.session, first.summary.session);
	assert.equal((await again.call('session.list')).sessions.length, 1);
	await assert.rejects(again.call('session.pause', { session: first.summary.session, client_sequence: 9 }),
		{ code: -32050 }); // 9 belongs to the create
	const gone = { session: first.summary.session, client_sequence: 10 };
	await again.call('session.destroy', gone);
	assert.deepEqual(await again.call('session.destroy', gone), {});
	await assert.rejects(again.call('session.destroy', { ...gone, client_sequence: 11 }), { code: -32040 });
	await again.close();
	await daemon.end();
});

test('gravity and materials are described as they are, after kill -9, a rewind and in a fork', async (t) => {
	let daemon = await Daemon.start();
	t.after(() => daemon.end());
	let client = await daemon.connect();
	const session = await smallSession(client, 'changed', { paused: true });
	const inForce = async (id = session) => {
		const { definition } = await client.call('session.describe', { session: id });
		return [definition.gravity_m_s2[2], definition.layers[0].thickness_m];
	};
	const [, thickness] = await inForce();
	await client.call('session.step', { session, ticks: 5 });
	await client.call('gravity.set', { session, gravity_m_s2: [0, 0, -2] });
	await client.call('material.set', { session, layer: 'fascia', kind: 'fascia', thickness_m: 2e-3 });
	assert.deepEqual(await inForce(), [-2, 2e-3]);
	await client.call('session.step', { session, ticks: 5 });
	await client.call('gravity.set', { session, gravity_m_s2: [0, 0, -3] }); // at the last tick of the log
	await daemon.kill();
	daemon = await Daemon.start({ folder: daemon.folder });
	client = await daemon.connect();
	assert.deepEqual(await inForce(), [-3, 2e-3]);
	await client.call('session.step', { session, ticks: 1 });
	const { summary } = await client.call('session.fork', { session, name: 'child', paused: true });
	await client.call('session.rewind', { session, tick: 8 });
	assert.deepEqual(await inForce(), [-2, 2e-3]);
	await client.call('session.rewind', { session, tick: 2 });
	assert.deepEqual(await inForce(), [-9.81, thickness]);
	assert.deepEqual(await inForce(summary.session), [-3, 2e-3]);
	await client.close();
});

test('the timeline outlives kill -9, follows a rewind, and is whole beyond what is in memory', async (t) => {
	let daemon = await Daemon.start();
	t.after(() => daemon.end());
	let client = await daemon.connect();
	const session = await smallSession(client, 'told', { paused: true });
	const { tick } = await cutMiddle(client, session, 60);
	const events = async (params = {}) => (await client.call('session.timeline', { session, ...params })).events;
	const told = await events();
	for (const kind of ['created', 'driver', 'energy_on', 'cut'])
		assert.ok(told.some((e) => e.kind === kind), kind);
	await daemon.kill();
	daemon = await Daemon.start({ folder: daemon.folder });
	client = await daemon.connect();
	const after = await events();
	assert.deepEqual(after.slice(0, told.length), told);
	assert.deepEqual(after.slice(told.length).map((e) => [e.kind, e.tick]), [['energy_off', tick]]);

	// Back before the cut its events are gone; they are still those of the branch that was left.
	const cut = told.find((e) => e.kind === 'cut');
	await client.call('session.snapshot', { session, name: 'cut' });
	await client.call('session.rewind', { session, tick: cut.tick - 1 });
	const before = told.filter((e) => e.tick < cut.tick), back = await events();
	assert.deepEqual(back.slice(0, before.length), before);
	assert.deepEqual(back.slice(before.length).map((e) => e.kind), ['rewind', 'energy_off']);
	await client.call('session.restore', { session, name: 'cut' });
	assert.deepEqual((await events()).slice(0, told.length), told);

	// More than memory holds.
	await client.call('tool.take_over', { session, tool: 'hook' });
	for (let i = 0; i < 700; i += 100)
		await Promise.all(Array.from({ length: 100 }, (_, k) =>
			client.call('tool.energize', { session, tool: 'hook', energized: k % 2 === 0 })));
	const whole = await events({ count: 4096 });
	assert.ok(whole.length > 700, `${whole.length} events`);
	assert.deepEqual(whole.slice(0, told.length), told);
	assert.deepEqual(await events({ count: 100 }), whole.slice(-100));
	assert.deepEqual(await events({ count: 4096, from_tick: tick }), whole.filter((e) => e.tick >= tick));
	await daemon.kill();
	daemon = await Daemon.start({ folder: daemon.folder });
	client = await daemon.connect();
	assert.deepEqual((await events({ count: 4096 })).slice(0, whole.length), whole);
	await client.close();
});

test('a request whose answer is not kept any more is refused, and does not act again', async (t) => {
	let daemon = await Daemon.start();
	t.after(() => daemon.end());
	const options = { hello: { client_id: 'late' } };
	let client = await daemon.connect(options);
	const session = await smallSession(client, 'late', { paused: true, client_sequence: 1 });
	const step = { session, ticks: 5, client_sequence: 2 };
	assert.deepEqual(await client.call('session.step', step), { tick: 5 });
	await daemon.stop();
	// As if the answers had been kept for long enough.
	editStore(daemon, 'INSERT INTO forgotten SELECT client, max(sequence), 0 FROM answers GROUP BY client',
		'DELETE FROM answers');
	daemon = await Daemon.start({ folder: daemon.folder });
	client = await daemon.connect(options);
	const past = (error) => error.code === -32049 && error.data.path === 'params.client_sequence';
	await assert.rejects(client.call('session.step', step), past);
	await assert.rejects(client.call('session.create', { scene: 'fascia', client_sequence: 1 }), past);
	assert.equal((await client.call('session.list')).sessions.length, 1);
	assert.deepEqual(await client.call('session.step', { ...step, client_sequence: 3 }), { tick: 10 });
	await client.close();
});

test('a session that cannot be brought up is left in the store until somebody destroys it', async (t) => {
	let daemon = await Daemon.start();
	t.after(() => daemon.end());
	let client = await daemon.connect();
	const well = await smallSession(client, 'well'), broken = await smallSession(client, 'broken');
	await daemon.stop();
	editStore(daemon, `UPDATE sessions SET definition = '{"layers": 7}' WHERE id = 'd1-broken'`);
	for (let start = 0; start < 2; start++) { // left alone, it is still there
		daemon = await Daemon.start({ folder: daemon.folder });
		await daemon.log(/session=d1-broken event=not_resumed .*cautery rm d1-broken/);
		if (start === 0)
			await daemon.stop();
	}
	client = await daemon.connect({ hello: { client_id: 'keeper' } });
	const listed = async () => (await client.call('session.list')).sessions.map((s) => s.session);
	assert.deepEqual(await listed(), [well]);
	const gone = { session: broken, client_sequence: 1 };
	await assert.rejects(client.call('session.pause', { session: broken }), { code: -32040 });
	await client.call('session.destroy', gone);
	await client.call('session.destroy', gone); // its answer is kept
	await assert.rejects(client.call('session.destroy', { session: broken }), { code: -32040 });
	await daemon.stop();
	daemon = await Daemon.start({ folder: daemon.folder });
	client = await daemon.connect();
	assert.deepEqual(await listed(), [well]);
	assert.doesNotMatch(daemon.lines.join('\n'), /not_resumed/);
	await smallSession(client, 'broken'); // the name is free
	await client.close();
});

// The destruction is read while the session is not there yet, or is being built, which it ends, or just after.
// Whichever it was: the session is gone everywhere or nowhere, and one of its name made since keeps its rows.
test('a session destroyed before it was made leaves nothing, and what is made since stays', async (t) => {
	let daemon = await Daemon.start();
	t.after(() => daemon.end());
	let client = await daemon.connect();
	const definition = await smallScene(client, [4, 4]), large = await smallScene(client, [150, 150]);
	const create = (name, scene = definition) =>
		client.call('session.create', { name, definition: scene, paused: true }).then(() => null, (error) => error);
	const destroy = (session) => client.call('session.destroy', { session }).then(() => null, (error) => error);
	const listed = async () => (await client.call('session.list')).sessions.map((s) => s.session).sort();
	const cancelled = /the session was destroyed while it was being built, before (meshing|ordering|factoring|settling)/;
	const before = Array.from({ length: 12 }, (_, i) => create(`before-${i}`)), early = create('early');
	const after = Array.from({ length: 12 }, (_, i) => create(`after-${i}`));
	const refused = await destroy('d1-early');
	if (refused) // it came before the session
		assert.equal(refused.code, -32040);
	const refusals = await Promise.all([...before, ...after]), made = await early;
	assert.deepEqual(refusals.filter(Boolean), []);
	if (made)
		assert.match(made.message, cancelled);
	assert.ok(!(refused && made), 'who was not there to be destroyed is made');
	assert.equal((await listed()).includes('d1-early'), !!refused);

	// surely while it is being built, by two at once; its name is free as soon as it is answered
	const late = create('late', large);
	await daemon.log(/session=d1-late event=building .*stage=(ordering|factoring)/);
	const twice = await Promise.all([destroy('d1-late'), destroy('d1-late')]);
	assert.match((await late).message, cancelled);
	assert.equal(twice[0], null);
	assert.equal(twice[1].code, -32040);
	assert.ok(!(await listed()).includes('d1-late'));
	assert.equal(await create('late'), null);
	const there = await listed();
	assert.equal(there.length, 25 + !!refused);
	assert.ok(there.includes('d1-late'));
	await daemon.stop();
	assert.deepEqual(storedSessions(daemon), there);
	daemon = await Daemon.start({ folder: daemon.folder });
	client = await daemon.connect();
	assert.deepEqual(await listed(), there);
	await client.close();
});

test('SIGTERM drains: checkpoint, close code, exit 0; the next start goes on there', async () => {
	let daemon = await Daemon.start();
	const client = await daemon.connect();
	const session = await smallSession(client, 'drained', { paused: true });
	const { tick } = await cutMiddle(client, session, 80);
	const { hash } = await client.call('session.snapshot', { session, name: 'before' });
	const ended = daemon.stop();
	assert.equal((await client.closed).code, 1001);
	assert.deepEqual(await ended, { code: 0, signal: null });
	daemon = await Daemon.start({ folder: daemon.folder });
	const again = await daemon.connect();
	const { sessions } = await again.call('session.list');
	assert.equal(sessions[0].state, 'paused');
	assert.equal(sessions[0].tick, tick);
	assert.deepEqual((await again.call('session.snapshots', { session })).snapshots, [{ name: 'before', tick, branch: 0 }]);
	// Energy goes off at the restart, which is a change; the snapshot of before is whole.
	const back = await again.call('session.restore', { session, name: 'before' });
	assert.equal(back.tick, tick);
	assert.ok(back.exact);
	await again.call('session.rewind', { session, tick });
	assert.match(hash, /^[0-9a-f]{16}$/);
	await again.close();
	await daemon.end();
});

test('rewinding and cutting again the same way makes the same state', async () => {
	const daemon = await Daemon.start();
	const client = await daemon.connect();
	const session = await smallSession(client, 'twice', { paused: true });
	await cutMiddle(client, session, 60);
	const first = await client.call('session.snapshot', { session, name: 'first' });
	const back = await client.call('session.rewind', { session, tick: 0 });
	assert.equal(back.branch, 1);
	await cutMiddle(client, session, 60);
	const second = await client.call('session.snapshot', { session, name: 'second' });
	assert.equal(second.tick, first.tick);
	assert.equal(second.hash, first.hash);
	const listed = (await client.call('session.snapshots', { session })).snapshots;
	assert.deepEqual(listed, [{ name: 'first', tick: first.tick, branch: 0 }, { name: 'second', tick: second.tick, branch: 1 }]);
	await client.close();
	await daemon.end();
});

// Of all threads, to disks.
const writtenBytes = (daemon) => Number(/^write_bytes: (\d+)$/m.exec(readFileSync(`/proc/${daemon.process.pid}/io`, 'utf8'))[1]);

test('a session that is stepped one by one is where it was after kill -9, and writes little for a step', async (t) => {
	const STEPS = 300, STEP_BYTES_MOST = 16384, CHECKPOINTS_MOST = 8;
	let daemon = await Daemon.start();
	t.after(() => daemon.end());
	let client = await daemon.connect();
	const twice = [];
	for (const name of ['killed', 'whole']) {
		const { summary } = await client.call('session.create', { name, scene: 'fascia', paused: true });
		await client.call('tool.take_over', { session: summary.session, tool: 'hook' });
		await client.call('tool.move', { session: summary.session, tool: 'hook', position_m: [0, 0, 0.001], rotation: AT_REST });
		twice.push(summary.session);
	}
	const [session, whole] = twice;
	const before = writtenBytes(daemon), rows = await daemon.metric('store_records_total');
	for (let i = 1; i <= STEPS; i++)
		assert.deepEqual(await client.call('session.step', { session, ticks: 1 }), { tick: i });
	const bytes = (writtenBytes(daemon) - before) / STEPS;
	t.diagnostic(`${bytes.toFixed(0)} bytes a step, ${(await daemon.metric('store_records_total')) - rows} records`);
	assert.ok(bytes < STEP_BYTES_MOST, `${bytes} bytes a step`);
	await client.call('session.step', { session: whole, ticks: STEPS });
	const { hash } = await client.call('session.snapshot', { session: whole, name: 'there' });
	await daemon.kill();
	assert.ok(storedCheckpoints(daemon, session) < CHECKPOINTS_MOST);
	daemon = await Daemon.start({ folder: daemon.folder });
	client = await daemon.connect();
	const { sessions } = await client.call('session.list');
	assert.equal(sessions.find((one) => one.session === session).tick, STEPS);
	assert.equal((await client.call('session.snapshot', { session, name: 'there' })).hash, hash);
	assert.deepEqual(await client.call('session.step', { session, ticks: 2 }), { tick: STEPS + 2 });
	const { summary } = await client.call('session.fork', { session, name: 'child', paused: true });
	assert.equal(summary.tick, STEPS + 2);
	const back = await client.call('session.rewind', { session, tick: 7 });
	assert.equal(back.tick, 7);
	await client.close();
});

test('a fork goes on from the state, on its own, energy off', async () => {
	const daemon = await Daemon.start();
	const client = await daemon.connect();
	const session = await smallSession(client, 'parent', { paused: true });
	const { tick } = await cutMiddle(client, session, 60);
	const made = await client.call('session.fork', { session, name: 'child', paused: true });
	const child = made.summary.session;
	assert.equal(made.summary.tick, tick);
	const before = await client.join(session, { rate_hz: 1000 }), now = await client.join(child, { rate_hz: 1000 });
	assert.deepEqual(now.mask, before.mask);
	assert.deepEqual(now.quantised, before.quantised);
	assert.equal(before.tools[0].energized, true);
	await client.call('session.step', { session: child, ticks: 1 });
	await client.until(() => now.tick === tick + 1, 'a step of the child');
	assert.equal(now.tools[0].energized, false);
	assert.equal(now.tools[0].driver, 0);
	assert.equal(before.tick, tick);
	const past = await client.call('session.fork', { session, name: 'past', tick: 10, paused: true });
	assert.equal(past.summary.tick, 10);
	await client.close();
	await daemon.end();
});

for (const [what, spoil] of [
	['foreign', () => Buffer.from('this is no database at all, but somebody\'s letter\n'.repeat(50))],
	['damaged', (bytes) => Buffer.concat([bytes.subarray(0, 100), Buffer.alloc(bytes.length - 100, 0x5a)])],
])
	test(`a ${what} store is refused with the reason and left untouched`, async () => {
		const daemon = await Daemon.start();
		const client = await daemon.connect();
		await smallSession(client, 'some', { paused: true });
		await daemon.stop();
		const file = join(daemon.folder, 'store.db');
		const spoilt = spoil(readFileSync(file));
		writeFileSync(file, spoilt);
		for (const tail of ['-wal', '-shm'])
			rmSync(file + tail, { force: true });
		await assert.rejects(Daemon.start({ folder: daemon.folder }), (error) =>
			error.code === 1 && /event=start_failed .*reason="[^"]+"/.test(error.message));
		assert.deepEqual(readFileSync(file), spoilt);
		rmSync(daemon.folder, { recursive: true });
	});

const gapNamed = (error) => error.code === -32602 && error.data.path === 'params.tick' &&
	/can be reached: \d/.test(error.data.reason);

test('a second daemon on the same store is refused, by whatever name it comes', async () => {
	const daemon = await Daemon.start();
	const client = await daemon.connect();
	const session = await smallSession(client, 'mine', { paused: true });
	const names = ['link.db', 'symbolic.db'];
	linkSync(join(daemon.folder, 'store.db'), join(daemon.folder, names[0]));
	symlinkSync('store.db', join(daemon.folder, names[1]));
	const refused = (name) => assert.rejects(Daemon.start({ settings: { store: join(daemon.folder, name) } }),
		(error) => error.code === 1 && /event=start_failed .*reason="[^"]*(in use by|another name)/.test(error.message));
	for (const name of ['store.db', ...names])
		await refused(name);
	await client.call('session.step', { session, ticks: 3 });
	await daemon.kill();
	await refused('link.db'); // what was committed last is in the log of the other name
	const again = await Daemon.start({ folder: daemon.folder });
	const other = await again.connect();
	assert.equal((await other.call('session.list')).sessions[0].tick, 3);
	await other.close();
	await again.end();
});

// Rows of the store of a daemon that is not running.
function queryStore(daemon, query) {
	const script = `import json, sqlite3, sys
print(json.dumps(sqlite3.connect(sys.argv[1]).execute(sys.argv[2]).fetchall()))`;
	const answer = spawnSync('python3', ['-c', script, join(daemon.folder, 'store.db'), query], { encoding: 'utf8' });
	assert.equal(answer.status, 0, answer.stderr);
	return JSON.parse(answer.stdout);
}

test('beyond its budget a session loses the middle of its past, never its beginning, and says so', async () => {
	let daemon = await Daemon.start({ settings: { retention_bytes: 1048576, checkpoint_s: 0.1 } });
	let client = await daemon.connect();
	const session = await smallSession(client, 'long', { cells: [60, 50], paused: true }); // whose checkpoints soon pass that
	await client.call('tool.take_over', { session, tool: 'hook' });
	const beginning = await client.call('session.snapshot', { session, name: 'beginning' });
	const timeline = () => client.call('session.timeline', { session });
	// Retention looks every ten seconds; the session goes on until it has begun.
	let middle;
	for (let i = 0, until = Date.now() + 60000; !((await timeline()).oldest_tick > 0 && i > 8); i++) {
		assert.ok(Date.now() < until, 'retention did nothing');
		await client.call('tool.move', { session, tool: 'hook', position_m: [0.0001 * (i % 100), 0, 0.01], rotation: AT_REST });
		await client.call('session.step', { session, ticks: 20 });
		if (i === 4)
			middle = await client.call('session.snapshot', { session, name: 'middle' });
	}
	const check = async () => {
		const { oldest_tick, tick } = await timeline();
		await assert.rejects(client.call('session.rewind', { session, tick: oldest_tick - 1 }), gapNamed);
		await assert.rejects(client.call('session.fork', { session, name: 'no', tick: oldest_tick - 1 }), gapNamed);
		const back = await client.call('session.rewind', { session, tick: oldest_tick });
		assert.equal(back.tick, oldest_tick);
		assert.ok(tick >= oldest_tick);
		for (const { name, hash } of [{ name: 'middle', hash: middle.hash }, { name: 'beginning', hash: beginning.hash }]) {
			await client.call('session.restore', { session, name });
			const again = await client.call('session.snapshot', { session });
			assert.equal(again.hash, hash, name);
		}
		assert.equal((await client.call('session.reset', { session })).tick, 0);
		assert.equal((await client.call('session.snapshot', { session })).hash, beginning.hash);
	};
	await client.call('session.fork', { session, name: 'begun', tick: 0, paused: true });
	await check();
	// Off the beginning too, on another branch, after a crash.
	await client.call('session.step', { session, ticks: 30 });
	await daemon.kill();
	daemon = await Daemon.start({ folder: daemon.folder, settings: { retention_bytes: 1048576 } });
	client = await daemon.connect();
	assert.equal((await timeline()).oldest_tick, 0);
	await client.call('session.restore', { session, name: 'middle' });
	assert.equal((await client.call('session.reset', { session })).tick, 0);
	await client.close();
	await daemon.end();
});

test('a session that nobody touches is written ever more rarely, a paused one not at all', async () => {
	const daemon = await Daemon.start({ settings: { checkpoint_s: 0.1 } });
	const client = await daemon.connect();
	const idle = await smallSession(client, 'idle'), driven = await smallSession(client, 'driven');
	const paused = await smallSession(client, 'paused', { paused: true });
	const stream = await client.join(driven);
	await client.call('tool.take_over', { session: driven, tool: 'hook' });
	for (let i = 0; stream.tick < 180; i++) { // three seconds
		await client.call('tool.move', { session: driven, tool: 'hook', position_m: [0.0001 * (i % 100), 0, 0.01], rotation: AT_REST });
		const { tick } = stream;
		await client.until(() => stream.tick > tick, 'the next frame');
	}
	await client.close();
	await daemon.kill();
	const written = Object.fromEntries(queryStore(daemon,
		'SELECT id, count(*) FROM checkpoints JOIN sessions ON key = session GROUP BY id'));
	// 0.1, 0.3, 0.7, 1.5 and 3.1 s after the first; were the machine slow, one or two more.
	assert.ok(written[idle] >= 3 && written[idle] <= 8, JSON.stringify(written));
	assert.ok(written[driven] > 2 * written[idle], JSON.stringify(written));
	assert.equal(written[paused], 1);
	rmSync(daemon.folder, { recursive: true });
});

test('a store without room refuses requests, the session goes on, and it recovers', async () => {
	let daemon = await Daemon.start();
	const client = await daemon.connect();
	const session = await smallSession(client, 'full');
	const stream = await client.join(session);
	const limit = (bytes) =>
		assert.equal(spawnSync('prlimit', ['--pid', String(daemon.process.pid), `--fsize=${bytes}:unlimited`]).status, 0);
	const gravity = (z) => client.call('gravity.set', { session, gravity_m_s2: [0, 0, z] });
	await gravity(-1);
	limit(1024);
	// The first one meets the failure itself, later ones are refused at once.
	await assert.rejects(gravity(-2), { code: -32048 });
	await assert.rejects(gravity(-3), { code: -32048 });
	await assert.rejects(client.call('session.create', { scene: 'fascia' }), { code: -32048 });
	assert.equal((await daemon.get('/readyz')).status, 503);
	const { tick } = stream;
	await client.until(() => stream.tick > tick + 20, 'the session goes on');
	limit('unlimited');
	await daemon.ready();
	const last = await gravity(-4);
	// What could not be stored is a gap that nobody is led through.
	const refused = (who) => assert.rejects(who.call('session.rewind', { session, tick: tick + 10 }), gapNamed);
	await refused(client);
	await assert.rejects(client.call('session.fork', { session, name: 'no', tick: tick + 10 }), gapNamed);
	await daemon.kill();
	daemon = await Daemon.start({ folder: daemon.folder });
	const again = await daemon.connect();
	await again.call('session.pause', { session });
	await refused(again);
	const { oldest_tick } = await again.call('session.timeline', { session });
	assert.ok(oldest_tick > tick + 10, 'the gap is behind what is always reached');
	const log = parse(await again.file('session.log', { session }));
	const kept = log.filter((c) => c.command === 'gravity.set').map((c) => c.gravity_m_s2[2]);
	assert.ok(kept.includes(-1) && kept.includes(-4), kept.join(' '));
	assert.ok((await again.call('session.list')).sessions[0].tick >= last.tick);
	await again.call('session.rewind', { session, tick: oldest_tick });
	await again.call('session.reset', { session });
	await again.close();
	await daemon.end();
});
