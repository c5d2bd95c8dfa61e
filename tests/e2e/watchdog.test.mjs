// SPDX-License-Identifier: GPL-3.0-or-later
// How soon energy is off when its driver fails, in every way a WebSocket driver can. E2E_SILENCES says how
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
import { checkSilences, measureSilences, missedHeartbeat } from './wire/silences.mjs';

const slow = process.env.E2E_SLOW === '1', trials = Number(process.env.E2E_SILENCES ?? 3);
const DEADLINE_S = slow ? 2.5 : 0.25;

let daemon, watcher;
before(async () => {
	daemon = await Daemon.start({ settings: { browser_deadline_s: DEADLINE_S, resume_s: 0 } });
	watcher = await daemon.connect();
});
after(() => daemon.end());

async function measure(name, way) {
	const session = await smallSession(watcher, name);
	const took = await measureSilences(watcher, session, trials, way);
	await watcher.call('session.destroy', { session });
	return took;
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
	const way = await inProcess((driver) => missedHeartbeat(driver, DEADLINE_S));
	const took = await measure('missed', way);
	await way.close();
	checkSilences(t, took, DEADLINE_S);
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
	checkSilences(t, took, 0);
});

test('a lost connection: off at the next tick', async (t) => {
	const way = await inProcess((driver, forget) => {
		driver.rest();
		const moment = now();
		driver.client.terminate();
		forget();
		return () => moment;
	});
	checkSilences(t, await measure('lost', way), 0);
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
	checkSilences(t, await measure('hangs', await program(t, 'SIGSTOP')), DEADLINE_S);
});

test('a driver that is killed: off at the next tick', async (t) => {
	checkSilences(t, await measure('killed', await program(t, 'SIGKILL')), 0);
});
