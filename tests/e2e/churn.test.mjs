// SPDX-License-Identifier: GPL-3.0-or-later
// Memory does not grow where sessions and clients come and go: rounds in which sessions are made, watched,
// cut, rewound, forked, exported and destroyed, and in which clients end in every way there is. Then the live
// heap is where it was after the first rounds. E2E_ROUNDS sets the number of rounds.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';
import { AT_REST, cutMiddle, smallSession } from './wire/scene.mjs';

const sanitized = process.env.E2E_SLOW === '1'; // which look for leaks themselves, when the daemon ends
const ROUNDS = Number(process.env.E2E_ROUNDS ?? (sanitized ? 2 : 12)), AT_ONCE = 3;
const WARM_UP = sanitized ? 1 : 6; // rounds, after which most of the store's page caches are full
// Bytes in ROUNDS. A cache may fill once in them; then twice as many rounds may not grow by as much.
const GROWTH_MOST = 1e6;

// Ways for a client to end. Each but the first leaves something behind for the daemon to clear away.
const ENDS = [
	(client) => client.close(),
	(client) => client.terminate(),
	(client) => client.send('no JSON'.repeat(1000)) ?? client.terminate(),
	(client, session) => {
		client.notify('tool.move', { session, tool: 'hook', position_m: [0, 0, 0.05], rotation: AT_REST, tick: 1e9 });
		client.terminate();
	},
];

async function life(daemon, name) {
	const owner = await daemon.connect(), viewers = [await daemon.connect(), await daemon.connect(), await daemon.connect()];
	const session = await smallSession(owner, name, { paused: true });
	for (const viewer of viewers)
		await viewer.join(session, { rate_hz: 30 });
	await cutMiddle(owner, session, 60);
	await owner.call('session.snapshot', { session, name: 'cut' });
	await owner.file('session.export', { session, format: 'vtu' });
	await owner.file('session.log', { session });
	await owner.call('session.rewind', { session, tick: 40 });
	const { summary: { session: fork } } = await owner.call('session.fork', { session, name: `${name}-fork` });
	await owner.call('session.restore', { session, name: 'cut' });
	await owner.call('session.resume', { session });
	for (const id of [fork, session])
		await owner.call('session.destroy', { session: id });
	viewers.forEach((viewer, index) => ENDS[index + 1](viewer, session));
	await owner.close();
}

const round = (daemon, number) => Promise.all(Array.from({ length: AT_ONCE }, (_, i) => life(daemon, `r${number}-${i}`)));

// The live heap, once the daemon has cleared away what ended.
async function heap(daemon) {
	for (let before = Infinity; ;) {
		const bytes = await daemon.metric('heap_bytes');
		if (bytes >= before && await daemon.metric('connections') === 0 && await daemon.metric('sessions') === 0)
			return bytes;
		before = bytes;
		await new Promise((resolve) => setTimeout(resolve, 500)); // nothing reports that memory was freed
	}
}

test(`${ROUNDS} rounds of ${AT_ONCE} sessions leave the heap as it was`, async (t) => {
	const unbounded = Object.fromEntries(['connection', 'address', 'admin', 'all'].map((whose) => [`quota_${whose}`, 1000000]));
	const daemon = await Daemon.start({ settings: { ...unbounded, resume_s: 0 } });
	const heaps = [await heap(daemon)], grown = () => heaps.at(-1) - heaps.at(-2);
	let rounds = 0;
	const live = async (count) => {
		for (let i = 0; i < count; i++)
			await round(daemon, rounds++);
		heaps.push(await heap(daemon));
	};
	await live(WARM_UP);
	await live(ROUNDS);
	if (grown() > GROWTH_MOST)
		await live(2 * ROUNDS);
	const mb = heaps.map((bytes) => (1e-6 * bytes).toFixed(2));
	t.diagnostic(`live heap, MB: at the start, after ${WARM_UP} rounds, and after each span of ${ROUNDS} or more: ${mb.join(' ')}`);
	assert.ok(grown() <= GROWTH_MOST, `the heap grew again: ${mb.join(' ')} MB`);
	await daemon.end();
});
