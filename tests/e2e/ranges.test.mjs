// SPDX-License-Identifier: GPL-3.0-or-later
// The ranges of protocol/asyncapi.json are those that the daemon enforces: each end of each number is
// accepted, and the next number beyond it is refused. Ranges inside a scene are tested in
// core/session/ranges_test.c.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';
import { AT_REST, smallSession } from './wire/scene.mjs';

const { components: { messages, schemas } } = JSON.parse(readFileSync(process.env.ASYNCAPI));

let daemon, client;
before(async () => {
	const allowances = ['connection', 'address', 'admin', 'all'].map((whose) => [`quota_${whose}`, 1000000]);
	daemon = await Daemon.start({ settings: {
		max_sessions: 100, max_requests_per_s: 100000, ...Object.fromEntries(allowances),
	} });
	client = await daemon.connect();
});
after(() => daemon.end());

// ---- the table
function rangesOf(schema) {
	return Object.entries(schema.properties ?? {}).flatMap(([name, property]) => {
		const of = property.type === 'array' ? property.items : property;
		return of?.minimum === undefined ? [] : [{ name, property, ...of }];
	});
}

const requests = Object.values(messages).filter(({ payload }) => payload.properties?.method && payload.properties.id)
	.flatMap(({ name, payload }) => {
		const schema = schemas[payload.properties.params.$ref.split('/').at(-1)];
		return (schema.oneOf ?? [schema]).map((one) => {
			const whole = one.$ref ? schemas[one.$ref.split('/').at(-1)] : one;
			return { method: name, schema: whole, ranges: rangesOf(whole) };
		});
	}).filter(({ ranges }) => ranges.length > 0);

function nextAfter(value, sign, type) {
	if (type === 'integer')
		return value + sign;
	if (value === 0)
		return sign * Number.MIN_VALUE;
	const view = new DataView(new ArrayBuffer(8));
	view.setFloat64(0, value);
	view.setBigInt64(0, view.getBigInt64(0) + (Math.sign(value) === sign ? 1n : -1n));
	return view.getFloat64(0);
}

// ---- a request in which all else is as it should be
const KNOWN = {
	tool: 'hook', name: 'another', scene: 'fascia', rotation: AT_REST, layer: 'fascia', ticks: 1, version: 1,
	selection: { kind: 'sphere', center_m: [0, 0, 0], radius_m: 0.01 },
};

function filler(name, property) {
	if (name in KNOWN)
		return KNOWN[name];
	if (property.const !== undefined || property.enum)
		return property.const ?? property.enum[0];
	if (property.type === 'array')
		return Array.from({ length: property.minItems }, () => filler('', property.items));
	if (property.type === 'string')
		return 'x';
	return property.type === 'boolean' ? false : Math.max(0, property.minimum);
}

function base(schema, session) {
	const params = Object.fromEntries([...(schema.required ?? []), ...(schema.anyOf?.[0].required ?? [])].map((name) => [name, filler(name, schema.properties[name])]));
	return schema.properties.session ? { ...params, session } : params;
}

// Rules that bind two numbers are documented in words; this value of the other one lets both ends in.
const WITH = {
	hot_radius_m: { grid_step_m: 5e-5, diffusivity_m2_s: 1e-8 },
	grid_step_m: { hot_radius_m: 0.05, diffusivity_m2_s: 1e-8 },
	diffusivity_m2_s: { hot_radius_m: 0.05, grid_step_m: 0.01 },
};
// Rules in words shut ends out: a quaternion's length is 1, a target is positive definite, a tick is of the past,
// a region is one of the layer's mesh.
const IN_WORDS = ['rotation', 'target'];
const OF_THE_PAST = ['session.fork', 'session.rewind', 'session.frame_at'];
const isShutOut = ({ method }, { name }, end) =>
	IN_WORDS.includes(name) || (name === 'region' && end > 0) || (OF_THE_PAST.includes(method) && name === 'tick' && end > 0);

function withValue(params, { name, property }, value) {
	if (property.type !== 'array')
		return [{ ...params, ...WITH[name], [name]: value }];
	const plain = params[name] ?? filler(name, property);
	return plain.map((_, i) => ({ ...params, ...WITH[name], [name]: plain.with(i, value) }));
}

// ---- what the daemon makes of it
// The path of a refusal for a value, '' of any other answer. A command that waits for its tick is accepted.
// A whole number beyond 2^53 - 1 is no JSON of this protocol, and refused before any table is read.
async function refusal(one, method, params, name) {
	if (Math.abs(params[name]) > Number.MAX_SAFE_INTEGER) {
		one.call(method, params).catch(() => {}); // which ends when the connection does
		await one.until(() => one.stray, `an answer to ${method}`);
		return one.stray.error.code === -32700 ? name : '';
	}
	let path;
	one.call(method, params).then(() => (path = ''), ({ code, data }) => {
		path = code === -32602 || data?.status === 'bad_value' ? data.path : '';
	}).then(() => one.check());
	if (params.tick > 0)
		while (path === undefined && (await one.call('session.waiting', { session: params.session })).commands.length === 0);
	else
		await one.until(() => path !== undefined, `an answer to ${method}`);
	return path ?? '';
}

// A session serves until a request was not refused for a value: such a refusal changes nothing.
let made = 0, untouched = null;
async function attempt(request, range, value) {
	const session = untouched ?? await smallSession(client, `ranges-${++made}`, { cells: [3, 3], paused: true });
	const paths = [];
	for (const params of withValue(base(request.schema, session), range, value)) {
		const one = await daemon.connect(); // a client id of its own, and so a client_sequence
		paths.push(await refusal(one, request.method, params, range.name));
		await one.close();
	}
	untouched = paths.every(Boolean) ? session : null;
	if (!untouched && request.method !== 'session.destroy')
		await client.call('session.destroy', { session });
	return paths;
}

async function faultsOf(request, range) {
	const named = new RegExp(`(^|\\.)${range.name}\\b`);
	const faults = [];
	for (const [end, sign] of [[range.minimum, -1], [range.maximum, 1]]) {
		if (!isShutOut(request, range, end) && (await attempt(request, range, end)).some((path) => named.test(path)))
			faults.push(`${range.name} = ${end} is documented and refused`);
		const beyond = nextAfter(end, sign, range.type);
		if (!(await attempt(request, range, beyond)).every((path) => named.test(path)))
			faults.push(`${range.name} = ${beyond} is beyond ${end} and not refused`);
	}
	return faults;
}

for (const request of requests)
	test(`${request.method}: ${request.ranges.map(({ name }) => name).join(' ')}`, async () => {
		const faults = [];
		for (const range of request.ranges)
			faults.push(...await faultsOf(request, range));
		assert.deepEqual(faults, []);
	});
