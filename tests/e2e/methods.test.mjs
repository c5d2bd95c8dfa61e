// SPDX-License-Identifier: GPL-3.0-or-later
// The methods that the other tests do not go through.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { chunk } from './wire/client.mjs';
import { Daemon } from './wire/daemon.mjs';
import { AT_REST, cutMiddle, smallScene, smallSession } from './wire/scene.mjs';

let daemon, client;
before(async () => {
	daemon = await Daemon.start({ settings: { max_sessions: 12 } });
	client = await daemon.connect();
});
after(() => daemon.end());

test('scenes are listed and told whole', async () => {
	const { scenes } = await client.call('scene.list');
	const names = scenes.map((s) => s.name);
	assert.ok(['fascia', 'fat', 'layers'].every((n) => names.includes(n)), names.join(' '));
	assert.deepEqual(names, [...names].sort());
	const { definition } = await client.call('scene.get', { scene: 'fascia' });
	assert.equal(definition.step_s, 1 / 60);
	await assert.rejects(client.call('scene.get', { scene: 'nothing' }), { code: -32005 });
});

test('a session is created, listed, described and destroyed; everybody is told', async () => {
	const other = await daemon.connect();
	const made = await client.call('session.create', { name: 'told', scene: 'fascia', paused: true });
	assert.equal(made.summary.session, 'd1-told');
	assert.equal(made.layers[0].name, 'fascia');
	assert.equal(made.drivers[0].tool, 'hook');
	await other.until(() => other.notice('session.changed', (p) => p.change === 'created'), 'the news');
	assert.ok((await other.call('session.list')).sessions.some((s) => s.session === 'd1-told'));
	const described = await other.call('session.describe', { session: 'd1-told' });
	assert.deepEqual(described.definition, made.definition);
	await assert.rejects(client.call('session.create', { name: 'told', scene: 'fascia' }), { code: -32006 });
	await client.call('session.destroy', { session: 'd1-told' });
	await other.until(() => other.notice('session.changed', (p) => p.change === 'destroyed'), 'the end');
	await assert.rejects(other.call('session.describe', { session: 'd1-told' }), { code: -32040 });
	await other.close();
});

test('the URL\'s session is meant when a message names none', async () => {
	const session = await smallSession(client, 'url', { paused: true });
	const own = await daemon.connect({ session });
	assert.equal((await own.call('session.describe')).summary.session, session);
	assert.deepEqual(await own.call('session.step', { ticks: 3 }), { tick: 3 });
	await own.call('session.destroy');
	await own.close();
});

test('a tool that is changed is told at once, to everybody, while the session is paused', async () => {
	const session = await smallSession(client, 'changed', { paused: true });
	const other = await daemon.connect();
	await other.join(session);
	const { definition: { tools: [{ name, ...tool }] } } = await client.call('session.describe', { session });
	delete tool.position_m;
	delete tool.rotation;
	await client.call('tool.configure', { ...tool, session, tool: name, temperature_c: 432 });
	await other.until(() => other.notice('session.changed', (p) => p.summary.session === session && p.change === 'tools'), 'the news');
	for (const one of [client, other]) {
		const { definition } = await one.call('session.describe', { session });
		assert.equal(definition.tools[0].temperature_c, 432);
	}
	await client.call('session.destroy', { session });
	await other.close();
});

test('pause, step, resume, speed, reset', async () => {
	const session = await smallSession(client, 'time');
	const stream = await client.join(session);
	await assert.rejects(client.call('session.step', { session }), { code: -32004 });
	assert.equal((await client.call('session.pause', { session })).state, 'paused');
	const { tick } = await client.call('session.step', { session, ticks: 7 });
	await client.until(() => stream.tick === tick && stream.flags & 1, 'the paused frame');
	await client.call('session.speed', { session, speed: 5 });
	const started = performance.now(); // it runs before the answer is here
	assert.equal((await client.call('session.resume', { session })).speed, 5);
	await client.until(() => stream.tick >= tick + 300, 'five seconds at five-fold speed');
	const seconds = (performance.now() - started) / 1000;
	assert.ok(seconds > 0.8 && (seconds < 4 || process.env.E2E_SLOW === '1'), `${seconds} s`);
	const back = await client.call('session.reset', { session });
	assert.equal(back.tick, 0);
	await client.call('session.destroy', { session });
});

test('tools are added, configured, driven and removed', async () => {
	const session = await smallSession(client, 'tools', { paused: true });
	const stream = await client.join(session, { rate_hz: 1000 });
	await client.call('tool.add', { session, name: 'grip', shape: 'grasper', position_m: [0, 0, 0.02], rotation: AT_REST });
	await client.call('session.step', { session, ticks: 1 });
	const grip = await client.until(() => stream.tools.find((t) => t.name === 'grip'), 'the tool');
	assert.equal(grip.driver, client.hello.client);
	await client.call('tool.configure', { session, tool: 'grip', shape: 'grasper', tip_length_m: 0.01 });
	await client.call('tool.grasp', { session, tool: 'grip' });
	await client.call('session.step', { session, ticks: 1 });
	await client.until(() => stream.tools.find((t) => t.name === 'grip')?.grasping, 'closed jaws');
	await client.call('tool.release', { session, tool: 'grip' });
	await client.call('tool.remove', { session, tool: 'grip' });
	await client.call('session.step', { session, ticks: 1 });
	await client.until(() => stream.tools.length === 1, 'no more');
	await assert.rejects(client.call('tool.move', { session, tool: 'grip', position_m: [0, 0, 0], rotation: AT_REST }),
		{ code: -32005 });
	await client.call('session.destroy', { session });
});

test('pins, forces, gravity and materials act on the tissue', async () => {
	const session = await smallSession(client, 'tissue', { paused: true });
	const stream = await client.join(session, { rate_hz: 1000 });
	const middle = { kind: 'sphere', center_m: [0, 0, 0], radius_m: 0.01 };
	await client.call('force.set', { session, selection: middle, force_n: [0, 0, 0.05] });
	await client.call('session.step', { session, ticks: 30 });
	const highest = () => Math.max(...Array.from({ length: stream.description.vertex_count }, (_, v) => stream.position(v)[2]));
	await client.until(() => stream.tick === 30, 'the pull');
	const pulled = highest();
	assert.ok(pulled > 5e-4, `${pulled} m`);
	await client.call('pin', { session, selection: middle });
	await client.call('force.set', { session, selection: middle, force_n: [0, 0, 0] });
	await client.call('session.step', { session, ticks: 30 });
	await client.until(() => stream.tick === 60, 'held');
	assert.ok(Math.abs(highest() - pulled) < 2e-3, 'the pin holds');
	await client.call('unpin', { session, selection: middle });
	await client.call('gravity.set', { session, gravity_m_s2: [0, 0, -20] });
	await client.call('session.step', { session, ticks: 60 });
	await client.until(() => stream.tick === 120, 'let go');
	assert.ok(highest() < pulled / 2, 'it falls back');
	const { definition } = await client.call('session.describe', { session });
	assert.deepEqual(definition.gravity_m_s2, [0, 0, -20]);
	await client.call('material.set', { session, layer: 'fascia', kind: 'fascia', thickness_m: 1e-3 });
	await client.call('session.step', { session, ticks: 1 });
	await client.call('session.destroy', { session });
});

test('snapshots are named, and restored on another branch', async () => {
	const session = await smallSession(client, 'named', { paused: true });
	await client.call('session.step', { session, ticks: 5 });
	const first = await client.call('session.snapshot', { session, name: 'five' });
	await client.call('session.step', { session, ticks: 5 });
	await assert.rejects(client.call('session.snapshot', { session, name: 'five' }), { code: -32006 });
	await client.call('session.rewind', { session, tick: 2 });
	const back = await client.call('session.restore', { session, name: 'five' });
	assert.equal(back.tick, 5);
	const again = await client.call('session.snapshot', { session, name: 'again' });
	assert.equal(again.hash, first.hash);
	// After a command of this very tick the state is the log's: nothing is stored for the snapshot.
	await client.call('tool.take_over', { session, tool: 'hook' });
	await client.call('tool.move', { session, tool: 'hook', position_m: [0.01, 0, 0.02], rotation: AT_REST });
	const between = await client.call('session.snapshot', { session, name: 'between' });
	assert.equal(between.byte_count, 0);
	assert.equal(between.hash, first.hash);
	await client.call('session.step', { session, ticks: 5 });
	assert.equal((await client.call('session.restore', { session, name: 'between' })).tick, 5);
	const reached = await client.call('session.snapshot', { session, name: 'reached' });
	assert.equal(reached.hash, first.hash);
	assert.ok(reached.byte_count > 0);
	await assert.rejects(client.call('session.restore', { session, name: 'six' }), { code: -32005 });
	await assert.rejects(client.call('session.rewind', { session, tick: 1000 }), { code: -32602 });
	await client.call('session.destroy', { session });
});

test('the timeline tells of cuts and energy, and exports are files', async () => {
	const session = await smallSession(client, 'files', { paused: true });
	const { tick } = await cutMiddle(client, session, 60);
	const timeline = await client.call('session.timeline', { session });
	const kinds = timeline.events.map((e) => e.kind);
	assert.equal(timeline.tick, tick);
	assert.ok(['created', 'driver', 'energy_on', 'cut'].every((k) => kinds.includes(k)), kinds.join(' '));
	const vtu = (await client.file('session.export', { session, format: 'vtu' })).toString();
	assert.match(vtu, /<VTKFile type="UnstructuredGrid"/);
	assert.equal(vtu.split('NumberOfPoints="')[1].split('"')[0], String(25 * 21));
	const lines = (await client.file('session.log', { session })).toString().trim().split('\n').map(JSON.parse);
	assert.deepEqual(lines.map((l) => l.command), ['tool.move', 'tool.energize', 'tool.move']);
	await client.call('session.destroy', { session });
});

test('a mesh is uploaded in chunks and becomes a session, which outlives the daemon', async () => {
	const own = await Daemon.start();
	const maker = await own.connect();
	const side = 12, text = [];
	for (let y = 0; y <= side; y++)
		for (let x = 0; x <= side; x++)
			text.push(`v ${(x / side - 0.5) * 100} ${(y / side - 0.5) * 100} 0`);
	for (let y = 0; y < side; y++)
		for (let x = 0; x < side; x++) {
			const a = y * (side + 1) + x + 1, b = a + 1, c = b + side + 1, d = a + side + 1;
			text.push(`f ${a} ${b} ${c}`, `f ${a} ${c} ${d}`);
		}
	const definition = await smallScene(maker);
	const uploaded = await maker.upload('patch', 'patch.obj', Buffer.from(text.join('\n')), 1000);
	definition.meshes[0] = { name: definition.meshes[0].name, source: 'bytes', file: uploaded.file, unit_m: 0.001 };
	const made = await maker.call('session.create', { name: 'patch', definition, paused: true });
	assert.equal(made.summary.vertex_count, 169);
	assert.equal(made.triangle_count, 288);
	await maker.call('session.step', { session: 'd1-patch', ticks: 10 });
	const { hash } = await maker.call('session.snapshot', { session: 'd1-patch', name: 'ten' });
	await own.kill();
	const next = await Daemon.start({ folder: own.folder });
	const again = await next.connect();
	await again.call('session.restore', { session: 'd1-patch', name: 'ten' });
	assert.equal((await again.call('session.snapshot', { session: 'd1-patch' })).hash, hash);
	await again.close();
	await next.end();
});

// A flat sheet of two triangles a cell.
function sheetText(side) {
	const text = [];
	for (let y = 0; y <= side; y++)
		for (let x = 0; x <= side; x++)
			text.push(`v ${(x / side - 0.5) * 100} ${(y / side - 0.5) * 100} 0`);
	for (let y = 0; y < side; y++)
		for (let x = 0; x < side; x++) {
			const a = y * (side + 1) + x + 1, b = a + 1, c = b + side + 1, d = a + side + 1;
			text.push(`f ${a} ${b} ${c}`, `f ${a} ${c} ${d}`);
		}
	return Buffer.from(text.join('\n'));
}

const withMesh = (definition, file) => ({
	...definition,
	meshes: [{ name: definition.meshes[0].name, source: 'bytes', file, unit_m: 0.001 }],
});

test('many attempts at a mesh do not use up a connection', async (t) => {
	const own = await Daemon.start();
	t.after(() => own.end());
	const maker = await own.connect();
	const definition = await smallScene(maker);
	for (let i = 0; i < 20; i++) {
		const broken = await maker.upload('knee', 'knee.obj', Buffer.from(`v 0 0 ${i}\nf 1 2 3\n`));
		await assert.rejects(maker.call('session.create', { definition: withMesh(definition, broken.file) }));
		if (i % 2)
			await maker.call('upload.discard', { name: 'knee' }); // else the next one takes its place
	}
	for (let i = 0; i < 20; i++)
		await maker.upload(`other-${i}`, 'other.obj', Buffer.from('v 0 0 0\n'));
	const sound = await maker.upload('knee', 'knee.obj', sheetText(6), 100);
	const made = await maker.call('session.create', { definition: withMesh(definition, sound.file), paused: true });
	assert.equal(made.summary.vertex_count, 49);
	await maker.close();
});

test('the second upload of a name is the one that counts, and a session keeps what it was made of', async (t) => {
	const own = await Daemon.start();
	t.after(() => own.end());
	const maker = await own.connect();
	const definition = await smallScene(maker);
	const create = async (file) => (await maker.call('session.create', { definition: withMesh(definition, file), paused: true })).summary;
	const first = await maker.upload('knee', 'knee.obj', sheetText(6));
	const early = await create(first.file);
	const second = await maker.upload('knee', 'knee.obj', sheetText(8));
	assert.equal((await create(second.file)).vertex_count, 81);
	// One that is still coming is replaced as well, and what still comes for it is dropped.
	const cutShort = await maker.call('upload.begin', { name: 'knee', file_name: 'knee.obj', byte_count: 1000 });
	const third = await maker.upload('knee', 'knee.obj', sheetText(4));
	maker.socket.send(chunk(cutShort.transfer, 0, Buffer.alloc(1000)));
	await assert.rejects(maker.call('upload.end', { transfer: cutShort.transfer, sha256: '0'.repeat(64) }), { code: -32005 });
	assert.equal((await create(third.file)).vertex_count, 25);
	await maker.call('upload.discard', { name: 'knee' });
	await assert.rejects(create(third.file), (error) => /no upload of this connection is named `knee`/.test(error.data.reason));
	await assert.rejects(maker.call('upload.discard', { name: 'knee' }), (error) => error.data.path === 'params.name');
	await maker.call('session.step', { session: early.session, ticks: 2 });
	await maker.close();
});

test('uploads are bounded by bytes: of a connection, and of all; a connection that ends gives its own back', async (t) => {
	const settings = { max_upload_bytes: 300000, max_connection_upload_bytes: 400000, max_all_upload_bytes: 700000 };
	const own = await Daemon.start({ settings });
	t.after(() => own.end());
	const [one, other] = [await own.connect(), await own.connect()];
	const begin = (client, name, bytes) => client.call('upload.begin', { name, file_name: 'm.obj', byte_count: bytes });
	const beyond = (setting) => (error) => error.code === -32007 && error.data.reason.includes(`setting ${setting})`) &&
		error.data.reason.includes(String(settings[setting]));
	assert.equal(one.hello.limits.uploads_bytes_max, 400000);
	await assert.rejects(begin(one, 'a', 300001), beyond('max_upload_bytes'));
	await begin(one, 'a', 300000);
	await assert.rejects(begin(one, 'b', 100001), beyond('max_connection_upload_bytes'));
	await begin(one, 'a', 250000); // in its place
	await begin(one, 'b', 150000);
	await begin(other, 'a', 290000);
	await assert.rejects(begin(other, 'b', 20000), beyond('max_all_upload_bytes')); // counts for 65,536
	await one.call('upload.discard', { name: 'b' });
	await begin(other, 'b', 20000);
	await assert.rejects(begin(other, 'c', 100000), beyond('max_connection_upload_bytes'));
	const third = await own.connect();
	await assert.rejects(begin(third, 'a', 300000), beyond('max_all_upload_bytes'));
	await one.close();
	await begin(third, 'a', 300000);
	await third.close();
	await other.close();
});

test('a connection joins eight streams; the ninth is refused, and leaving one makes room', async (t) => {
	const own = await Daemon.start();
	t.after(() => own.end());
	const viewer = await own.connect();
	const sessions = [];
	for (let i = 0; i < 9; i++)
		sessions.push(await smallSession(viewer, `stream-${i}`, { cells: [4, 4], paused: true }));
	assert.equal(viewer.hello.limits.streams_max, 8);
	for (const session of sessions.slice(0, 8))
		await viewer.join(session);
	await viewer.join(sessions[0], { rate_hz: 5 }); // again: it takes the place of the one before
	await assert.rejects(viewer.join(sessions[8]), (error) =>
		error.code === -32007 && /8 streams/.test(error.data.reason));
	await viewer.call('session.leave', { session: sessions[3] });
	await viewer.join(sessions[8]);
	const { sessions: listed } = await viewer.call('session.list');
	assert.deepEqual(listed.map((s) => s.subscriber_count).sort().join(''), '011111111');
	await viewer.close();
});

test('limits are answered: sessions, names, profiles', async () => {
	await assert.rejects(client.call('session.create', { name: 'x'.repeat(48), scene: 'fascia' }), { code: -32602 });
	await assert.rejects(client.call('session.create', { name: 'Bad', scene: 'fascia' }), { code: -32602 });
	await assert.rejects(client.call('session.create', {}), { code: -32602 });
	const made = [];
	for (let i = 0; i < 14; i++)
		made.push(await smallSession(client, `many-${i}`, { paused: true }).catch((error) => error));
	const refused = made.filter((m) => m instanceof Error);
	assert.ok(refused.length === 2 && refused.every((e) => e.code === -32007), 'the limit is told');
	for (const session of made.filter((m) => typeof m === 'string'))
		await client.call('session.destroy', { session });
});
