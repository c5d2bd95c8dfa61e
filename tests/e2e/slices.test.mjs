// SPDX-License-Identifier: GPL-3.0-or-later
// What takes long is the builder's: no worker is held by it, whatever is done with a large session, and
// who is driven beside it is switched off in time.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';
import { Driver } from './wire/driver.mjs';
import { slowness } from './wire/machine.mjs';
import { smallSession } from './wire/scene.mjs';
import { checkSilences, measureSilences, missedHeartbeat } from './wire/silences.mjs';

const sanitized = process.env.E2E_SLOW === '1'; // there a slice takes some thirty times as long
const CELLS = sanitized ? 30 : 200; // of each side: 40,401 vertices, of which a restore takes 80 ms
const SLICE_MOST_S = 0.02; // CAU_SLICE_MOST_S of server/worker/pool.h
const DEADLINE_S = sanitized ? 2.5 : 0.25;
const TRIALS = sanitized ? 3 : 12;
const BACK_TICKS = 12;
const LOOK_MS = 10; // a tenth of what going back takes at least, and within the messages that a client may send
const SNAPSHOTS_MOST = 64; // of a session: a quick machine makes more rounds
const TIMES_MOST = 20; // that it goes back, to be seen on its way
const UNBOUNDED = Object.fromEntries(['connection', 'address', 'view', 'operate', 'admin', 'all']
	.map((whose) => [`quota_${whose}`, 1000000]));
const large = { session: 'd1-large' };

const sheet = (cells) => {
	const scene = JSON.parse(readFileSync(join(process.env.SCENES, 'fascia.json'), 'utf8'));
	scene.name = 'large';
	scene.meshes[0].cells = [cells, cells];
	return scene;
};

const makeLarge = (client, paused) => client.call('session.create', { name: 'large', definition: sheet(CELLS), paused });

// One round of all that is not a step, on a session that runs.
async function round(client, i) {
	if (i < SNAPSHOTS_MOST)
		await client.call('session.snapshot', { ...large, name: `round-${i}` });
	const { tick } = (await client.call('session.describe', large)).summary;
	await client.call('session.rewind', { ...large, tick: Math.max(0, tick - BACK_TICKS) });
	await client.call('session.restore', { ...large, name: `round-${i % SNAPSHOTS_MOST}` });
	await client.call('session.reset', large);
	await client.call('session.fork', { ...large, name: `fork-${i}`, paused: true });
	await client.call('session.destroy', { session: `d1-fork-${i}` });
	await client.file('session.export', { ...large, format: 'vtu' });
	await client.file('session.log', large);
}

test('no slice but a step is long, and energy goes off in time, beside a large session that goes back', async (t) => {
	const daemon = await Daemon.start({ settings: { ...UNBOUNDED, browser_deadline_s: DEADLINE_S } });
	const user = await daemon.connect(), watcher = await daemon.connect();
	const session = await smallSession(watcher, 'small');
	const driver = await Driver.connect(daemon.url());
	await driver.client.call('tool.take_over', { session, tool: 'hook' });
	let over = false, rounds = 0;
	const used = (async () => {
		await makeLarge(user, false);
		const stream = await user.join(large.session);
		await user.until(() => stream.tick > 0, 'its first tick');
		while (!over || rounds < 2)
			await round(user, rounds++);
	})();
	const took = await measureSilences(watcher, session, TRIALS, {
		energize: async (of) => {
			driver.drive(of);
			await driver.energize(of);
		},
		fail: () => missedHeartbeat(driver, DEADLINE_S),
	});
	over = true;
	await used;
	const longest_s = await daemon.metric('longest_slice_seconds');
	t.diagnostic(`${rounds} rounds; longest slice ${(1000 * longest_s).toFixed(1)} ms of processor time`);
	checkSilences(t, took, DEADLINE_S);
	assert.ok(longest_s > 0, 'slices are measured');
	// Processor time, which others that use the machine do not add to.
	const most_s = SLICE_MOST_S * slowness();
	assert.ok(sanitized || longest_s <= most_s, `${longest_s} s, of ${most_s}`);
	await daemon.end();
});

test('it tells how far it is, and what is asked meanwhile waits for it', async () => {
	const daemon = await Daemon.start({ settings: UNBOUNDED });
	const user = await daemon.connect(), other = await daemon.connect();
	await makeLarge(user, true);
	const gravity_m_s2 = [0, 0, -1];
	const stages = new Set();
	const seen = () => ['reading', 'restoring', 'replaying'].some((stage) => stages.has(stage));
	for (let time = 0; time < TIMES_MOST && !seen(); time++) { // a quick machine may be back between two looks
		await user.call('session.step', { ...large, ticks: 5 });
		let back;
		const going = user.call('session.reset', large).then((answer) => (back = answer));
		const asked = user.call('gravity.set', { ...large, gravity_m_s2 }).then((answer) => [answer, back]);
		while (!back) {
			for (const { stage } of (await other.call('session.list')).sessions)
				stages.add(stage);
			await new Promise((resolve) => setTimeout(resolve, LOOK_MS));
		}
		await going;
		const [set, before] = await asked;
		assert.equal(before?.tick, 0, 'it was done where the session went');
		assert.equal(set.tick, 0);
	}
	assert.ok(seen(), `stages ${[...stages]}`);
	const { summary, definition } = await user.call('session.describe', large);
	assert.equal(summary.stage, undefined);
	assert.deepEqual(definition.gravity_m_s2, gravity_m_s2);
	await daemon.end();
});
