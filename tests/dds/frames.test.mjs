// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the samples that a session publishes on DDS: its status and its frames.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { DOMAIN } from './domain.mjs';
import { Observer, stateHash, topologyHash } from './observer.mjs';
import { Daemon } from './wire/daemon.mjs';
import { AT_REST, cutMiddle, smallSession } from './wire/scene.mjs';
import { watchSession } from './watch.mjs';

let daemon;
before(async () => {
	daemon = await Daemon.start({ settings: { dds: true, dds_domain: DOMAIN } });
});
after(() => daemon.end());

// Makes a session, a browser's client and its stream for one test, and an observer on DDS.
async function watched(t, name, options) {
	const observers = [];
	const seen = await watchSession(t, daemon, name, { options, first: () => Promise.all(observers.map((o) => o.kill())) });
	const observe = () => {
		observers.push(new Observer(seen.session));
		return observers.at(-1);
	};
	return { ...seen, observe };
}

// Waits until both have the same frame, and checks that they have the same state.
async function agree({ client, stream }, observer) {
	const state = await observer.until((s) =>
		s.synced && s.topology_hash !== 0 && BigInt(`0x${s.epoch}`) === stream.epoch && BigInt(s.sequence) === stream.sequence);
	assert.equal(state.hash, stateHash(stream));
	assert.equal(state.topology_hash, topologyHash(stream));
	assert.equal(state.tick, stream.tick);
	assert.equal(state.refused, 0);
	assert.equal(client.closeCode, undefined);
	return state;
}

test('the status tells state, time and counts, and stays for who comes late', async (t) => {
	const { client, session, observe } = await watched(t, 'status', { paused: true });
	const { summary } = await client.call('session.describe', { session });
	const late = observe();
	const status = await late.statusThat((s) => s.state === 'paused', 'paused');
	assert.equal(status.session, session);
	assert.equal(status.scene, 'small');
	assert.equal(status.tick, 0);
	assert.equal(status.epoch, summary.epoch);
	assert.equal(status.step_s, summary.step_s);
	assert.equal(status.vertex_count, summary.vertex_count);
	assert.equal(status.face_count, summary.face_count);
	assert.equal(status.tool_count, 1);

	await client.call('session.step', { session, ticks: 7 });
	const stepped = await late.statusThat((s) => s.tick === 7, 'seven ticks');
	assert.ok(Math.abs(stepped.time_s - 7 * stepped.step_s) < 1e-9);
	assert.equal(stepped.steps, 7);
	await client.call('session.resume', { session });
	await late.statusThat((s) => s.state === 'running' && s.tick > 7, 'running');
	await client.call('session.pause', { session });
	await late.statusThat((s) => s.state === 'paused', 'paused again');
	const restored = await client.call('session.rewind', { session, tick: 7 });
	await late.statusThat((s) => s.epoch === restored.epoch && s.tick === 7, 'rewound');

	const gone = late.event((e) => e.event === 'gone', 'gone');
	await client.call('session.destroy', { session });
	await gone;
});

test('key frame, deltas and topology make the state that a browser holds, through a cut', async (t) => {
	const seen = await watched(t, 'agree', { paused: true });
	const { client, session, stream, observe } = seen;
	const observer = observe();
	await agree(seen, observer);
	await cutMiddle(client, session);
	await client.until(() => stream.removed() > 0, 'faces gone');
	assert.ok((await agree(seen, observer)).deltas > 0);
	await client.call('session.rewind', { session, tick: 30 });
	await client.until(() => stream.tick === 30, 'rewound');
	await agree(seen, observer);
});

test('who joins late, in a running session and in one that stands, decodes at once', async (t) => {
	const seen = await watched(t, 'late');
	const { client, session, stream, observe } = seen;
	const early = observe();
	const { keys, deltas } = await early.until((s) => s.keys > 2 && s.synced);
	assert.ok(deltas > 10 * keys, `${keys} key frames, ${deltas} deltas: most frames are deltas`);
	const late = observe();
	await late.until((s) => s.synced && s.deltas > 10);
	await client.call('session.pause', { session });
	const { summary } = await client.call('session.describe', { session });
	await client.until(() => stream.tick === summary.tick, 'the last frame');
	await agree(seen, early);
	await agree(seen, late);
	const last = observe();
	await agree(seen, last);
});

test('a reader that was away takes up the chain with the next key frame', async (t) => {
	const seen = await watched(t, 'away');
	const { client, session, stream, observe } = seen;
	const observer = observe(), other = observe();
	const { deltas } = await observer.until((s) => s.synced && s.deltas > 10);
	observer.process.kill('SIGSTOP');
	// More deltas than the writer keeps are written. The other readers do not wait for the stopped one.
	const from = (await other.until((s) => s.synced)).deltas;
	await other.until((s) => s.deltas > from + 60);
	observer.process.kill('SIGCONT');
	await observer.until((s) => s.deltas > deltas + 10);
	await client.call('session.pause', { session });
	const { summary } = await client.call('session.describe', { session });
	await client.until(() => stream.tick === summary.tick, 'the last frame');
	await agree(seen, observer);
	await agree(seen, other);
});

test('two sessions never mix', async (t) => {
	const one = await watched(t, 'one'), two = await watched(t, 'two', { paused: true });
	const first = one.observe(), second = two.observe();
	await first.until((s) => s.synced && s.deltas > 30);
	const paused = await second.until((s) => s.synced);
	assert.equal(paused.foreign, 0);
	assert.equal(paused.tick, 0);
	await two.client.call('tool.take_over', { session: two.session, tool: 'hook' });
	await two.client.call('tool.move', { session: two.session, tool: 'hook', position_m: [0, 0, 0.03], rotation: AT_REST });
	await two.client.call('session.step', { session: two.session, ticks: 20 });
	await two.client.until(() => two.stream.tick === 20, 'twenty ticks');
	await agree(two, second);
	await one.client.call('session.pause', { session: one.session });
	const { summary } = await one.client.call('session.describe', { session: one.session });
	await one.client.until(() => one.stream.tick === summary.tick, 'the last frame');
	for (const [seen, observer] of [[one, first], [two, second]])
		assert.equal((await agree(seen, observer)).foreign, 0);
});

test('frames are made for who reads them, and for nobody else', async (t) => {
	const { client, session, stream, observe } = await watched(t, 'nobody');
	const observer = observe();
	await observer.statusThat((s) => s.subscriber_count === 2, 'the browser and DDS');
	await observer.until((s) => s.synced);
	await observer.end();
	await client.until(() => stream.tick > 0, 'it runs');
	const late = observe();
	await late.statusThat((s) => s.subscriber_count === 2, 'both again');
	assert.ok((await late.until((s) => s.synced)).deltas >= 0);
	await late.end();
	const until = async (count) => {
		while ((await client.call('session.list')).sessions.find((s) => s.session === session).subscriber_count !== count)
			await client.until(((tick) => () => stream.tick > tick)(stream.tick), 'the next frame');
	};
	await until(1);
});
