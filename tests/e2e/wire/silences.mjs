// SPDX-License-Identifier: GPL-3.0-or-later
// How soon energy is off when its driver fails. Times are the server's: its clock is that of this
// process, and a frame tells when it was made.
import assert from 'node:assert/strict';
import { now } from './driver.mjs';

const slow = process.env.E2E_SLOW === '1';
export const TICK_S = 1 / 60;
// What a machine may take to wake the threads that it takes.
export const SLACK_S = slow ? 3 : 0.1;

// On a busy machine all threads wake late: how late, a timer of this process shows.
let lateness = 0;
const PERIOD_MS = 5;
let due = now() + PERIOD_MS / 1000;
setInterval(() => {
	lateness = Math.max(lateness, now() - due);
	due = now() + PERIOD_MS / 1000;
}, PERIOD_MS).unref();

// Of `trials` failures: seconds from `fail`, which returns its moment, to the first frame without energy,
// in order of length.
export async function measureSilences(watcher, session, trials, { energize, fail, recover = () => {} }) {
	const stream = await watcher.join(session, { rate_hz: 1000, channels: ['mask', 'tools'] });
	const took = [];
	lateness = 0;
	for (let i = 0; i < trials; i++) {
		await energize(session);
		await watcher.until(() => stream.tools[0].energized, 'energy on');
		const phase = stream.tick + 1 + (7 * i) % 5;
		await watcher.until(() => stream.tick > phase, 'another phase of the tick and the timers');
		const off = watcher.until(() => !stream.tools[0].energized && stream.published / 1e6, 'energy off');
		const failed = await fail(session);
		const { energyOff } = stream.tools[0];
		took.push(await off - failed(await off));
		assert.equal(stream.tools[0].energyOff, 'watchdog', energyOff);
		await recover(session);
	}
	return took.sort((a, b) => a - b);
}

export function checkSilences(t, took, most_s) {
	const ms = (share) => (1000 * took[Math.min(took.length - 1, Math.floor(share * took.length))]).toFixed(1);
	t.diagnostic(`${took.length} trials: p50 ${ms(0.5)} ms, p99 ${ms(0.99)} ms, p100 ${ms(1)} ms; `
		+ `timers up to ${(1000 * lateness).toFixed(1)} ms late`);
	assert.ok(took.at(-1) <= most_s + TICK_S + SLACK_S + 2 * lateness, `off after ${took.at(-1)} s`);
}

// A client of this process that drives and stops driving: when its last sign of life was.
export function missedHeartbeat(driver, deadline_s) {
	driver.rest();
	// Should this process have been kept waiting, the silence began before.
	return (off) => driver.sent.filter((s) => s < off - 0.75 * deadline_s).at(-1);
}
