// SPDX-License-Identifier: GPL-3.0-or-later
// Tests every way in which a robot can fail while its energy is on: it is killed, it hangs, it hangs while a standby
// writes, it is cut off from the network, or its clock or the server's clock jumps. Energy must be off within its
// deadline and a tick. DDS_TRIALS sets the number of trials.
import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { mkdtempSync, openSync, rmSync, writeSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { createInterface } from 'node:readline';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { Daemon } from './wire/daemon.mjs';
import { CYCLONE, DOMAIN } from './domain.mjs';
import { lateness, now_us } from './lateness.mjs';
import { Program } from './program.mjs';
import { far, watchSession } from './watch.mjs';

const TRIALS = Number(process.env.DDS_TRIALS ?? 3);
// Deadline that the robots declare, s. A robot that is scheduled late by less than this keeps its energy until it
// fails.
const DEADLINE_S = Number(process.env.DDS_DEADLINE_S ?? 0.5);
const TICK_S = 1 / 60, PERIOD_S = 1e-3; // periods of the session and of the robot's commands
// Longest time, s, that a loaded machine may need in addition: to run the watchdog and the step, and to make the frame.
// The lateness of this program comes on top.
const SLACK_S = Number(process.env.DDS_SLACK_S ?? 0.1);
const AT_AIM_M = 1e-4; // quantum of float32 in frames, and the rest of the robot's way, m
const NETWORK = join(dirname(fileURLToPath(process.env.LOOPBACK)), 'network.xml');
const folder = mkdtempSync(join(tmpdir(), 'cautery-failures-'));

after(() => rmSync(folder, { recursive: true }));

// A file whose number shifts the clock of a program that uses the file as its clock.
class Clock {
	constructor(name) {
		this.file = join(folder, name);
		this.descriptor = openSync(this.file, 'w+');
		this.shift(0);
	}

	shift(seconds) {
		const bytes = Buffer.alloc(8);
		bytes.writeBigInt64LE(BigInt(Math.round(seconds * 1e9)));
		writeSync(this.descriptor, bytes, 0, 8, 0);
	}

	get environment() {
		return { CLOCK_SHIFT: this.file, LD_PRELOAD: process.env.CLOCK_LIBRARY };
	}
}

const serverClock = new Clock('server'), robotClock = new Clock('robot');

// The program cautery-robot, which holds the hook above the tissue.
class Robot {
	constructor(session, { standby = false, environment = CYCLONE, wrap = [] } = {}) {
		const words = [...wrap, process.env.ROBOT, '--domain', String(DOMAIN), '--deadline', String(DEADLINE_S),
			...(standby ? ['--standby'] : ['--energy', '--dwell', '600']), session, 'hook'];
		this.process = spawn(words[0], words.slice(1),
			{ stdio: ['ignore', 'pipe', 'inherit'], env: { ...process.env, ...robotClock.environment, ...environment } });
		this.exited = new Promise((resolve) => this.process.on('exit', resolve));
		this.name = new Promise((resolve, reject) => {
			this.exited.then((code) => reject(new Error(`the robot ended (${code})`)));
			createInterface({ input: this.process.stdout }).on('line', (line) => resolve(/^the name of this client is "(.*)"$/.exec(line)?.[1]));
		});
	}

	signal(name) {
		this.process.kill(name);
	}

	end() {
		this.process.kill('SIGKILL'); // SIGKILL also ends a stopped process
		return this.exited;
	}
}

async function start(t, settings = {}, options = {}) {
	const daemon = await Daemon.start({ settings: { dds: true, dds_domain: DOMAIN, ...settings }, ...options });
	t.after(() => daemon.end());
	return daemon;
}

const watched = async (t, daemon, name) => ({ daemon, ...await watchSession(t, daemon, name) });

// Runs one trial: a robot drives with energy on, and `fail` makes it fail. Resolves when energy is off, to the time
// that this took. `off_s` counts from a period before the failure was caused, `least_s` from when the robot had failed.
async function trial({ client, session, stream }, fail, { prepare, ...options } = {}) {
	const robot = new Robot(session, options);
	try {
		const name = await robot.name;
		await client.until(() => stream.tools[0].energized, 'energy on');
		await prepare?.(robot);
		const { drivers } = await client.call('session.describe', { session });
		assert.equal(drivers[0].name, name);
		assert.ok(stream.tools[0].energized, 'energy is on until the robot fails');
		const before_us = now_us();
		fail(robot);
		const after_us = now_us();
		lateness.reset();
		await client.until(() => !stream.tools[0].energized, 'energy off');
		assert.ok(stream.published > before_us, 'energy was on until the robot failed');
		lateness.look();
		inTime((stream.published - after_us) / 1e6, DEADLINE_S + TICK_S, 'energy off');
		return {
			off_s: (stream.published - before_us) / 1e6 + PERIOD_S, least_s: (stream.published - after_us) / 1e6,
			why: stream.tools[0].energyOff, after_us, late_s: lateness.worst_s,
		};
	} finally {
		await robot.end();
	}
}

function inTime(seconds, limit_s, what) {
	assert.ok(seconds <= limit_s + SLACK_S + lateness.worst_s,
		`${what} ${seconds} s after it failed; this program ran up to ${lateness.worst_s} s late`);
}

function report(t, what, times) {
	const sorted = [...times].sort((a, b) => a - b);
	const at = (share) => `${(1e3 * sorted[Math.ceil(share * sorted.length) - 1]).toFixed(1)} ms`;
	t.diagnostic(`${what}: ${times.length} times; p50 ${at(0.5)}, p99 ${at(0.99)}, p100 ${at(1)}; `
		+ `deadline and tick ${(1e3 * (DEADLINE_S + TICK_S)).toFixed(1)} ms`);
}

// Runs `one` several times; each call resolves to a trial's outcome.
async function trials(t, one, why = ['watchdog']) {
	const times = [], over = [];
	for (let i = 0; i < TRIALS; i++) {
		const outcome = await one(i);
		assert.ok(why.includes(outcome.why), outcome.why);
		times.push(outcome.off_s);
		if (outcome.least_s > DEADLINE_S + TICK_S)
			over.push(`${(1e3 * outcome.least_s).toFixed(1)} (${(1e3 * outcome.late_s).toFixed(1)})`);
	}
	report(t, 'energy off', times);
	if (over.length)
		t.diagnostic(`beyond that, ms (and how late this program ran the while): ${over.join(', ')}`);
}

test('a robot that is killed', async (t) => {
	const seen = await watched(t, await start(t), 'killed');
	await trials(t, () => trial(seen, (robot) => robot.signal('SIGKILL')));
});

test('a robot that hangs, alive', async (t) => {
	const seen = await watched(t, await start(t), 'hung');
	await trials(t, () => trial(seen, (robot) => robot.signal('SIGSTOP')));
});

test('a robot that hangs while a standby writes: that one drives in time, energy off', async (t) => {
	const daemon = await start(t);
	const seen = await watched(t, daemon, 'standby');
	const { client, stream, session } = seen;
	const driven = [];
	await trials(t, async () => {
		let standby, name;
		try {
			const outcome = await trial(seen, (robot) => robot.signal('SIGSTOP'), {
				prepare: async () => {
					standby = new Robot(session, { standby: true });
					name = await standby.name; // the standby writes and is refused, because the other robot drives
					await daemon.log(new RegExp(` event=dds_client .*name="${name}"`));
				},
			});
			await client.until(() => client.notice('tool.driver_changed', ({ driver }) => driver.name === name), 'it drives');
			driven.push((now_us() - outcome.after_us) / 1e6);
			lateness.look();
			inTime(driven.at(-1), DEADLINE_S + 2 * TICK_S, 'it drives');
			assert.equal(stream.tools[0].energized, false);
			return outcome;
		} finally {
			await standby?.end();
		}
	}, ['watchdog', 'taken_over']);
	report(t, 'the standby drives', driven);
});

// Jumps of the clock, s: forward and back, large and small.
const JUMPS_S = [3600, -3600, 2, -2];

test("a robot whose clock jumps", async (t) => {
	const seen = await watched(t, await start(t), 'robot-clock');
	await trials(t, async (i) => {
		const outcome = await trial(seen, () => robotClock.shift(JUMPS_S[i % JUMPS_S.length]));
		robotClock.shift(0);
		return outcome;
	});
});

test("the server's clock jumps", async (t) => {
	const seen = await watched(t, await start(t, {}, { environment: serverClock.environment }), 'server-clock');
	await trials(t, async (i) => {
		const outcome = await trial(seen, () => serverClock.shift(JUMPS_S[i % JUMPS_S.length]));
		serverClock.shift(0);
		return outcome;
	});
});

test('the clock of the machine steps back an hour: its robot drives on after a deadline', async (t) => {
	const clock = new Clock('machine');
	const { client, session, stream } = await watched(t, await start(t, {}, { environment: clock.environment }), 'machine-clock');
	const robot = new Program(process.env.CONTROLLER, [DOMAIN, session, 'hook', 'native', 1000 * DEADLINE_S],
		{ environment: { ...CYCLONE, ...clock.environment } });
	t.after(() => robot.kill());
	await robot.event((e) => e.event === 'matched', 'matched');
	robot.tell('write on');
	await robot.until((s) => s.driver_name.startsWith('dds '));
	const aims = [[0.01, 0, 0.02], [0, 0.01, 0.02], [0, 0, 0.03]];
	for (const [i, aim] of aims.entries()) {
		clock.shift(-3600 * i);
		robot.tell(`aim ${aim.join(' ')}`);
		await client.until(() => far(stream.tools[0].position, aim) < AT_AIM_M, `it follows at ${-i} h`);
	}
});

// ---- a network of two machines, within this test's own network namespace

class Network {
	static async make() {
		if (!process.env.OWN_NETWORK)
			return null;
		const network = new Network();
		network.robots = spawn('unshare', ['--net', 'sh', '-c', 'echo; exec sleep infinity'],
			{ stdio: ['ignore', 'pipe', 'inherit'] });
		await new Promise((resolve) => network.robots.stdout.once('data', resolve));
		network.wrap = ['nsenter', `--net=/proc/${network.robots.pid}/ns/net`];
		network.ip('link', 'add', 'near', 'type', 'veth', 'peer', 'name', 'far', 'netns', String(network.robots.pid));
		network.ip('address', 'add', '10.77.0.1/24', 'dev', 'near');
		network.there('ip', 'address', 'add', '10.77.0.2/24', 'dev', 'far');
		network.there('ip', 'link', 'set', 'far', 'up');
		network.join();
		return network;
	}

	ip(...words) {
		execFileSync('ip', words);
	}

	there(...words) {
		return execFileSync(this.wrap[0], [...this.wrap.slice(1), ...words], { encoding: 'utf8' });
	}

	cut() {
		this.ip('link', 'set', 'near', 'down');
	}

	join() {
		this.ip('link', 'set', 'near', 'up');
	}

	end() {
		this.ip('link', 'delete', 'near');
		this.robots.kill();
	}
}

const NO_NETWORK = 'this system allows no network of the test\'s own';
const ON_NETWORK = { dds_config: NETWORK, dds_network: true };

test('a robot that the network loses', async (t) => {
	const network = await Network.make();
	if (!network)
		return t.skip(NO_NETWORK);
	const daemon = await start(t, ON_NETWORK);
	const seen = await watched(t, daemon, 'network');
	const there = { wrap: network.wrap, environment: { CYCLONEDDS_URI: `file://${NETWORK}` } };
	await trials(t, async () => {
		const outcome = await trial(seen, () => network.cut(), there);
		network.join();
		return outcome;
	});
	// The interface itself is removed. The daemon must end nevertheless.
	network.end();
	await seen.client.close();
	assert.deepEqual(await daemon.end(), { code: 0, signal: null });
});

// The text 'refused' if the kernel of the other side answers, because nothing there receives from this machine;
// otherwise 'silence'.
const KNOCK = `
import socket, sys
knocking = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
knocking.settimeout(0.5)
knocking.connect(("10.77.0.1", int(sys.argv[1])))
try:
    knocking.send(b"knock")
    knocking.recv(1)
except ConnectionRefusedError:
    print("refused")
except TimeoutError:
    print("silence")
`;

// The UDP ports on which programs of this machine receive, without those on loopback addresses.
const udpPorts = () => execFileSync('ss', ['-Hlun'], { encoding: 'utf8' }).trim().split('\n')
	.map((line) => line.split(/\s+/)[3]).filter((address) => !address.startsWith('127.'))
	.map((address) => address.split(':').at(-1));

test('other machines reach the ports of DDS only where it may leave this one', async (t) => {
	const network = await Network.make();
	if (!network)
		return t.skip(NO_NETWORK);
	t.after(() => network.end());
	for (const [settings, answer] of [[{}, 'refused'], [ON_NETWORK, 'silence']]) {
		const daemon = await start(t, settings);
		const ports = udpPorts();
		assert.ok(ports.length >= 2, 'discovery and data');
		for (const port of ports)
			assert.equal(network.there('python3', '-c', KNOCK, port).trim(), answer);
		await daemon.end();
	}
});
