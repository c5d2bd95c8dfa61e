// SPDX-License-Identifier: GPL-3.0-or-later
// Frames, decoded as protocol/README.md says, against what the server exports.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';
import { header, sections } from './wire/decoder.mjs';
import { AT_REST, cutMiddle, picture, smallScene, smallSession } from './wire/scene.mjs';

const slow = process.env.E2E_SLOW === '1'; // a sanitizer's build
let daemon;
before(async () => {
	daemon = await Daemon.start();
});
after(() => daemon.end());

function readObj(bytes) {
	const vertices = [], faces = [];
	for (const line of bytes.toString().split('\n')) {
		const parts = line.split(' ');
		if (parts[0] === 'v')
			vertices.push(parts.slice(1).map(Number));
		else if (parts[0] === 'f')
			faces.push(parts.slice(1).map((v) => Number(v) - 1).join(' '));
	}
	return { vertices, faces };
}

// Positions of drawn vertices are sent exactly to half a step (plus the export's nine digits);
// the mask must be the very same.
async function compare(client, session, stream) {
	const { vertices, faces } = readObj(await client.file('session.export', { session, format: 'obj' }));
	const bound = 0.5001 * stream.description.step_m + 1e-9;
	const drawn = new Set(), shown = []; // a membrane's face may have the corners of the fat's below it
	assert.equal(vertices.length, stream.description.vertex_count);
	for (let f = 0; f < stream.description.face_count; f++) {
		const corners = [...stream.faces.subarray(3 * f, 3 * f + 3)];
		if (stream.isRemoved(f))
			continue;
		corners.forEach((v) => drawn.add(v));
		shown.push(corners.join(' '));
	}
	assert.deepEqual(shown.sort(), faces.sort());
	for (const v of drawn)
		stream.position(v).forEach((value, c) =>
			assert.ok(Math.abs(value - vertices[v][c]) <= bound, `vertex ${v}: ${value} ${vertices[v][c]}`));
	return drawn.size;
}

test('after a cut of many deltas, positions and mask are the export\'s', async () => {
	const client = await daemon.connect();
	const session = await smallSession(client, 'cut', { paused: true });
	const stream = await client.join(session, { rate_hz: 1000 });
	const { tick } = await cutMiddle(client, session, 400); // frames come every millisecond at most, ticks may be faster
	await client.until(() => stream.tick === tick, 'the last frame');
	assert.ok(stream.counts.delta > 50, `${stream.counts.delta} deltas`);
	assert.ok(stream.removed() > 0, 'faces were removed');
	assert.ok(await compare(client, session, stream) > 300);
	assert.equal(stream.counts.skipped, 0);
	await client.close();
});

// Fat whose inside nobody sees until it is cut: bits of the mask go both ways.
async function fatSession(client, name) {
	const { definition } = await client.call('scene.get', { scene: 'fat' });
	definition.meshes[0].cells = [34, 16, 4];
	Object.assign(definition.tools[0], { temperature_c: 200, position_m: [-0.03, 0, 0.004] });
	for (const layer of definition.layers)
		Object.assign(layer, { ignition_c: 80, absorption_per_s: 20 });
	definition.name = 'small-fat';
	delete definition.cut;
	const tool = definition.tools[0].name;
	const made = await client.call('session.create', { name, definition, paused: true });
	return { session: made.summary.session, tool };
}

test('a face that a cut lays open comes with its vertices, in the same frame', async () => {
	const client = await daemon.connect(), second = await daemon.connect();
	const { session, tool } = await fatSession(client, 'laid-open');
	const stream = await client.join(session, { rate_hz: 1000 });
	const whole = await second.join(session, { rate_hz: 1000, channels: ['positions', 'exposure', 'charring'] });
	await client.call('tool.take_over', { session, tool });
	await client.call('tool.energize', { session, tool, energized: true });
	let opened = 0, stale = 0, warmed = false;
	for (let i = 0; i < 300 && opened < 10; i++) {
		const before = Uint32Array.from(stream.mask);
		await client.call('tool.move', { session, tool, position_m: [-0.03 + 0.0002 * i, 0, Math.max(0.003 - 0.0002 * i, -0.002)], rotation: AT_REST });
		const { tick } = await client.call('session.step', { session, ticks: 1 });
		await Promise.all([client.until(() => stream.tick === tick, 'the frame'), second.until(() => whole.tick === tick, 'its')]);
		warmed ||= whole.charring.some((value, v) => value === 0 && whole.exposure[v] > 0);
		if (!before.some((word, w) => word & ~stream.mask[w]))
			continue;
		opened++;
		const drawn = await compare(client, session, stream);
		// Without the mask every vertex is told, so the inside too.
		const { vertices } = readObj(await client.file('session.export', { session, format: 'obj' }));
		vertices.forEach((at, v) => whole.position(v).forEach((value, c) =>
			assert.ok(Math.abs(value - at[c]) <= 0.5001 * whole.description.step_m + 1e-9, `vertex ${v}`)));
		stale += drawn < vertices.length;
	}
	assert.ok(opened >= 10, `${opened} ticks laid faces open`);
	assert.equal(stale, opened, 'there always was an inside');
	assert.ok(whole.charring.some((value) => value > 0 && value < 255), 'some are charred');
	assert.ok(warmed, 'heat alone chars nothing');
	await Promise.all([client.close(), second.close()]);
});

test('a late joiner holds the same as one who was there', async () => {
	const first = await daemon.connect();
	const session = await smallSession(first, 'late', { paused: true });
	const early = await first.join(session, { rate_hz: 1000 });
	const { tick } = await cutMiddle(first, session, 60);
	await first.until(() => early.tick === tick, 'the last frame');
	const second = await daemon.connect();
	const late = await second.join(session, { rate_hz: 1000 });
	await second.until(() => late.tick === tick, 'the last frame'); // the ring's key frame may be older
	assert.deepEqual(late.mask, early.mask);
	assert.equal(await compare(second, session, late), await compare(first, session, early));
	await Promise.all([first.close(), second.close()]);
});

test('one who comes back to a paused session holds what was stepped meanwhile', async () => {
	const client = await daemon.connect();
	const session = await smallSession(client, 'back', { paused: true });
	const before = await client.join(session, { rate_hz: 1000 });
	await client.call('session.leave', { session });
	const { tick } = await cutMiddle(client, session, 60);
	assert.equal(before.tick, 0); // nobody watched
	const after = await client.join(session, { rate_hz: 1000 });
	assert.equal(after.tick, tick); // and nothing older before it
	await compare(client, session, after);
	await client.close();
});

test('after a gap the client asks for a key frame and is whole again', async () => {
	const client = await daemon.connect();
	const session = await smallSession(client, 'gap');
	const stream = await client.join(session);
	await client.until(() => stream.counts.delta > 5, 'deltas');
	const take = stream.take.bind(stream);
	let lost = 0;
	stream.take = (bytes) => (lost++ < 1 ? 'skipped' : take(bytes)); // one frame never arrives
	await client.until(() => stream.counts.skipped > 2, 'deltas that do not fit');
	const keys = stream.counts.key;
	await client.call('stream.key_frame', { session });
	await client.until(() => stream.counts.key > keys, 'a key frame');
	const { skipped, delta } = stream.counts;
	await client.until(() => stream.counts.delta > delta + 5, 'deltas after it');
	assert.equal(stream.counts.skipped, skipped);
	await client.call('session.pause', { session });
	const { tick } = await client.call('session.step', { session, ticks: 1 });
	await client.until(() => stream.tick === tick, 'the last frame');
	await compare(client, session, stream);
	await client.close();
});

test('a rewind changes the epoch, and no frame of the old one is taken after it', async () => {
	const client = await daemon.connect();
	const session = await smallSession(client, 'rewind', { paused: true });
	const stream = await client.join(session, { rate_hz: 1000 });
	const cut = await cutMiddle(client, session, 100);
	await client.until(() => stream.tick === cut.tick, 'the cut');
	const removed = stream.removed(), epoch = stream.epoch, seen = [];
	client.onFrame = (s, kind) => seen.push([s.epoch, kind, s.tick]);
	const back = await client.call('session.rewind', { session, tick: 20 });
	await client.until(() => stream.tick === 20, 'the state of tick 20');
	assert.notEqual(stream.epoch, epoch);
	assert.equal(stream.epoch.toString(16).padStart(16, '0'), back.epoch);
	assert.ok(back.exact);
	assert.ok(removed > 0);
	assert.equal(stream.removed(), 0);
	const turn = seen.findIndex(([e]) => e !== epoch);
	assert.ok(seen[turn][1] === 'key' && seen.slice(turn).every(([e]) => e === stream.epoch));
	await compare(client, session, stream);
	await client.close();
});

test('profiles: rate, channels and step are what was asked for', async () => {
	const client = await daemon.connect(), other = await daemon.connect();
	const session = await smallSession(client, 'profiles');
	const coarse = await client.join(session, { rate_hz: 10, step_m: 1e-3, channels: ['positions', 'mask'] });
	const fine = await other.join(session, { rate_hz: 60, step_m: 1e-6, channels: ['positions', 'mask', 'tools', 'statistics', 'stress'] });
	assert.equal(coarse.description.rate_hz, 10);
	assert.equal(fine.description.step_m, 1e-6);
	const began = coarse.published, held = coarse.counts.delta;
	await client.until(() => coarse.published >= began + 1e6, 'a second of frames');
	const { tick } = await client.call('session.pause', { session }); // an answer behind all frames so far
	const seconds = (coarse.published - began) / 1e6, deltas = coarse.counts.delta - held;
	await other.until(() => fine.tick >= tick, 'the last frame of the other connection');
	// A slow build may not reach 10 Hz; a frame more at each end, and that of the pause.
	assert.ok(deltas <= 10 * seconds + 3 && deltas >= (slow ? 1 : 5), `${deltas} at 10 Hz in ${seconds} s`);
	assert.ok(fine.counts.delta > coarse.counts.delta);
	assert.equal(coarse.tools.length, 0);
	assert.equal(fine.tools[0].name, 'hook');
	await Promise.all([client.close(), other.close()]);
});

// The codings of a frame's element sections: 0 plain, 1 meshoptimizer's. Sections of tools (6, 7, 32 to 35) and statistics (8) have none.
const codings = (bytes) => [...sections(bytes, header(bytes))].filter(([type]) => ![6, 7, 8, 32, 33, 34, 35].includes(type)).map(([, payload]) => payload[2]);

test('plain where it is asked for: no codec in any frame, and the same picture', async () => {
	const client = await daemon.connect(), plain = await daemon.connect();
	const session = await smallSession(client, 'plain', { paused: true });
	const seen = { plain: new Set(), coded: new Set() };
	client.onFrame = (stream, kind, bytes) => codings(bytes).forEach((coding) => seen.coded.add(`${kind} ${coding}`));
	plain.onFrame = (stream, kind, bytes) => codings(bytes).forEach((coding) => seen.plain.add(`${kind} ${coding}`));
	const coded = await client.join(session, { rate_hz: 1000 });
	const other = await plain.join(session, { rate_hz: 1000, plain: true });
	assert.deepEqual([coded.description.plain, other.description.plain], [false, true]);
	assert.notEqual(coded.description.profile, other.description.profile);
	const { tick } = await cutMiddle(client, session, 60);
	await client.until(() => coded.tick === tick, 'the last frame');
	await plain.until(() => other.tick === tick, 'the last plain frame');
	assert.deepEqual(picture(other), picture(coded));
	assert.deepEqual([...other.faces], [...coded.faces]);
	assert.ok(other.counts.delta > 20);
	assert.deepEqual([...seen.plain].sort(), ['delta 0', 'key 0', 'topology 0']);
	for (const kind of ['delta', 'key', 'topology'])
		assert.ok(seen.coded.has(`${kind} 1`), kind);
	const { bytes } = await plain.announced('session.frame_at', { session, tick, plain: true });
	assert.deepEqual(new Set(codings(bytes)), new Set([0]));
	await Promise.all([client.close(), plain.close()]);
});

test('plain is never answered with a codec: where all profiles are taken it is refused', async () => {
	const clients = await Promise.all([1, 2, 3, 4, 5].map(() => daemon.connect()));
	const session = await smallSession(clients[0], 'taken', { paused: true });
	for (const [i, client] of clients.slice(0, 4).entries())
		await client.join(session, { rate_hz: 10 + i });
	await assert.rejects(clients[4].call('session.join', { session, plain: true }),
		(error) => error.data.status === 'limit' && error.data.path === 'params.plain');
	assert.equal((await clients[4].join(session, { rate_hz: 40 })).description.plain, false); // the nearest
	await clients[0].close();
	assert.equal((await clients[4].join(session, { plain: true })).description.plain, true);
	await Promise.all(clients.slice(1).map((client) => client.close()));
});

const celsius = (stream, vertex) => stream.temperature[vertex] / 4 - 20;

// The small scene of tissue that takes any heat, its hook energized on it for ten ticks.
async function heated(client, name, joined) {
	const definition = await smallScene(client);
	Object.assign(definition.layers[0], { ignition_c: 2000, absorption_per_s: 0.4 });
	const { summary } = await client.call('session.create', { name, definition, paused: true });
	const { session } = summary, tool = { session, tool: 'hook' };
	const stream = await joined(session);
	await client.call('tool.take_over', tool);
	await client.call('tool.move', { ...tool, position_m: [-0.02, 0, 0.001], rotation: AT_REST });
	await client.call('session.step', { session, ticks: 30 });
	await client.call('tool.energize', { ...tool, energized: true });
	const { tick } = await client.call('session.step', { session, ticks: 10 });
	await client.until(() => stream.tick === tick, 'the last frame');
	return { session, stream };
}

test('temperature is high at the hot tool and the body\'s elsewhere, for late joiners too', async () => {
	const client = await daemon.connect(), other = await daemon.connect();
	const params = { rate_hz: 1000, channels: ['positions', 'mask', 'tools', 'temperature'] };
	const bodies = (stream) => [...stream.temperature.keys()].filter((v) => celsius(stream, v) === 37);
	const { session, stream } = await heated(client, 'heat', async (made) => {
		const joined = await client.join(made, params); // nothing has been stepped yet
		assert.equal(bodies(joined).length, joined.description.vertex_count);
		return joined;
	});
	const all = [...stream.temperature.keys()], tip = stream.tools[0].position;
	const away = (v) => Math.hypot(...stream.position(v).map((x, c) => x - tip[c]));
	const far = all.filter((v) => away(v) > 0.03);
	assert.ok(far.length > 200 && far.every((v) => celsius(stream, v) === 37));
	const hottest = Math.max(...all.map((v) => celsius(stream, v)));
	assert.ok(hottest > 100 && hottest <= 170, `${hottest} degC`); // the hook's
	const late = await other.join(session, params);
	await other.until(() => late.tick === stream.tick, 'the last frame');
	assert.deepEqual(late.temperature, stream.temperature);
	const { epoch } = stream;
	await client.call('session.rewind', { session, tick: 0 });
	await client.until(() => stream.epoch !== epoch, 'the state of tick 0');
	assert.equal(bodies(stream).length, all.length);
	await Promise.all([client.close(), other.close()]);
});

test('after leaving no frame comes', async () => {
	const client = await daemon.connect();
	const session = await smallSession(client, 'leave');
	const stream = await client.join(session);
	await client.call('session.leave', { session });
	const { delta } = stream.counts;
	await client.call('session.pause', { session }); // an order of the session later
	assert.equal(stream.counts.delta, delta);
	await client.close();
});

// Falls behind by acknowledging nothing until its next delta is gone, which the other one's stream
// of the same profile shows; four times. Either connection may be read first: what was sent to this
// one is all here when an answer to a later request is.
async function fallBehind(client, stream, other, seen, acknowledge) {
	for (let i = 0; i < 4; i++) {
		acknowledge();
		const { key } = stream.counts;
		for (let shown = 0n; shown <= stream.sequence + 17n;) {
			await other.until(() => seen.sequence > stream.sequence + 17n, 'frames that it misses');
			shown = seen.sequence;
			await client.call('heartbeat', { visible: true });
		}
		acknowledge();
		await client.until(() => stream.counts.key > key, 'a key frame');
	}
}

test('one that keeps falling behind gets every second frame, and holds the same state', async (t) => {
	const own = await Daemon.start({ settings: { subscriber_bytes: 16384 } });
	const other = await own.connect(), client = await own.connect();
	const session = await smallSession(other, 'half');
	const seen = await other.join(session), stream = await client.join(session);
	await other.call('tool.take_over', { session, tool: 'hook' });
	let turn = 0; // motion, so that frames are not small
	const wave = setInterval(() => other.notify('tool.move', {
		session, tool: 'hook', position_m: [0.02 * Math.sin(turn += 0.1), 0, -0.002], rotation: AT_REST,
	}), 16);
	t.after(() => {
		clearInterval(wave);
		return own.end();
	});
	const acknowledge = () => client.notify('stream.ack', {
		session, epoch: stream.epoch.toString(16).padStart(16, '0'), sequence: Number(stream.sequence),
	});
	await fallBehind(client, stream, other, seen, acknowledge);
	await own.log(/session=d1-half event=half_rate/);
	assert.equal(await own.metric('session_subscribers_half_rate', session), 1);
	let twice = 0;
	client.onFrame = (_, kind, data) => {
		const { sequence, base } = header(data);
		twice += kind === 'delta' && sequence === base + 2n;
		acknowledge();
	};
	await client.until(() => twice > 20, 'deltas over two frames');
	await client.call('session.pause', { session });
	const { tick } = await client.call('session.step', { session, ticks: 3 });
	await client.until(() => stream.tick === tick, 'the last frame');
	await compare(client, session, stream);
	assert.equal(stream.counts.skipped + seen.counts.skipped, 0);
	await Promise.all([client.close(), other.close()]);
});
