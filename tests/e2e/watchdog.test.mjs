// SPDX-License-Identifier: GPL-3.0-or-later
// How soon energy is off when its driver fails, in every way a WebSocket driver can. Times are the
// server's: its clock is that of this process, and a frame tells when it was made. E2E_SILENCES says how
// many trials of each; a few by default.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { createInterface } from 'node:readline';
import { fileURLToPath } from 'node:url';
import { after, before, test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';
import { Driver, now } from './wire/driver.mjs';
import { smallSession } from './wire/scene.mjs';

const slow = process.env.E2E_SLOW === '1', trials = Number(process.env.E2E_SILENCES ?? 3);
const DEADLINE_S = slow ? 2.5 : 0.25, TICK_S = 1 / 60;
// What a machine may take to wake the threads that it takes.
const SLACK_S = slow ? 3 : 0.1;

// On a busy machine all threads wake late: how late, a timer of this process shows.
let lateness = 0;
const PERIOD_MS = 5;
let due = now() + PERIOD_MS / 1000;
setInterval(() => {
	lateness = Math.max(lateness, now() - due);
	due = now() + PERIOD_MS / 1000;
}, PERIOD_MS).unref();

let daemon, watcher;
before(async () => {
	daemon = await Daemon.start({ settings: { browser_deadline_s: DEADLINE_S, resume_s: 0 } });
	watcher = await daemon.connect();
});
after(() => daemon.end());

// Of `trials` failures: seconds from `fail`, which returns its moment, to the first frame without energy.
async function measure(name, { energize, fail, recover = () => {} }) {
	const session = await smallSession(watcher, name);
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
	await watcher.call('session.destroy', { session });
	return took.sort((a, b) => a - b);
}

function check(t, took, most_s) {
	const ms = (share) => (1000 * took[Math.min(took.length - 1, Math.floor(share * took.length))]).toFixed(1);
	t.diagnostic(`${took.length} trials: p50 ${ms(0.5)} ms, p99 ${ms(0.99)} ms, p100 ${ms(1)} ms; `
		+ `timers up to ${(1000 * lateness).toFixed(1)} ms late`);
	assert.ok(took.at(-1) <= most_s + TICK_S + SLACK_S + 2 * lateness, `off after ${took.at(-1)} s`);
}

// One client that drives, stops driving, and drives again.
async function inProcess(fail) {
	let driver;
	return {
		async energize(session) {
			driver ??= await Driver.connect(daemon.url());
			driver.drive(session);
			await driver.energize(session);
		},
		fail: () => fail(driver, () => { driver = null; }),
		close: () => driver?.client.close(),
	};
}

test('a missed heartbeat: off within the deadline and a tick of the last sign of life', async (t) => {
	const way = await inProcess((driver) => {
		driver.rest();
		// Should this process have been kept waiting, the silence began before.
		return (off) => driver.sent.filter((s) => s < off - 0.75 * DEADLINE_S).at(-1);
	});
	const took = await measure('missed', way);
	await way.close();
	check(t, took, DEADLINE_S);
	assert.ok(took[0] >= 0.75 * DEADLINE_S);
});

test('a hidden page: off at the next tick', async (t) => {
	const way = await inProcess((driver) => {
		driver.rest();
		const moment = now();
		driver.client.notify('heartbeat', { visible: false });
		return () => moment;
	});
	const took = await measure('hidden', way);
	await way.close();
	check(t, took, 0);
});

test('a lost connection: off at the next tick', async (t) => {
	const way = await inProcess((driver, forget) => {
		driver.rest();
		const moment = now();
		driver.client.terminate();
		forget();
		return () => moment;
	});
	check(t, await measure('lost', way), 0);
});

// A program that drives: it hangs, with its connection open, or dies.
async function program(t, signal) {
	let child, lines, exited;
	const stop = () => child?.kill('SIGKILL');
	t.after(stop);
	return {
		async energize(session) {
			if (!child) {
				child = spawn(process.execPath, [fileURLToPath(new URL('./wire/driver.mjs', import.meta.url)), daemon.url()],
					{ stdio: ['pipe', 'pipe', 'inherit'] });
				exited = once(child, 'exit');
				lines = createInterface({ input: child.stdout });
			}
			const told = once(lines, 'line');
			child.stdin.write(`${session}\n`);
			await told;
		},
		fail() {
			const moment = now();
			child.kill(signal);
			return () => moment;
		},
		async recover() {
			if (signal === 'SIGSTOP') {
				child.kill('SIGCONT');
				return;
			}
			await exited;
			child = null;
		},
	};
}

test('a driver that hangs, its connection open: off within the deadline and a tick', async (t) => {
	check(t, await measure('hangs', await program(t, 'SIGSTOP')), DEADLINE_S);
});

test('a driver that is killed: off at the next tick', async (t) => {
	check(t, await measure('killed', await program(t, 'SIGKILL')), 0);
});
