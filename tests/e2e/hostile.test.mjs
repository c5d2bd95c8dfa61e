// SPDX-License-Identifier: GPL-3.0-or-later
// Messages that are wrong: each gets a clear answer, and the daemon and other clients go on.
import assert from 'node:assert/strict';
import { after, before, beforeEach, afterEach, test } from 'node:test';
import { chunk } from './wire/client.mjs';
import { Daemon } from './wire/daemon.mjs';
import { smallSession } from './wire/scene.mjs';

let daemon, bystander, stream, client, session;
before(async () => {
	daemon = await Daemon.start({ settings: { max_requests_per_s: 200 } }); // which any build reads in a second
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

test('an unknown member is refused', () =>
	assert.rejects(client.call('session.describe', { session, verbose: true }), { code: -32602 }));

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
