// SPDX-License-Identifier: GPL-3.0-or-later
// Sessions that are in memory alone: all that a session can, nothing on the disk, gone with their maker.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';
import { cutMiddle, picture, smallSession } from './wire/scene.mjs';

const STEPS = 100, RESETS = 130; // RESETS: more than a connection may ask for in a minute otherwise
let daemon, watcher;

before(async () => {
	daemon = await Daemon.start({ settings: { resume_s: 0.3 } });
	watcher = await daemon.connect();
});
after(async () => {
	await watcher.close();
	await daemon.end();
});

const destroyed = (session) => watcher.until(() => watcher.notice('session.changed',
	(params) => params.summary.session === session && params.change === 'destroyed'), `${session} is destroyed`);
const listed = async (client) => (await client.call('session.list')).sessions.map(({ session }) => session).sort();
const writtenBytes = () => Number(/^write_bytes: (\d+)$/m.exec(readFileSync(`/proc/${daemon.process.pid}/io`, 'utf8'))[1]);

function storedSessions() {
	const script = `import sqlite3, sys
print(','.join(row[0] for row in sqlite3.connect(sys.argv[1]).execute('SELECT id FROM sessions WHERE deleted = 0 ORDER BY id')))`;
	const read = spawnSync('python3', ['-c', script, join(daemon.folder, 'store.db')], { encoding: 'utf8' });
	assert.equal(read.status, 0, read.stderr);
	return read.stdout.trim().split(',').filter(Boolean);
}

test('it is stepped, cut, rewound, restored, forked and looked back at, and writes nothing', async () => {
	const client = await daemon.connect();
	const session = await smallSession(client, 'whole', { paused: true, ephemeral: true });
	assert.equal((await client.call('session.describe', { session })).summary.stored, false);
	const stream = await client.join(session);
	const before = writtenBytes();
	for (let i = 1; i <= STEPS; i++)
		assert.deepEqual(await client.call('session.step', { session, ticks: 1 }), { tick: i });
	await client.call('session.snapshot', { session, name: 'first' });
	await cutMiddle(client, session, 60);
	await client.until(() => stream.tick === STEPS + 90, 'the last tick');
	const last = picture(stream);
	await client.call('session.snapshot', { session, name: 'last' });
	const { tick, exact } = await client.call('session.restore', { session, name: 'first' });
	assert.deepEqual({ tick, exact }, { tick: STEPS, exact: true });
	assert.equal((await client.call('session.rewind', { session, tick: 7 })).tick, 7);
	await client.until(() => stream.tick === 7, 'the frame of tick 7');
	assert.notDeepEqual(picture(stream), last);
	await client.call('session.restore', { session, name: 'last' });
	await client.until(() => stream.tick === STEPS + 90, 'the last tick again');
	assert.deepEqual(picture(stream), last);
	const past = await client.past(session, STEPS + 90);
	assert.deepEqual(picture(past, stream.faces), last);
	const log = (await client.file('session.log', { session })).toString();
	assert.match(log, /energize/);
	const fork = await client.call('session.fork', { session, name: 'fork', paused: true });
	assert.equal(fork.summary.stored, false);
	assert.deepEqual(await client.call('session.step', { session: fork.summary.session, ticks: 2 }), { tick: STEPS + 92 });
	assert.ok((await client.call('session.timeline', { session, from_tick: 0 })).events.length > 2);
	assert.equal(writtenBytes() - before, 0);
	assert.deepEqual(storedSessions(), []);
	await client.close();
	await destroyed(session);
	await destroyed('d1-fork');
	while ((await listed(watcher)).length > 0)
		await new Promise((resolve) => setTimeout(resolve, 20));
});

test('it goes with its maker alone, unless that one comes back in time', async () => {
	const [maker, other] = [await daemon.connect(), await daemon.connect()];
	const session = await smallSession(maker, 'mine', { paused: true, ephemeral: true });
	const kept = await smallSession(maker, 'kept', { paused: true });
	await other.join(session);
	maker.terminate();
	await maker.closed;
	const again = await daemon.connect({ hello: { resume: maker.hello.resume } });
	await new Promise((resolve) => setTimeout(resolve, 1000)); // longer than resume_s and a look of the daemon's
	assert.deepEqual((await listed(other)).filter((one) => [kept, session].includes(one)), [kept, session].sort());
	await again.call('session.step', { session, ticks: 1 });
	await other.close();
	await new Promise((resolve) => setTimeout(resolve, 1000));
	assert.deepEqual(await listed(again), [kept, session].sort());
	await again.close();
	await destroyed(session);
	while ((await listed(watcher)).includes(session)) // until it is reaped, several times a second
		await new Promise((resolve) => setTimeout(resolve, 20));
	assert.deepEqual(await listed(watcher), [kept]);
	await watcher.call('session.destroy', { session: kept });
});

test('its maker begins again as often as it likes, others within their quota', async () => {
	const [maker, other] = [await daemon.connect(), await daemon.connect()];
	const session = await smallSession(maker, 'again', { paused: true, ephemeral: true });
	for (let i = 0; i < RESETS; i++) {
		await maker.call('session.step', { session, ticks: 1 });
		assert.equal((await maker.call('session.reset', { session })).tick, 0);
	}
	// All at once, and of nothing that takes time: a quota comes back within a minute.
	const answers = await Promise.all(Array.from({ length: RESETS }, () =>
		other.call('session.restore', { session, name: 'nothing' }).then(() => 'ok', (error) => error.data.status)));
	assert.ok(answers.includes('rate'), 'another client has a quota');
	await other.close();
	await maker.close();
	await destroyed(session);
});

test('a request sent again acts once', async () => {
	const client = await daemon.connect({ hello: { client_id: 'learner' } });
	const definition = { name: 'once', scene: 'fascia', paused: true, ephemeral: true, client_sequence: 1 };
	const { summary: { session } } = await client.call('session.create', definition);
	assert.equal((await client.call('session.create', definition)).summary.session, session);
	const step = { session, ticks: 3, client_sequence: 2 };
	assert.deepEqual(await client.call('session.step', step), { tick: 3 });
	assert.deepEqual(await client.call('session.step', step), { tick: 3 });
	await client.close();
	await destroyed(session);
});

test('it cannot move, and says why', async () => {
	const client = await daemon.connect();
	const session = await smallSession(client, 'rooted', { paused: true, ephemeral: true });
	await assert.rejects(client.call('move.begin', { session, target: 'd2-rooted', label: 'd2', url: 'ws://127.0.0.1:1' }),
		(error) => error.data.status === 'bad_state' && /ephemeral/.test(error.data.reason));
	await client.call('session.destroy', { session });
	await client.close();
});

test('kill -9 takes it, and leaves the others', async () => {
	const own = await Daemon.start();
	const client = await own.connect();
	await smallSession(client, 'gone', { paused: true, ephemeral: true });
	const kept = await smallSession(client, 'kept', { paused: true });
	await own.kill();
	const next = await Daemon.start({ folder: own.folder });
	const again = await next.connect();
	assert.deepEqual(await listed(again), [kept]);
	await again.close();
	await next.end();
});
