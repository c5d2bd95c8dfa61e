// SPDX-License-Identifier: GPL-3.0-or-later
// The worst flood that a test can make, of everybody at once and everything that costs, while somebody
// drives: viewers with a token, an operator who creates large sessions, frames that break the rules, and
// made-up DDS writers where the daemon and the tests are built with DDS. The flooding programs share one
// core. E2E_SILENCES says how many silences of the driver, E2E_FLOOD_S how long its pace is measured.
import assert from 'node:assert/strict';
import { chmodSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { cpus, tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';
import { Driver, now } from './wire/driver.mjs';
import { Flood } from './wire/flood.mjs';
import { checkSilences, measureSilences, missedHeartbeat } from './wire/silences.mjs';

const trials = Number(process.env.E2E_SILENCES ?? 200), SECONDS = Number(process.env.E2E_FLOOD_S ?? 60);
const DEADLINE_S = 0.25, RATE_HZ = 60;
const FACTOR_LEAST = 0.9, FIRST_S = 2; // the flood begins within these
const SILENCE_S = 0.05; // a frame may be on its way here for so long, where one core is flooded
const VIEWERS = 6, WRITERS = 140;
const TOKENS = { view: 'viewer-token-0123456789', maker: 'maker-token-0123456789', driver: 'driver-token-0123456789' };

let folder, daemon, driver, session, watcher, stream;
const crowds = [], floods = {};
before(async () => {
	folder = mkdtempSync(join(tmpdir(), 'cautery-flood-'));
	const file = join(folder, 'tokens');
	writeFileSync(file, `view ${TOKENS.view}\noperate ${TOKENS.maker}\noperate ${TOKENS.driver}\n`);
	chmodSync(file, 0o600);
	const dds = process.env.CROWD ? { dds: true, dds_domain: (await import('./domain.mjs')).DOMAIN } : {};
	daemon = await Daemon.start({ settings: { tokens: file, browser_deadline_s: DEADLINE_S, ...dds } });
	driver = await Driver.connect(daemon.url(), { hello: { token: TOKENS.driver } });
	session = (await driver.client.call('session.create', { name: 'knee', scene: 'fascia' })).summary.session;
	watcher = await daemon.connect({ hello: { token: TOKENS.view } });
	stream = await watcher.join(session, { rate_hz: 1000, channels: ['mask', 'tools'] });
	await driver.client.call('tool.take_over', { session, tool: 'hook' });
	driver.drive(session);
});
after(async () => {
	driver?.rest();
	await Promise.all([...Object.values(floods).map((flood) => flood.end()), ...crowds.map((crowd) => crowd.kill())]);
	await daemon?.end();
	rmSync(folder, { recursive: true, force: true });
});

// A sheet of 500 x 500 cells where the fascia has 60 x 50.
async function largeDefinition() {
	const { definition } = await driver.client.call('scene.get', { scene: 'fascia' });
	definition.meshes[0].cells.splice(0, 2, 500, 500);
	definition.name = 'large';
	delete definition.cut;
	return definition;
}

async function startFloods() {
	const url = daemon.url(), viewing = { token: TOKENS.view };
	const requests = [
		['session.export', { session, format: 'vtu' }], ['session.export', { session, format: 'obj' }],
		['session.join', { session }], ['stream.key_frame', { session }],
		['session.describe', { session }], ['session.timeline', { session }], ['session.log', { session }],
	];
	floods.viewers = await Flood.start(url, { viewers: VIEWERS, hello: viewing, requests });
	floods.fragments = await Flood.start(url, { what: 'fragments', viewers: 1, pipeline: 2, hello: viewing });
	floods.maker = await Flood.start(url, { what: 'sessions', viewers: 2, pipeline: 1, hello: { token: TOKENS.maker },
		definition: await largeDefinition() });
}

// Writers that write NaN to the hook, and writers for tools that there are not.
async function startCrowds(t) {
	if (!process.env.CROWD)
		return t.diagnostic('built without DDS: no DDS writers');
	const { Crowd } = await import('./crowd.mjs');
	const wrap = ['taskset', '-c', String(cpus().length - 1)];
	const whole = { after: () => {} }; // they outlive this test: the end of all ends them
	for (const [what, tools] of [['bad', ['hook']], ['good', Array.from({ length: WRITERS }, (_, i) => `made-up-${i}`)]]) {
		const crowd = await Crowd.start(whole, session, WRITERS, { tools, wrap });
		crowds.push(crowd);
		await crowd.write(what);
	}
}

// Processor seconds that the machine and the daemon have used: a figure of a busy machine says little.
function used() {
	const [user, nice, system, , , irq, softirq, steal] =
		readFileSync('/proc/stat', 'utf8').split('\n')[0].split(/\s+/).slice(1).map(Number);
	const stat = readFileSync(`/proc/${daemon.process.pid}/stat`, 'utf8').split(') ')[1].split(' ');
	return { machine: (user + nice + system + irq + softirq + steal) / 100, daemon: (Number(stat[11]) + Number(stat[12])) / 100 };
}

// Simulated over wall time in each second, by the daemon's clock as its frames tell it: when they come here is
// this program's own matter, which shares the machine with the flood. A session that stands still shows as
// that, since a frame that is older than a tick and its way here does not tell the time any more. And what
// was refused to the driver.
async function pace(seconds) {
	const factors = [], refused = [], asked = [];
	const look = () => ({ tick: stream.tick, at: Math.max(stream.published / 1e6, now() - 1 / RATE_HZ - SILENCE_S) });
	for (let second = 0; second < seconds; second++) {
		const from = look(), began = now();
		for (let i = 0; now() - began < 1; i++) {
			asked.push(driver.client.call('tool.energize', { session, tool: 'hook', energized: i % 2 === 0 })
				.catch((error) => refused.push(error.message)));
			await new Promise((resolve) => setTimeout(resolve, 50)); // twenty a second, as a busy page asks
		}
		const to = look();
		factors.push((to.tick - from.tick) / RATE_HZ / (to.at - from.at));
	}
	await Promise.all(asked);
	refused.push(...driver.client.notices.filter((n) => n.method === 'tool.refused').map((n) => n.params.reason));
	return { factors: factors.slice(FIRST_S), asked: asked.length, refused };
}

test('a driven session keeps its pace in the worst flood, and nothing is refused to its driver', async (t) => {
	await startCrowds(t);
	await startFloods();
	const before = used(), began = now();
	const { factors, asked, refused } = await pace(SECONDS);
	const wall = now() - began, all = used();
	const least = Math.min(...factors), mean = factors.reduce((a, b) => a + b, 0) / factors.length;
	t.diagnostic(`real time ${mean.toFixed(3)}, in the worst second ${least.toFixed(3)}, `
		+ `below ${FACTOR_LEAST} in ${factors.filter((f) => f < FACTOR_LEAST).length} of ${factors.length}; `
		+ `the driver was answered ${asked} times`);
	t.diagnostic(`of ${cpus().length} cores the daemon had ${((all.daemon - before.daemon) / wall).toFixed(2)}, `
		+ `all programs ${((all.machine - before.machine) / wall).toFixed(2)}; the flood may have one`);
	assert.deepEqual(refused, []);
	assert.ok(least >= FACTOR_LEAST, `${least} of real time`);
});

test('energy of a silent driver goes off within the deadline and a tick, in the same flood', async (t) => {
	const took = await measureSilences(watcher, session, trials, {
		energize: async () => {
			driver.drive(session);
			await driver.energize(session);
		},
		fail: () => missedHeartbeat(driver, DEADLINE_S),
	});
	checkSilences(t, took, DEADLINE_S);
});

test('the flood was one', async (t) => {
	for (const [who, flood] of Object.entries(floods)) {
		const { asked, answered, refused } = await flood.stop();
		t.diagnostic(`${who}: asked ${asked} times, answered ${answered}, refused ${JSON.stringify(refused)}`);
		assert.ok(asked > 0, who);
	}
});
