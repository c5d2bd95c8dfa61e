// SPDX-License-Identifier: GPL-3.0-or-later
// View tokens that flood one method cannot slow a driver down. Every method of protocol/asyncapi.json is
// flooded in turn by eight viewers (in the short form, those that viewers may call, and one that they may not). The
// driver keeps its frames, and the daemon answers "energy off" soon.
import assert from 'node:assert/strict';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';
import { Driver, now } from './wire/driver.mjs';
import { Flood } from './wire/flood.mjs';
import { slowness } from './wire/machine.mjs';
import { AT_REST } from './wire/scene.mjs';

const { operations, components: { messages, schemas } } = JSON.parse(readFileSync(process.env.ASYNCAPI));
const ALL = process.env.E2E_ALL === '1';
const sanitized = process.env.E2E_SLOW === '1'; // figures of time mean nothing there: off is answered, and no race is found
const VIEWERS = 8, SECONDS = ALL ? 2 : sanitized ? 0.3 : 1, FRAMES_LEAST = 0.95, PERIOD_MS = 50;
const OFF_MOST_S = 0.05 * slowness(), ANSWER_MOST_S = 0.05 * slowness();
const TOKENS = { view: 'viewer-token-0123456789', operate: 'driver-token-0123456789' };
const viewing = { token: TOKENS.view };

// "Off" acts at once, and is answered when it is stored. The store is in memory, so that other programs which write to the
// disk add nothing to the times: beside one that did, an answer took 95 ms without any flood.
const MEMORY = '/dev/shm';

let folder, daemon, driver, session, stream;
before(async () => {
	folder = mkdtempSync(join(existsSync(MEMORY) ? MEMORY : tmpdir(), 'cautery-starving-'));
	writeFileSync(join(folder, 'tokens'), `view ${TOKENS.view}\noperate ${TOKENS.operate}\n`, { mode: 0o600 });
	daemon = await Daemon.start({ settings: { tokens: join(folder, 'tokens'), store: join(folder, 'store.db') } });
	driver = await Driver.connect(daemon.url(), { hello: { token: TOKENS.operate } });
	session = (await driver.client.call('session.create', { name: 'knee', scene: 'fascia' })).summary.session;
	stream = await driver.client.join(session);
	await driver.client.call('tool.take_over', { session, tool: 'hook' });
	driver.drive(session);
});
after(async () => {
	driver.rest();
	await daemon.end();
	rmSync(folder, { recursive: true });
});

// ---- a request of each method, made of its schema
const KNOWN = {
	tool: 'hook', name: 'another', scene: 'layers', rotation: AT_REST, layer: 'fascia', version: 1, epoch: '0'.repeat(16),
	selection: { kind: 'sphere', center_m: [0, 0, 0], radius_m: 0.01 },
};

function filler(name, { type, enum: choices, minItems, minimum }) {
	const value = { session, ...KNOWN }[name] ?? choices?.[0];
	if (value !== undefined)
		return value;
	if (type === 'array')
		return Array(minItems).fill(0);
	return { boolean: true, string: 'another', integer: minimum ?? 1, number: 1 }[type];
}

function paramsOf(method) {
	const named = ({ $ref }) => schemas[$ref.split('/').at(-1)];
	const params = messages[method].payload.properties.params;
	const whole = params ? named(params) : {};
	const { properties = {}, required: always = [], anyOf = [] } = whole.oneOf ? named(whole.oneOf[0]) : whole;
	const required = [...always, ...(anyOf[0]?.required ?? [])];
	const wanted = Object.keys(properties).filter((name) => required.includes(name) || name === 'session');
	return Object.fromEntries(wanted.map((name) => [name, filler(name, properties[name])]));
}

// ---- what the driver sees
// Frames of so many seconds, and how long each "energy off" waited for its answer.
async function watch(seconds) {
	const frames = () => stream.counts.key + stream.counts.delta;
	const from = frames(), began = now(), took = [];
	while (now() - began < seconds) {
		await new Promise((resolve) => setTimeout(resolve, PERIOD_MS)); // each change of energy publishes a frame
		await driver.client.call('tool.energize', { session, tool: 'hook', energized: true });
		const asked = now();
		await driver.client.call('tool.energize', { session, tool: 'hook', energized: false });
		took.push(now() - asked);
	}
	return { rate: (frames() - from) / (now() - began), off: Math.max(...took), offs: took.length };
}

test("a viewer's scene.get does not wait for those of others", async (t) => {
	const other = await daemon.connect({ hello: viewing }), took = [];
	const flood = await Flood.start(daemon.url(), { what: 'bursts', viewers: VIEWERS, pipeline: 1, hello: viewing,
		requests: [['scene.get', { scene: 'layers' }]] });
	const began = now();
	while (now() - began < SECONDS) {
		const asked = now();
		await other.call('scene.get', { scene: 'fascia' });
		took.push(now() - asked);
		await new Promise((resolve) => setTimeout(resolve, PERIOD_MS));
	}
	await flood.stop();
	const most = Math.max(...took);
	t.diagnostic(`answered after ${(1e3 * most).toFixed(1)} ms at most of ${took.length}`);
	assert.ok(sanitized || most <= ANSWER_MOST_S, `answered after ${most} s`);
});

const methods = Object.entries(operations).filter(([, { action }]) => action === 'receive').map(([name]) => name);
const only = process.env.E2E_METHODS?.split(',') ?? methods;

// Whether the role of the flooding clients refuses the method. All of these are refused by one check, which comes before
// their handlers. One of them stands for all, except in the long form of the test (E2E_ALL=1).
async function isForbidden(method) {
	const viewer = await daemon.connect({ hello: viewing });
	const forbidden = await viewer.call(method, paramsOf(method)).then(() => false, ({ data }) => data?.status === 'forbidden');
	await viewer.close();
	return forbidden;
}

async function flood(t, method) {
	const calm = await watch(SECONDS);
	const flooding = await Flood.start(daemon.url(), {
		what: 'bursts', viewers: VIEWERS, pipeline: 1, hello: viewing, requests: [[method, paramsOf(method)]],
		join: /^stream\.|leave/.test(method) ? session : undefined,
	});
	const flooded = await watch(SECONDS).finally(() => flooding.stop().then(({ asked, answered }) =>
		t.diagnostic(`asked ${asked} times, answered ${answered}`)));
	t.diagnostic(`${calm.rate.toFixed(1)} frames/s, flooded ${flooded.rate.toFixed(1)}; `
		+ `off after ${(1e3 * calm.off).toFixed(1)} ms at most, flooded ${(1e3 * flooded.off).toFixed(1)} of ${flooded.offs}`);
	assert.ok(flooded.offs > 0);
	if (sanitized)
		return;
	assert.ok(flooded.rate >= FRAMES_LEAST * calm.rate, `${flooded.rate} of ${calm.rate} frames a second`);
	assert.ok(flooded.off <= OFF_MOST_S, `off is answered after ${flooded.off} s`);
}

test(`${VIEWERS} viewers that flood a method slow nobody`, async (t) => {
	const forbidden = [];
	for (const method of methods.filter((name) => only.includes(name))) {
		if (await isForbidden(method) && forbidden.push(method) > 1 && !ALL)
			continue;
		await t.test(method, (t) => flood(t, method));
	}
	t.diagnostic(`viewers may not call ${forbidden.length} of ${methods.length} methods: ${forbidden.join(' ')}`);
});
