// SPDX-License-Identifier: GPL-3.0-or-later
// Messages that are wrong: each gets a clear answer, and the daemon and other clients go on.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, beforeEach, afterEach, test } from 'node:test';
import { Client, chunk } from './wire/client.mjs';
import { Daemon } from './wire/daemon.mjs';
import { smallSession } from './wire/scene.mjs';

const asyncapi = JSON.parse(readFileSync(process.env.ASYNCAPI));

let daemon, bystander, stream, client, session;
before(async () => {
	// Messages as many as any build reads in a second; no allowance for creations, which are tried by dozens.
	const allowances = ['connection', 'address', 'admin', 'all'].map((whose) => [`quota_${whose}`, 1000000]);
	daemon = await Daemon.start({ settings: { max_requests_per_s: 200, ...Object.fromEntries(allowances) } });
	bystander = await daemon.connect();
	session = await smallSession(bystander, 'watched');
	stream = await bystander.join(session);
});
after(() => daemon.end());
beforeEach(async () => {
	client = await daemon.connect();
});
afterEach(async () => {
	client.terminate();
	const tick = stream.tick;
	await bystander.until(() => stream.tick > tick + 2, 'frames for the bystander');
	assert.equal(stream.counts.skipped, 0);
});

// Sends text as it is and gives the next answer that belongs to no call.
function answerTo(text) {
	client.stray = null;
	client.send(text);
	return client.until(() => client.stray, `an answer to ${text.slice(0, 80)}`);
}

const list = (params, id = '7') => `{"jsonrpc":"2.0","id":${id},"method":"session.list","params":${params}}`;

// What cJSON lets pass, and more.
for (const [what, text] of [
	['trailing garbage', `${list('{}')} x`],
	['a second value', `${list('{}')}{}`],
	['a number beyond a double', list('{"a":1e999}')],
	['a leading zero', list('{"a":01}')],
	['a bare point', list('{"a":1.}')],
	['a raw tab in a string', list('{"a":"\t"}')],
	['a repeated key', '{"jsonrpc":"2.0","id":1,"id":2,"method":"session.list"}'],
	['a zero in a string', list('{"a":"x\\u0000y"}')],
	['a lone surrogate', list('{"a":"\\ud800"}')],
	['a whole number beyond 2^53', list('{"a":9007199254740993}')],
	['a comment', '/* */{}'],
	['NaN', list('{"a":NaN}')],
	['an empty message', ''],
	['half a message', '{"jsonrpc":'],
	['1,000 levels of nesting', '['.repeat(1000) + ']'.repeat(1000)],
	['1,000 levels of objects', '{"a":'.repeat(1000) + '1' + '}'.repeat(1000)],
])
	test(`malformed JSON: ${what}`, async () => {
		const answer = await answerTo(text);
		assert.equal(answer.error.code, -32700, JSON.stringify(answer));
		assert.equal(answer.id, null);
		await client.call('session.list');
	});

test('members are told apart by case', async () => {
	const answer = await answerTo('{"jsonrpc":"2.0","ID":7,"METHOD":"session.list"}');
	assert.equal(answer.error.code, -32600);
});

for (const [what, text] of [
	['a batch', `[${list('{}')}]`],
	['an id of null', list('{}', 'null')],
	['a fractional id', list('{}', '1.5')],
	['an unknown member', '{"jsonrpc":"2.0","id":7,"method":"session.list","extra":1}'],
	['params that are a number', list('5')],
	['params that are null', list('null')],
	['no version', '{"id":7,"method":"session.list"}'],
])
	test(`not a request: ${what}`, async () => {
		assert.equal((await answerTo(text)).error.code, -32600);
	});

test('params by position', async () => {
	assert.equal((await answerTo(list('[1]'))).error.code, -32602);
});

test('an unknown method', () => assert.rejects(client.call('session.eat'), { code: -32601 }));

test('a wrong type names the member', () =>
	assert.rejects(client.call('session.speed', { session, speed: 'fast' }), (error) =>
		error.code === -32602 && error.data.path === 'params.speed'));

test('a value out of its range names the member', () =>
	assert.rejects(client.call('tool.move', {
		session, tool: 'hook', position_m: [0, 0, 1e9], rotation: [1, 0, 0, 0],
	}), (error) => error.code === -32602 && error.data.path.startsWith('params.position_m')));

test('a rotation that is none names the member', () =>
	assert.rejects(client.call('tool.move', {
		session, tool: 'hook', position_m: [0, 0, 0], rotation: [2, 0, 0, 0],
	}), (error) => error.code === -32602 && error.data.path.startsWith('params.rotation')));

// ---- unknown members ---------------------------------------------------------------------------
const STRANGER = 'zz_stranger';

// What clients may send, by the generated page: the method and whether it may be a request.
const methods = Object.values(asyncapi.operations).filter((o) => o.action === 'receive').map((o) => {
	const name = o.messages[0].$ref.split('/').at(-1);
	const { payload } = asyncapi.components.messages[name];
	return { method: payload.properties.method?.const, answered: Boolean(payload.properties.id) };
}).filter((m) => m.method);

// Which members there are hangs on what is read before them.
const kinds = { 'material.set': { kind: 'fascia' } };

test('an unknown member is refused by every method', async () => {
	assert.ok(methods.length > 40, `${methods.length} methods`);
	const within = await daemon.connect({ session }); // so that no method misses its session
	for (const { method, answered } of methods.filter((m) => m.answered && m.method !== 'hello'))
		await assert.rejects(within.call(method, { ...kinds[method], [STRANGER]: 1 }), (error) =>
			error.code === -32602 && error.data.path === `params.${STRANGER}`, `${method} took it`);
	await within.close();
	const { stray } = await greetWith({ version: 1, client: 'x', [STRANGER]: 1 });
	assert.equal(stray.error.code, -32602);
	assert.equal(stray.error.data.path, `params.${STRANGER}`);
});

// A connection that says this hello; resolves once it was answered.
async function greetWith(params) {
	const stranger = new Client(daemon.url());
	await stranger.opened;
	stranger.send({ jsonrpc: '2.0', id: 'h', method: 'hello', params });
	await stranger.until(() => stranger.stray, 'an answer to hello');
	stranger.terminate();
	return stranger;
}

test('a notification with an unknown member does nothing, and the log says so', async () => {
	const own = await daemon.connect();
	const watched = await own.join(session);
	const applied = () => watched.tools[0].sequence;
	const move = { session, tool: 'hook', position_m: [0, 0, 0.05], rotation: [1, 0, 0, 0] };
	own.notify('tool.move', { ...move, sequence: 900, [STRANGER]: 1 });
	await own.call('session.list');
	const { tick } = watched;
	await own.until(() => watched.tick > tick + 3, 'frames after it');
	assert.notEqual(Number(applied()), 900);
	const refused = (line) => line.includes('event=notification_refused') && line.includes(`path=params.${STRANGER}`);
	await daemon.log(new RegExp(`notification_refused .*method=tool.move path=params.${STRANGER}`));
	own.notify('tool.move', { ...move, [STRANGER]: 1 });
	await own.call('session.list');
	assert.equal(daemon.lines.filter(refused).length, 1, 'one line a connection');
	await own.close();
});

test('who has said no hello writes nothing to the log by notifications', async () => {
	const stranger = new Client(daemon.url());
	await stranger.opened;
	const lines = () => daemon.lines.filter((line) => line.includes('event=notification_refused')).length;
	const before = lines();
	stranger.send({ jsonrpc: '2.0', method: 'heartbeat', params: {} });
	stranger.send({ jsonrpc: '2.0', method: 'unheard.of', params: {} });
	stranger.send({ jsonrpc: '2.0', id: 'h', method: 'hello', params: { version: 1, client: 'x' } });
	await stranger.until(() => stranger.stray, 'an answer to hello');
	assert.equal(lines(), before);
	stranger.send({ jsonrpc: '2.0', method: 'unheard.of', params: {} });
	await daemon.log(/notification_refused .*name="x" method=none/);
	stranger.terminate();
});

test('a notification gets no answer, whatever the method', async () => {
	const own = await daemon.connect();
	const stray = [];
	own.onText = (onText => (text) => (stray.push(JSON.parse(text)), onText.call(own, text)))(own.onText);
	own.notify('scene.get', { scene: 'fascia' });
	own.notify('scene.list', {});
	own.notify('scene.get', { scene: 'none' });
	await own.call('session.list');
	assert.deepEqual(stray.filter((message) => !message.method).length, 1, 'the answer to session.list alone');
	await own.close();
});

// Every object of a value, as a function that puts the stranger there and one that takes it out.
function* objectsOf(value, path = '') {
	if (!value || typeof value !== 'object')
		return;
	if (!Array.isArray(value))
		yield { path: `${path}.${STRANGER}`, object: value };
	for (const [key, inner] of Object.entries(value))
		yield* objectsOf(inner, Array.isArray(value) ? `${path}[${key}]` : `${path}.${key}`);
}

test('an unknown member is refused in every object of a definition', async () => {
	const { scenes } = await client.call('scene.list');
	let objects = 0;
	for (const { name } of scenes) {
		const { definition } = await client.call('scene.get', { scene: name });
		for (const { path, object } of objectsOf(definition)) {
			object[STRANGER] = 1;
			await assert.rejects(client.call('session.create', { definition }), (error) =>
				error.code === -32602 && error.data.path === `params.definition${path}`, `${name}${path} was taken`);
			delete object[STRANGER];
			objects++;
		}
	}
	assert.ok(objects > 30, `${objects} objects`);
});

test('an unknown member is refused in a command\'s objects', async () => {
	const selection = { kind: 'vertices', vertices: [1] };
	for (const [method, params] of [
		['pin', { session, selection: { kind: 'sphere', center_m: [0, 0, 0], radius_m: 0.001, [STRANGER]: 1 } }],
		['unpin', { session, selection: { ...selection, [STRANGER]: 1 } }],
		['force.set', { session, force_n: [0, 0, 0], selection: { ...selection, [STRANGER]: 1 } }],
	])
		await assert.rejects(client.call(method, params), (error) =>
			error.code === -32602 && error.data.path.startsWith('params.'), method);
});

test('a session that is not here', () =>
	assert.rejects(client.call('session.describe', { session: 'd1-nowhere' }), { code: -32040 }));

test('a message of 64 MB closes with 1009', async () => {
	client.socket.send('x'.repeat(64 << 20), () => {});
	assert.equal((await client.closed).code, 1009);
});

test('text that is not UTF-8 closes with 1007', async () => {
	client.socket.send(Buffer.from([0x22, 0xff, 0xfe, 0x22]), { binary: false });
	assert.equal((await client.closed).code, 1007);
});

test('binary garbage closes with 1003', async () => {
	client.socket.send(Buffer.from(Array.from({ length: 500 }, (_, i) => (i * 31 + 7) & 255)));
	assert.equal((await client.closed).code, 1003);
});

test('garbage without end closes with 4008', async () => {
	for (let i = 0; i < 40; i++)
		client.send('{');
	assert.equal((await client.closed).code, 4008);
});

test('too many messages a second close with 4005', async () => {
	for (let i = 0; i < 6000; i++)
		client.notify('heartbeat', { visible: true });
	assert.equal((await client.closed).code, 4005);
});

// ---- uploads that lie --------------------------------------------------------------------------
const begin = (bytes) =>
	client.call('upload.begin', { name: 'mesh', file_name: 'mesh.obj', byte_count: bytes });
const end = (transfer, sha256 = '0'.repeat(64)) => client.call('upload.end', { transfer, sha256 });

test('an upload beyond the limit', () =>
	assert.rejects(begin(1e12), { code: -32007 }));

test('an upload shorter than announced', async () => {
	const { transfer } = await begin(100);
	client.socket.send(chunk(transfer, 0, Buffer.alloc(60)));
	await assert.rejects(end(transfer), (error) => error.code === -32602 && /60 bytes/.test(error.data.reason));
});

test('an upload longer than announced', async () => {
	const { transfer } = await begin(100);
	client.socket.send(chunk(transfer, 0, Buffer.alloc(101)));
	await assert.rejects(end(transfer), (error) => /more bytes/.test(error.data.reason));
});

test('a chunk at another offset', async () => {
	const { transfer } = await begin(100);
	client.socket.send(chunk(transfer, 50, Buffer.alloc(50)));
	await assert.rejects(end(transfer), (error) => /out of order/.test(error.data.reason));
});

test('an upload with another hash', async () => {
	const { transfer } = await begin(10);
	client.socket.send(chunk(transfer, 0, Buffer.alloc(10)));
	await assert.rejects(end(transfer), (error) => error.data.path === 'params.sha256');
});

test('a mesh that is no mesh', async () => {
	await client.upload('rubbish', 'rubbish.obj', Buffer.from('v 0 0 zero\nf 1 2 3\n'));
	const { definition } = await client.call('scene.get', { scene: 'fascia' });
	definition.meshes[0] = { name: definition.meshes[0].name, source: 'bytes', file: 'rubbish.obj' };
	delete definition.cut;
	await assert.rejects(client.call('session.create', { definition }));
});
