// SPDX-License-Identifier: GPL-3.0-or-later
// Methods that state a level are idempotent on the wire: said again, with a fresh sequence, they change
// no bit of the tissue. Every method of the protocol that changes something is in one of two tables.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';
import { AT_REST, smallScene } from './wire/scene.mjs';

const EVERYTHING = { kind: 'box', least_m: [-1, -1, -1], most_m: [1, 1, 1] };
const CORNER = { kind: 'box', least_m: [-1, -1, -1], most_m: [-0.01, 1, 1] };
const grip = { tool: 'grip' };

// With what each is said. The session is paused, and is stepped between.
const LEVELS = {
	'tool.configure': { ...grip, shape: 'bipolar', temperature_c: 120 },
	'tool.move': { ...grip, position_m: [0.002, 0, -0.002], rotation: AT_REST, jaw: 0.4 },
	'tool.energize': { ...grip, energized: true },
	'tool.grasp': grip,
	'tool.release': grip,
	'tool.take_over': grip,
	'pin': { selection: CORNER },
	'unpin': { selection: CORNER },
	'material.set': { layer: 'fascia', kind: 'fascia', thickness_m: 0.001 },
	'gravity.set': { gravity_m_s2: [1, 0, -9.81] },
	'force.set': { selection: EVERYTHING, force_n: [0, 0, 1e-3] },
	'session.pause': {},
	'session.speed': { speed: 2 },
};

// These make, take away or go somewhere, once; with the word for why they are no levels.
const ONCE = {
	'session.create': 'makes', 'session.fork': 'makes', 'session.snapshot': 'makes', 'tool.add': 'makes',
	'session.destroy': 'takes away', 'tool.remove': 'takes away', 'tool.hand_over': 'takes away',
	'session.step': 'goes on', 'session.resume': 'goes on by the clock', 'session.reset': 'goes', 'session.restore': 'goes', 'session.rewind': 'goes',
	'tool.hold': 'where the tool is now', 'tool.request_takeover': 'asks its driver',
};

let daemon, client;
before(async () => {
	daemon = await Daemon.start();
	client = await daemon.connect();
});
after(() => daemon.end());

test('each method that changes something is in one of the tables', () => {
	const { components } = JSON.parse(readFileSync(process.env.ASYNCAPI));
	const named = (reference) => components.schemas[reference.split('/').at(-1)];
	const changing = Object.values(components.messages).filter(({ payload }) => {
		const params = payload?.properties?.params?.$ref && named(payload.properties.params.$ref);
		const one = params?.oneOf ? named(params.oneOf[0].$ref) : params; // of a kind of material
		return one?.properties?.client_sequence;
	}).map(({ payload }) => payload.properties.method.const);
	assert.ok(changing.length > 20, `${changing}`);
	assert.deepEqual([...new Set(changing)].sort(), [...Object.keys(LEVELS), ...Object.keys(ONCE)].sort());
});

let made = 0;

// The hash at the end of a run in which the method is said at the given ticks.
async function run(method, params, said) {
	const definition = await smallScene(client, [8, 6]);
	Object.assign(definition.tools[0], { name: 'grip', shape: 'bipolar', position_m: [0, 0, -0.001], rotation: AT_REST });
	const { summary: { session } } = await client.call('session.create', { name: `level-${made++}`, definition, paused: true });
	await client.call('tool.take_over', { session, ...grip });
	let sequence = 10;
	for (let tick = 0; tick < 12; tick++) {
		if (tick === 1 && method === 'tool.release')
			await client.call('tool.grasp', { session, ...grip, sequence: 1 });
		for (let i = 0; i < (said[tick] ?? 0); i++)
			await client.call(method, { session, ...params, ...(method.match(/^tool\.(?!take)|^pin|^unpin|\.set$/) && { sequence: sequence++ }) });
		await client.call('session.step', { session, ticks: 1 });
	}
	const { hash } = await client.call('session.snapshot', { session, name: 'end' });
	await client.call('session.destroy', { session });
	return hash;
}

for (const [method, params] of Object.entries(LEVELS))
	test(`${method} said again changes nothing`, async () => {
		const once = await run(method, params, { 3: 1 });
		assert.equal(await run(method, params, { 3: 2 }), once, 'at the same tick');
		assert.equal(await run(method, params, { 3: 1, 4: 1, 9: 2 }), once, 'later');
	});
