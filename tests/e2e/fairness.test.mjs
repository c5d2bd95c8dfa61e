// SPDX-License-Identifier: GPL-3.0-or-later
// Nobody takes the machine from the others: a driven session keeps its pace, and its driver is never
// refused, whatever viewers ask for and whoever makes large sessions.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { RpcError } from './wire/client.mjs';
import { Daemon } from './wire/daemon.mjs';
import { Driver, now } from './wire/driver.mjs';
import { Flood } from './wire/flood.mjs';

const sanitized = process.env.E2E_SLOW === '1';
const UNBOUNDED = Object.fromEntries(['connection', 'address', 'view', 'operate', 'admin', 'all']
	.map((whose) => [`quota_${whose}`, 1000000]));
const SECONDS = 4;

// A session that somebody drives: motion as from a hand, and a request every 50 ms.
async function driven(daemon, name) {
	const { summary } = await (await daemon.connect()).call('session.create', { name, scene: 'fascia' });
	const driver = await Driver.connect(daemon.url());
	const session = summary.session;
	const stream = await driver.client.join(session);
	await driver.client.call('tool.take_over', { session, tool: 'hook' });
	driver.drive(session);
	return { driver, session, stream };
}

// Simulated over wall time, and what was refused to the driver meanwhile.
async function pace({ driver, session, stream }, seconds) {
	const refused = [], from = stream.tick, began = now();
	let asked = 0;
	while (now() - began < seconds) {
		asked++;
		await driver.client.call('tool.energize', { session, tool: 'hook', energized: false })
			.catch((error) => refused.push(error.message));
		await new Promise((resolve) => setTimeout(resolve, 50)); // twenty a second, as a busy page asks
	}
	refused.push(...driver.client.notices.filter((n) => n.method === 'tool.refused').map((n) => n.params.reason));
	return { factor: (stream.tick - from) / 60 / (now() - began), asked, refused };
}

test('two viewers that ask for exports without end cost the session nothing', { skip: sanitized }, async (t) => {
	const daemon = await Daemon.start({ settings: UNBOUNDED });
	const session = await driven(daemon, 'knee');
	const flood = await Flood.start(daemon.url(), { requests: [
		['session.export', { session: 'd1-knee', format: 'vtu' }],
		['session.export', { session: 'd1-knee', format: 'obj' }],
		['session.log', { session: 'd1-knee' }],
		['session.describe', { session: 'd1-knee' }],
		['session.timeline', { session: 'd1-knee' }],
	] });
	const { factor, asked, refused } = await pace(session, SECONDS);
	const { answered } = await flood.stop();
	t.diagnostic(`${factor.toFixed(3)} of real time; the driver was answered ${asked} times, the viewers ${answered}`);
	assert.deepEqual(refused, []);
	assert.ok(factor >= 0.9, `${factor} of real time`);
	assert.ok(answered > 0, 'the viewers are served too');
	session.driver.rest();
	await daemon.end();
});

test('who asks too much hears which setting says so and when to try again', async () => {
	const daemon = await Daemon.start({ settings: { quota_connection: 3 } });
	const client = await daemon.connect();
	await client.call('session.create', { name: 'knee', scene: 'fascia', paused: true });
	for (let i = 0; i < 2; i++)
		await client.file('session.export', { session: 'd1-knee', format: 'obj' });
	await assert.rejects(client.call('session.export', { session: 'd1-knee', format: 'obj' }), (error) =>
		error instanceof RpcError && error.code === -32046 && /setting quota_connection\): try again in \d+\.\d s/.test(error.data.reason));
	await client.call('session.describe', { session: 'd1-knee' }); // costs little
	const other = await daemon.connect();
	await other.file('session.export', { session: 'd1-knee', format: 'obj' });
	await daemon.end();
});

test('more files than a connection may have under way are refused, not the connection', async () => {
	const daemon = await Daemon.start();
	const client = await daemon.connect();
	await client.call('session.create', { name: 'knee', scene: 'fascia', paused: true });
	const asked = await Promise.allSettled(Array.from({ length: 12 }, () =>
		client.call('session.export', { session: 'd1-knee', format: 'vtu' })));
	const refused = asked.filter(({ status }) => status === 'rejected');
	assert.ok(asked.length - refused.length >= 4);
	for (const { reason } of refused)
		assert.match(reason.message, /files are being sent on this connection.*try again/);
	await client.file('session.export', { session: 'd1-knee', format: 'obj' });
	await daemon.end();
});

test('reads see every command that was sent before them', async () => {
	const daemon = await Daemon.start();
	const client = await daemon.connect();
	await client.call('session.create', { name: 'knee', scene: 'fascia' });
	for (let i = 1; i <= 20; i++) {
		const gravity_m_s2 = [0, 0, -i / 10];
		const [, described] = await Promise.all([
			client.call('gravity.set', { session: 'd1-knee', gravity_m_s2 }),
			client.call('session.describe', { session: 'd1-knee' }),
		]);
		assert.deepEqual(described.definition.gravity_m_s2, gravity_m_s2);
	}
	await daemon.end();
});

// ---- what is built
const sheet = (name, cells) => {
	const scene = JSON.parse(readFileSync(join(process.env.SCENES, 'fascia.json'), 'utf8'));
	scene.name = name;
	scene.meshes[0].cells = [cells, cells];
	return scene;
};

test('large sessions are built beside a driven one, tell how far they are, and can be cancelled', { skip: sanitized }, async (t) => {
	const daemon = await Daemon.start({ settings: UNBOUNDED });
	const session = await driven(daemon, 'knee');
	const maker = await daemon.connect(), other = await daemon.connect();
	const made = ['one', 'two'].map((name) =>
		maker.call('session.create', { name, definition: sheet(name, 650) }).catch((error) => error));
	await daemon.log(/building.*stage=ordering/);
	const { factor, refused } = await pace(session, SECONDS);
	t.diagnostic(`${factor.toFixed(3)} of real time while two sheets of 423,801 vertices are built`);
	assert.deepEqual(refused, []);
	assert.ok(factor >= 0.9, `${factor} of real time`);
	const { sessions } = await other.call('session.list');
	const starting = sessions.filter(({ state }) => state === 'starting');
	assert.equal(starting.length, 2);
	assert.ok(starting.some(({ stage }) => ['meshing', 'ordering', 'factoring', 'settling'].includes(stage)), JSON.stringify(starting));
	// a small one does not stand behind the giants
	await other.call('session.create', { name: 'small', scene: 'fascia', paused: true });
	assert.equal((await other.call('session.list')).sessions.filter(({ state }) => state === 'starting').length, 2);
	await Promise.all(['d1-one', 'd1-two'].map((name) => other.call('session.destroy', { session: name })));
	for (const error of await Promise.all(made))
		assert.match(error.message, /destroyed while it was being built, before (meshing|ordering|factoring|settling)/);
	assert.equal((await other.call('session.list')).sessions.length, 2);
	session.driver.rest();
	await daemon.end();
});

test('a session beyond a limit is refused by name before its numbers are made', async () => {
	const settings = { max_session_vertices: 5000, max_session_elements: 9000, max_session_bytes: 30000000, max_sessions_bytes: 40000000 };
	const daemon = await Daemon.start({ settings });
	const client = await daemon.connect();
	const refusal = (cells, pattern) => assert.rejects(
		client.call('session.create', { definition: sheet('large', cells) }), pattern);
	await refusal(100, /10201 vertices; a session may have 5000 \(setting max_session_vertices\)/);
	await refusal(69, /9522 elements; a session may have 9000 \(setting max_session_elements\)/);
	const made = [];
	await assert.rejects(async () => {
		for (let i = 0; i < 30; i++)
			made.push(await client.call('session.create', { definition: sheet('small', 30), paused: true }));
	}, /MB of memory, all sessions then \d+ MB; they may take 40 MB \(setting max_sessions_bytes\)/);
	assert.ok(made.length > 1, 'some fit');
	await client.call('session.destroy', { session: made[0].summary.session });
	await daemon.log(/destroyed/);
	assert.ok(!daemon.lines.some((line) => /stage=factoring vertices=10201/.test(line)));
	await daemon.end();
});

test('what is still built is given up when the daemon ends', async () => {
	const daemon = await Daemon.start();
	const client = await daemon.connect();
	client.call('session.create', { name: 'large', definition: sheet('large', 200) }).catch(() => {});
	await daemon.log(/building.*stage=meshing/);
	assert.equal((await daemon.end()).code, 0);
});
