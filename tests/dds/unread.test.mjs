// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that topics without readers cost almost nothing, and that a late joiner gets the present state.
import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { setTimeout } from 'node:timers/promises';
import { Controller } from './controller.mjs';
import { DOMAIN } from './domain.mjs';
import { Daemon } from './wire/daemon.mjs';
import { AT_REST, smallScene } from './wire/scene.mjs';

const SESSIONS = 16, TOOLS = 8, WINDOW_MS = 2000;
const AWAKE_MS = 250; // tissue comes to rest after half a second in which nothing moves
// Largest share of the transport in the daemon's processor time, which includes the steps of these small sessions. The
// share would be nearly a half if every state were written without readers and every session were checked after each
// slice of any session.
const SHARE_MOST = 0.2;
// Options for the address sanitizer. It keeps freed memory back, so that each sample touches new pages and fills them:
// half of the thread's time under it. This cost is not the program's. Other tests detect a use after free.
const OWN_COSTS = [process.env.ASAN_OPTIONS, 'quarantine_size_mb=1', 'thread_local_quarantine_size_kb=64', 'max_malloc_fill_size=0'];

let daemon, client;
before(async () => {
	daemon = await Daemon.start({ settings: { dds: true, dds_domain: DOMAIN }, environment: { ASAN_OPTIONS: OWN_COSTS.filter(Boolean).join(':') } });
	client = await daemon.connect({ hello: { client: 'admin' } });
});
after(async () => {
	await Controller.killAll();
	await client.close();
	await daemon.end();
});

// Moves a tool of each session to and fro, so that no tissue comes to rest: steps of resting tissue cost nothing.
async function keepAwake(sessions) {
	for (let ms = 0; ms < WINDOW_MS; ms += AWAKE_MS) {
		const position_m = [0, 0, ms % (2 * AWAKE_MS) ? 0.021 : 0.02];
		for (const session of sessions)
			client.notify('tool.move', { session, tool: 't1', position_m, rotation: AT_REST });
		await setTimeout(AWAKE_MS); // the measured window consists of such moves
	}
}

// Returns the processor seconds of the transport's thread and of all threads.
function used() {
	const folder = `/proc/${daemon.process.pid}/task`;
	const of = (task) => {
		const [ns] = readFileSync(`${folder}/${task}/schedstat`, 'utf8').split(' ');
		return { name: readFileSync(`${folder}/${task}/comm`, 'utf8').trim(), seconds: Number(ns) / 1e9 };
	};
	const threads = readdirSync(folder).map(of);
	const sum = (some) => some.reduce((total, thread) => total + thread.seconds, 0);
	return { dds: sum(threads.filter(({ name }) => name === 'cautery-dds')), all: sum(threads) };
}

test(`${SESSIONS} sessions with ${TOOLS} tools and no reader: the transport takes little of the daemon's time`, async (t) => {
	const definition = await smallScene(client, [4, 4]), sessions = [];
	for (let i = 0; i < SESSIONS; i++) {
		const { summary: { session } } = await client.call('session.create', { name: `unread${i}`, definition });
		sessions.push(session);
		for (let tool = 1; tool < TOOLS; tool++)
			await client.call('tool.add', { session, name: `t${tool}`, shape: 'grasper', position_m: [0, 0, 0.02], rotation: AT_REST });
	}
	const before = used();
	await keepAwake(sessions);
	const now = used();
	const share = (now.dds - before.dds) / (now.all - before.all);
	t.diagnostic(`${(100 * share).toFixed(1)} % of ${(now.all - before.all).toFixed(2)} s`);
	assert.ok(share <= SHARE_MOST, `${share} of the daemon's time`);
});

test('who comes late is told the state as it is, though nobody read it before', async () => {
	const session = 'd1-unread0';
	const { tick } = await client.call('session.pause', { session });
	const robot = await Controller.start({ domain: DOMAIN, session, tool: 'hook', via: 'ros' });
	const state = await robot.until((s) => s.tick === tick);
	assert.equal(state.energized, false);
	await client.call('session.resume', { session });
	await robot.until((s) => s.tick > tick);
});
