// SPDX-License-Identifier: GPL-3.0-or-later
// What the door lets pass and what not; the daemon goes on in every case.
import assert from 'node:assert/strict';
import net from 'node:net';
import { after, before, test } from 'node:test';
import { Client, chunk } from './wire/client.mjs';
import { Daemon } from './wire/daemon.mjs';

let daemon;
before(async () => {
	daemon = await Daemon.start({ settings: { hello_timeout_s: process.env.E2E_SLOW === '1' ? 15 : 2 } });
});
after(() => daemon.end());

function request(change = {}) {
	const headers = {
		Host: `127.0.0.1:${daemon?.port}`, Upgrade: 'websocket', Connection: 'Upgrade',
		'Sec-WebSocket-Key': 'dGhlIHNhbXBsZSBub25jZQ==', 'Sec-WebSocket-Version': '13',
		'Sec-WebSocket-Protocol': 'cautery.v1', ...change.headers,
	};
	const lines = Object.entries(headers).filter(([, v]) => v !== null).map(([k, v]) => `${k}: ${v}`);
	return `GET ${change.path ?? '/v1'} HTTP/1.1\r\n${lines.join('\r\n')}\r\n\r\n`;
}

// Sends bytes over a plain socket; `then` may send more once the head of the answer is there.
function raw(text, then) {
	return new Promise((resolve, reject) => {
		const socket = net.connect(daemon.port, '127.0.0.1');
		let answer = Buffer.alloc(0), started = false;
		const finish = () => resolve(answer);
		socket.on('error', reject).on('close', finish);
		socket.on('data', (data) => {
			answer = Buffer.concat([answer, data]);
			const head = answer.indexOf('\r\n\r\n');
			if (head < 0)
				return;
			if (!answer.toString('latin1', 0, 12).includes('101')) {
				const length = /content-length: (\d+)/i.exec(answer.toString('latin1', 0, head));
				if (length && answer.length >= head + 4 + Number(length[1]))
					socket.destroy();
			} else if (answer[head + 4] === 0x88) {
				socket.destroy();
			} else if (!started) {
				started = true;
				then?.(socket);
			}
		});
		socket.write(text);
	});
}

const PHRASES = {
	400: 'Bad Request', 403: 'Forbidden', 404: 'Not Found', 421: 'Misdirected Request', 426: 'Upgrade Required',
};
const status = (answer) => Number(answer.toString('latin1', 9, 12));
const closeCode = (answer) => {
	const frame = answer.subarray(answer.indexOf('\r\n\r\n') + 4);
	assert.equal(frame[0], 0x88, 'a close frame');
	return frame.readUInt16BE(2);
};

async function stillServes() {
	const client = await daemon.connect();
	await client.call('session.list');
	await client.close();
}

for (const [what, change, expected] of [
	['no subprotocol', { headers: { 'Sec-WebSocket-Protocol': null } }, 400],
	['another subprotocol', { headers: { 'Sec-WebSocket-Protocol': 'chat, cautery.v2' } }, 400],
	['an old version', { headers: { 'Sec-WebSocket-Version': '8' } }, 426],
	['no version', { headers: { 'Sec-WebSocket-Version': null } }, 426],
	['a foreign Origin', { headers: { Origin: 'https://evil.example' } }, 403],
	['a null Origin', { headers: { Origin: 'null' } }, 403],
	['a foreign Host', { headers: { Host: 'evil.example' } }, 421],
	['the right Host on another port', { headers: { Host: '127.0.0.1:1' } }, 421],
	['another path', { path: '/v2' }, 404],
	['no key', { headers: { 'Sec-WebSocket-Key': null } }, 400],
	['a key of another length', { headers: { 'Sec-WebSocket-Key': 'c2hvcnQ=' } }, 400],
	['a key that is no base 64', { headers: { 'Sec-WebSocket-Key': '************************' } }, 400],
	['no Connection', { headers: { Connection: null } }, 400],
	['a Connection that keeps alive only', { headers: { Connection: 'keep-alive' } }, 400],
	['more subprotocols than are read', { headers: { 'Sec-WebSocket-Protocol': `${'x'.repeat(200)}, cautery.v1` } }, 400],
])
	test(`the handshake is refused: ${what}`, async () => {
		const answer = await raw(request(change));
		assert.equal(status(answer), expected, answer.toString());
		const [head, body] = answer.toString().split('\r\n\r\n');
		assert.match(head, new RegExp(`^HTTP/1\\.1 ${expected} ${PHRASES[expected]}\r\n`));
		assert.match(head, /\r\nconnection: [a-z, ]*close/i);
		const told = JSON.parse(body);
		assert.equal(told.status, expected);
		for (const member of ['error', 'where', 'reason', 'remedy'])
			assert.match(told[member], /^\w.+$/, `${member} of ${body}`);
		assert.match(head, new RegExp(`\r\ncautery-reason: ${told.reason.replace(/[()?]/g, '\\$&')}(\r\n|$)`));
		if (expected === 426) {
			assert.match(head, /\r\nupgrade: websocket/i);
			assert.match(head, /\r\nsec-websocket-version: 13/i);
		}
		await stillServes();
	});

const BROKEN = {
	'bytes that are no text': ['\x00\x01\x02\r\n\r\n', 400],
	'a method that there is not': ['FETCH / HTTP/1.1\r\n\r\n', 400],
	'an absolute URI': ['GET http://127.0.0.1/ HTTP/1.1\r\nHost: a\r\n\r\n', 400],
	'an absolute URI of a handshake': [request({ path: 'http://127.0.0.1/v1' }), 404],
	'the preface of HTTP/2': ['PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n', 400],
	'an escape that is none': [request({ path: '/%zz' }), 400],
	'CONNECT': ['CONNECT a:1 HTTP/1.1\r\nHost: a\r\n\r\n', 400],
	'no method': ['\r\n\r\n', 400],
	'the hello of TLS': ['\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03', 400],
	'a long header': [request({ headers: { Cookie: 'a'.repeat(20000) } }), 431],
	'a long header that nobody knows': [request({ headers: { 'X-Own': 'a'.repeat(200000) } }), 431],
	'many headers': [request({ headers: Object.fromEntries([...Array(2000).keys()].map((i) => [`X-${i}`, 'y'])) }), 431],
	'a long path': [request({ path: `/${'a'.repeat(8000)}` }), 431],
	'many arguments': [request({ path: `/v1?${'a=1&'.repeat(900)}` }), 431],
};
for (const [what, [text, expected]] of Object.entries(BROKEN))
	test(`what is no request is answered: ${what}`, async () => {
		const answer = await raw(text.replaceAll(':undefined', `:${daemon.port}`));
		const [head, body] = answer.toString().split('\r\n\r\n');
		assert.match(head, new RegExp(`^HTTP/1\\.1 ${expected} [A-Z]`));
		assert.match(head, /\r\nconnection: [a-z, ]*close/i);
		const told = JSON.parse(body);
		assert.equal(told.status, expected);
		assert.ok(head.includes(`cautery-reason: ${told.reason}`) && told.where && told.remedy, head);
		await stillServes();
	});

test('a second request of a connection that is no request is answered, too', async () => {
	const first = `GET /healthz HTTP/1.1\r\nHost: 127.0.0.1:${daemon.port}\r\n\r\n`;
	const socket = net.connect(daemon.port, '127.0.0.1');
	let text = '';
	const ended = new Promise((resolve, reject) => socket.on('error', reject).on('close', resolve));
	socket.on('data', (data) => {
		text += data;
		if (text.endsWith('}\n') && !text.includes(' 431 '))
			socket.write(request({ headers: { Cookie: 'a'.repeat(20000) } }));
	});
	socket.write(first);
	await ended;
	assert.match(text, /^HTTP\/1.1 200 [^]*HTTP\/1.1 431 /);
});

test('before hello every method is answered alike, known or not', async () => {
	const client = new Client(daemon.url());
	await client.opened;
	for (const method of ['session.list', 'session.nothing', 'nothing', 'tool.energize', ''])
		await assert.rejects(client.call(method, {}), { code: -32041 }, method);
	await client.call('hello', { version: 1, client: 'late' });
	await assert.rejects(client.call('session.nothing', {}), { code: -32601 });
	await client.close();
});

for (const [what, change] of [
	['no Origin', {}],
	['the own Origin', () => ({ headers: { Origin: `http://127.0.0.1:${daemon.port}` } })],
	['one of several subprotocols', { headers: { 'Sec-WebSocket-Protocol': 'chat, cautery.v1' } }],
])
	test(`the handshake passes: ${what}`, async () => {
		const made = typeof change === 'function' ? change() : change;
		const answer = await raw(request(made), (socket) => socket.end());
		assert.equal(status(answer), 101, answer.toString());
	});

test('plain HTTP is checked for Host and Origin too', async () => {
	assert.equal((await daemon.get('/api/sessions', { host: 'evil.example' })).status, 421);
	assert.equal((await daemon.get('/api/sessions', { origin: 'https://evil.example' })).status, 403);
	assert.equal((await daemon.get('/v1')).status, 426);
});

test('an unmasked first frame closes the connection with 1002', async () => {
	const hello = Buffer.from('{"jsonrpc":"2.0","id":1,"method":"hello","params":{"version":1,"client":"x"}}');
	const frame = Buffer.concat([Buffer.from([0x81, hello.length]), hello]);
	const answer = await raw(request(), (socket) => socket.write(frame));
	assert.equal(closeCode(answer), 1002);
	await stillServes();
});

test('without hello the connection closes with 4001', async () => {
	const client = new Client(daemon.url());
	await client.opened;
	const { code } = await client.closed;
	assert.equal(code, 4001);
});

test('nothing is served before hello', async () => {
	const client = new Client(daemon.url());
	await client.opened;
	await assert.rejects(client.call('session.list'), { code: -32041 });
	await client.call('hello', { version: 1, client: 'late' });
	await client.call('session.list');
	await client.close();
});

test('a binary message before hello gets hello_required, and too many of them the end', async () => {
	for (const bytes of [Buffer.from('CAUC and more'), Buffer.alloc(0), chunk(1, 0, Buffer.alloc(10))]) {
		const client = new Client(daemon.url());
		await client.opened;
		client.socket.send(bytes);
		const answer = await client.until(() => client.stray, 'an answer');
		assert.equal(answer.id, null);
		assert.equal(answer.error.code, -32041);
		assert.equal(answer.error.data.status, 'hello_required');
		await client.call('hello', { version: 1, client: 'late' });
		await client.close();
	}
	const client = new Client(daemon.url());
	await client.opened;
	for (let i = 0; i < 16; i++)
		client.socket.send(Buffer.from('CAUC'));
	assert.equal((await client.closed).code, 4008);
});

test('bytes that are no HTTP do not disturb', async () => {
	const socket = net.connect(daemon.port, '127.0.0.1');
	const closed = new Promise((resolve) => socket.on('close', resolve).on('error', resolve));
	socket.resume().end(Buffer.from(Array.from({ length: 4000 }, (_, i) => (i * 97 + 13) & 255)));
	await closed;
	await stillServes();
});
