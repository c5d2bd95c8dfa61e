// SPDX-License-Identifier: GPL-3.0-or-later
// Tests cautery-robot with the real daemon.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { createInterface } from 'node:readline';
import { after, before, test } from 'node:test';
import { PATIENCE_S } from './wire/client.mjs';
import { Daemon } from './wire/daemon.mjs';
import { DOMAIN } from './domain.mjs';
import { watchSession } from './watch.mjs';

const DEADLINE_S = 1; // largest deadline that the server grants: a loaded machine may run a robot late
const TICK_S = 1 / 60;
const AFTER_TICKS = 60, RISE_M = 2e-4;
// LATENCY_S: longest time from a command until the state shows it, in addition to the tick for which it waits. It
// applies if the machine ran the robot within ON_TIME_S.
const LATENCY_S = 0.003, ON_TIME_S = 0.001;
const SECONDS = Number(process.env.ROBOT_SECONDS ?? 5); // duration of the session that must not be lost

let daemon;
before(async () => {
	daemon = await Daemon.start({ settings: { dds: true, dds_domain: DOMAIN } });
});
after(() => daemon.end());

// Runs the robot. `drives` resolves when the robot reports that it drives, `done` to its exit code and the JSON line
// that it prints at the end.
function robot(session, ...flags) {
	const child = spawn(process.env.ROBOT,
		['--domain', String(DOMAIN), '--deadline', String(DEADLINE_S), '--json', ...flags, session, 'hook'],
		{ stdio: ['ignore', 'pipe', 'inherit'], env: { ...process.env, CYCLONEDDS_URI: process.env.LOOPBACK } });
	let text = '';
	child.stdout.on('data', (part) => (text += part));
	const drives = new Promise((resolve) =>
		createInterface({ input: child.stdout }).on('line', (line) => line === 'drives' && resolve()));
	const done = new Promise((resolve) => child.on('close', (code) => {
		const last = text.trim().split('\n').at(-1);
		resolve({ code, report: last.startsWith('{') ? JSON.parse(last) : null });
	}));
	return { child, drives, done };
}

const watched = (t, name) => watchSession(t, daemon, name);

test('a robot cuts along a line at 1 kHz, and a browser sees it', async (t) => {
	const { client, session, stream } = await watched(t, 'cut');
	const { done } = robot(session, '--energy', '--from=-0.02,0,0.001', '--to=0.02,0,0.001', '--speed', '0.05');
	await client.until(() => stream.tools[0].energized, 'energy on');
	await client.until(() => stream.mask.some((word) => word !== 0), 'faces gone');
	const { code, report } = await done;
	assert.equal(code, 0);
	assert.equal(report.lost, null);
	assert.ok(report.commands > 500, `${report.commands} commands`);
	assert.ok(report.latency_count > 20, `${report.latency_count} states of its own commands`);
	await client.until(() => !stream.tools[0].energized && stream.tools[0].driver === 0, 'it let go');
	assert.equal(stream.tools[0].energyOff, 'commanded');
	t.diagnostic(`command to state p50 ${report.latency_p50_s} s, p99 ${report.latency_p99_s} s`);
});

test('a standby holds the tool of a killed robot, energy off', async (t) => {
	const { client, session, stream } = await watched(t, 'standby');
	const first = robot(session, '--energy', '--from=0,0,0.02', '--dwell', '60');
	await client.until(() => stream.tools[0].energized, 'energy on');
	const driver = stream.tools[0].driver;
	const standby = robot(session, '--standby', '--energy');
	await daemon.log(new RegExp(`session=${session} event=dds_refused .*drives the tool`));
	assert.equal(stream.tools[0].driver, driver);
	first.child.kill('SIGKILL');
	await client.until(() => stream.tools[0].driver !== driver && stream.tools[0].driver !== 0, 'the standby drives');
	assert.equal(stream.tools[0].energized, false);
	await standby.drives; // the robot hears this a little later than the frame shows it
	standby.child.kill('SIGTERM');
	const { code, report } = await standby.done;
	assert.equal(code, 0);
	assert.equal(report.took_over, true);
	assert.equal(stream.tools[0].energized, false);
});

test('a robot says so when there is no such tool', async () => {
	assert.equal((await robot('d1-nowhere').done).code, 3);
});

// Moves a robot into the tissue, and a little further once its tool meets `isSo`. Returns the robot's report. The
// session's time is used, because a busy machine simulates late.
async function into(t, name, isSo, ...flags) {
	const { client, session, stream } = await watched(t, name);
	const { child, done } = robot(session, '--from=0,0,0.005', '--to=0,0,-0.008', '--speed', '0.02', '--seconds', '600', ...flags);
	await client.until(() => isSo(stream.tools[0]), 'it is there', 3 * PATIENCE_S);
	const ticks = stream.tick + AFTER_TICKS;
	await client.until(() => stream.tick >= ticks, 'a while');
	child.kill('SIGINT');
	return (await done).report;
}

test('a robot backs off from too much force', async (t) => {
	// The sheet stops the tool 1.5 mm before the requested position, with about 7 N.
	const { force_most_n: most_n } = await into(t, 'blind', (tool) => tool.position[2] < -0.006);
	assert.ok(most_n > 0.1, `${most_n} N`);
	let lowest = Infinity;
	const rises = ({ position: [, , z] }) => z > (lowest = Math.min(lowest, z)) + RISE_M;
	const report = await into(t, 'feels', rises, '--force-limit', String(most_n / 4));
	assert.ok(report.backed_off_m > 0);
	assert.ok(report.force_most_n < 0.7 * most_n, `${report.force_most_n} N, and ${most_n} N without a limit`);
});

test(`a robot at 1 kHz keeps its session for ${SECONDS} s`, async (t) => {
	const { client, session, stream } = await watched(t, 'long');
	const { done } = robot(session, '--energy', '--from=0,0,0.02', '--dwell', String(2 * SECONDS), '--seconds', String(SECONDS));
	await client.until(() => stream.tools[0].energized, 'energy on');
	const { code, report } = await done;
	assert.equal(code, 0);
	assert.equal(report.lost, null);
	assert.equal(await daemon.metric('session_watchdog_cuts_total', session), 0);
	t.diagnostic(`command to state p50 ${report.latency_p50_s} s, p99 ${report.latency_p99_s} s; `
		+ `woke late p99 ${report.jitter_p99_s} s, most ${report.jitter_most_s} s; ${report.missed} of ${report.commands} missed`);
	if (report.jitter_p99_s < ON_TIME_S)
		assert.ok(report.latency_p99_s <= TICK_S + LATENCY_S, `p99 ${report.latency_p99_s} s`);
	else
		t.diagnostic('the machine ran the robot late: the latency says nothing of the server');
});
