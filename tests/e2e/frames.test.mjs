// SPDX-License-Identifier: GPL-3.0-or-later
// The wire below messages, over plain sockets: frames that break RFC 6455, floods of frames, and
// sockets that their peers do not close.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import net from 'node:net';
import { after, before, test } from 'node:test';
import { Client, PATIENCE_S } from './wire/client.mjs';
import { Daemon } from './wire/daemon.mjs';

let daemon, bystander;
before(async () => {
	daemon = await Daemon.start({ settings: { max_requests_per_s: 300 } });
	bystander = await daemon.connect();
});
after(() => daemon.end());

const handshake = (port) => [
	'GET /v1 HTTP/1.1', `Host: 127.0.0.1:${port}`, 'Upgrade: websocket', 'Connection: Upgrade',
	'Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==', 'Sec-WebSocket-Version: 13', 'Sec-WebSocket-Protocol: cautery.v1', '', '',
].join('\r\n');

// A masked frame; `first` holds the final bit and the opcode.
function frame(first, payload = Buffer.alloc(0)) {
	const mask = Buffer.from([1, 2, 3, 4]);
	const length = payload.length < 126 ? [0x80 | payload.length] : [0xfe, payload.length >> 8, payload.length & 255];
	return Buffer.concat([Buffer.from([first, ...length]), mask, payload.map((byte, i) => byte ^ mask[i % 4])]);
}

const text = (message) => frame(0x81, Buffer.from(JSON.stringify(message)));
const hello = text({ jsonrpc: '2.0', id: 1, method: 'hello', params: { version: 1, client: 'raw' } });

// A WebSocket by hand. It keeps its side open whatever the daemon does; `frames` are those that came.
class Raw {
	constructor(port = daemon.port, first = Buffer.alloc(0)) {
		this.socket = net.connect({ port, host: '127.0.0.1', allowHalfOpen: true });
		this.bytes = Buffer.alloc(0);
		this.frames = [];
		this.waiters = [];
		this.socket.on('data', (data) => this.take(data)).on('end', () => this.mark('ended')).on('error', () => {});
		this.socket.on('close', () => this.mark('gone'));
		this.socket.write(Buffer.concat([Buffer.from(handshake(port)), first]));
	}

	static async open(port) {
		const raw = new Raw(port);
		await raw.until(() => raw.head, 'an answer to the handshake');
		assert.match(raw.head, /^HTTP\/1\.1 101 /);
		return raw;
	}

	take(data) {
		this.bytes = Buffer.concat([this.bytes, data]);
		const end = this.bytes.indexOf('\r\n\r\n');
		if (!this.head && end >= 0) {
			this.head = this.bytes.toString('latin1', 0, end);
			this.bytes = this.bytes.subarray(end + 4);
		}
		for (let whole = Boolean(this.head); whole;)
			whole = this.takeFrame();
		this.check();
	}

	takeFrame() {
		const { bytes } = this;
		if (bytes.length < 2)
			return false;
		const long = (bytes[1] & 127) === 126, start = long ? 4 : 2;
		if (bytes.length < start)
			return false;
		const length = long ? bytes.readUInt16BE(2) : bytes[1] & 127;
		if (bytes.length < start + length)
			return false;
		this.frames.push({ first: bytes[0], payload: bytes.subarray(start, start + length) });
		this.bytes = bytes.subarray(start + length);
		return true;
	}

	mark(what) {
		this[what] = true;
		this.check();
	}

	check() {
		this.waiters = this.waiters.filter(({ condition, resolve }) => !condition() || resolve());
	}

	until(condition, what) {
		return new Promise((resolve, reject) => {
			const timer = setTimeout(() => reject(new Error(`did not happen: ${what}`)), PATIENCE_S * 1000);
			this.waiters.push({ condition, resolve: () => (clearTimeout(timer), resolve()) });
			this.check();
		});
	}

	// The close frame's code, once the daemon has shut its side behind it.
	async closeCode() {
		await this.until(() => this.ended || this.gone, 'the end');
		const last = this.frames.at(-1);
		assert.equal(last?.first, 0x88, `a close frame at the end, not ${last?.first}`);
		return last.payload.readUInt16BE(0);
	}
}

async function stillServes() {
	await bystander.call('session.list');
}

for (const [what, bytes, code] of [
	['the first reserved bit', frame(0xc1, Buffer.from('x')), 1002],
	['the second reserved bit', frame(0xa1, Buffer.from('x')), 1002],
	['the third reserved bit', frame(0x91, Buffer.from('x')), 1002],
	['an unknown opcode of data', frame(0x83), 1002],
	['an unknown opcode of control', frame(0x8b), 1002],
	['a ping in fragments', frame(0x09), 1002],
	['a ping of 126 bytes', frame(0x89, Buffer.alloc(126)), 1002],
	['a continuation of nothing', frame(0x80, Buffer.from('x')), 1002],
	['a message within another', Buffer.concat([frame(0x01, Buffer.from('a')), frame(0x81, Buffer.from('b'))]), 1002],
	['an unmasked first frame', Buffer.from([0x81, 0x01, 0x78]), 1002],
	['an unmasked later frame', Buffer.concat([hello, Buffer.from([0x81, 0x01, 0x78])]), 1002],
	['a length in more bytes than it needs', Buffer.from([0x82, 0xfe, 0, 5]), 1002],
	['a close frame with half a code', frame(0x88, Buffer.from([3])), 1002],
	['a close code that may not be sent', frame(0x88, Buffer.from([3, 0xed])), 1002],
	['a close reason that is no UTF-8', frame(0x88, Buffer.from([3, 0xe8, 0xff])), 1007],
	['a text that is no UTF-8', frame(0x81, Buffer.from([0xff])), 1007],
	['a text that ends within a character', frame(0x81, Buffer.from([0xe2, 0x82])), 1007],
	['a frame that announces 2^40 bytes', Buffer.from([0x82, 0xff, 0, 0, 1, 0, 0, 0, 0, 0]), 1009],
	['a binary message that is no chunk', Buffer.concat([hello, frame(0x82, Buffer.alloc(100))]), 1003],
])
	// Half a frame is for libwebsockets to wait for, while it still reads.
	for (const early of what.startsWith('a length') || what.startsWith('a frame') ? [false] : [false, true])
		test(`${what}${early ? ', sent right behind the request,' : ''} is told with a close code`, async () => {
			const raw = early ? new Raw(daemon.port, bytes) : await Raw.open();
			if (!early)
				raw.socket.write(bytes);
			// What comes before the answer to the handshake breaks the protocol by that alone.
			assert.equal(await raw.closeCode(), early ? 1002 : code);
			raw.socket.destroy();
			await stillServes();
		});

test('a close frame is answered with its code, and the socket closed', async () => {
	for (const [payload, code] of [[Buffer.from([3, 0xe8]), 1000], [Buffer.from([0x0f, 0xa0, 0x62]), 4000], [Buffer.alloc(0), 1000]]) {
		const raw = await Raw.open();
		raw.socket.write(frame(0x88, payload));
		assert.equal(await raw.closeCode(), code);
		raw.socket.destroy();
	}
});

test('pings are answered, also in the middle of a message', async () => {
	const raw = await Raw.open();
	raw.socket.write(Buffer.concat([frame(0x01, Buffer.from('{"jsonrpc":')), frame(0x89, Buffer.from('ping'))]));
	await raw.until(() => raw.frames.some((f) => f.first === 0x8a && f.payload.toString() === 'ping'), 'a pong');
	raw.socket.write(frame(0x80, Buffer.from('"2.0","id":1,"method":"hello","params":{"version":1,"client":"x"}}')));
	await raw.until(() => raw.frames.some((f) => f.first === 0x81 && f.payload.includes('"result"')), 'the answer');
	raw.socket.destroy();
});

test('one that asks and shuts its side gets its answer, then the end', async () => {
	const raw = await Raw.open();
	raw.socket.end(hello);
	assert.equal(await raw.closeCode(), 1000);
	assert.ok(raw.frames.some((f) => f.first === 0x81 && f.payload.includes('"result"')));
});

for (const [what, flood] of [
	['empty continuation frames', [frame(0x01), ...Array(5000).fill(frame(0x00))]],
	['fragments of a few bytes', [frame(0x01), ...Array(5000).fill(frame(0x00, Buffer.from('  ')))]],
	['empty messages of two frames', Array(2500).fill([frame(0x01), frame(0x80)]).flat()],
	['pings', Array(5000).fill(frame(0x89))],
	['pongs that nobody asked for', Array(5000).fill(frame(0x8a))],
])
	test(`a flood of ${what} ends the connection`, async () => {
		const raw = await Raw.open();
		raw.socket.write(hello);
		await raw.until(() => raw.frames.length > 0, 'the answer to hello');
		raw.socket.write(Buffer.concat(flood));
		assert.equal(await raw.closeCode(), what.startsWith('empty messages') ? 4008 : 4005);
		raw.socket.destroy();
		await stillServes();
	});

test('a message in fragments of their own weight is no flood', async () => {
	const raw = await Raw.open();
	const spaces = Buffer.alloc(1024, ' ');
	raw.socket.write(hello); // after hello a client has a larger share of the processor
	await raw.until(() => raw.frames.length > 0, 'the answer to hello');
	raw.socket.write(frame(0x01, Buffer.from('{"jsonrpc":"2.0","id":2,"method":"session.list",')));
	for (let i = 0; i < 900; i++)
		raw.socket.write(frame(0x00, spaces));
	raw.socket.write(frame(0x80, Buffer.from('"params":{}}')));
	await raw.until(() => raw.frames.length > 1, 'the answer');
	assert.match(raw.frames[1].payload.toString(), /"id":2,"result"/);
	raw.socket.destroy();
});

// Sockets of the daemon that the kernel still knows, by their state: 01 is open, 08 waits for the daemon
// to close, others are on their way.
function sockets(port) {
	const local = `:${port.toString(16).toUpperCase().padStart(4, '0')}`;
	const lines = readFileSync('/proc/net/tcp', 'utf8').split('\n').slice(1).map((line) => line.trim().split(/\s+/));
	return lines.filter(([, address, , state]) => address?.endsWith(local) && !['0A', '06'].includes(state)).length;
}

async function untilSockets(port, most) {
	const until = performance.now() + PATIENCE_S * 1000;
	while (sockets(port) > most) {
		assert.ok(performance.now() < until, `${sockets(port)} sockets are left, more than ${most}`);
		await new Promise((resolve) => setTimeout(resolve, 20)); // the kernel tells nobody that a socket went
	}
}

test('a peer that does not close its side, or still sends, or reads nothing, holds no socket', async (t) => {
	const own = await Daemon.start();
	t.after(() => own.end());
	await untilSockets(own.port, 0);
	const silent = await Raw.open(own.port), loud = await Raw.open(own.port), deaf = await Raw.open(own.port);
	const started = performance.now();
	silent.socket.write(frame(0x83));
	assert.equal(await silent.closeCode(), 1002);
	deaf.socket.pause();
	deaf.socket.write(frame(0x83));
	const noise = setInterval(() => loud.socket.write(frame(0x82, Buffer.alloc(1000))), 5);
	t.after(() => clearInterval(noise));
	loud.socket.write(frame(0x83));
	assert.equal(await loud.closeCode(), 1002);
	await untilSockets(own.port, 0);
	const seconds = (performance.now() - started) / 1000;
	assert.ok(seconds < 4 || process.env.E2E_SLOW === '1', `${seconds} s`); // two, and a loaded machine
	for (const raw of [silent, loud, deaf])
		raw.socket.destroy();
});

test('one that goes without a word, or resets, leaves no socket', async (t) => {
	const own = await Daemon.start();
	t.after(() => own.end());
	await untilSockets(own.port, 0);
	const [half, gone, reset] = [await Raw.open(own.port), await Raw.open(own.port), await Raw.open(own.port)];
	half.socket.end();
	gone.socket.destroy();
	reset.socket.resetAndDestroy();
	await untilSockets(own.port, 0);
	half.socket.destroy();
});

test('of many that do not close their side few linger', async (t) => {
	const own = await Daemon.start();
	t.after(() => own.end());
	await untilSockets(own.port, 0);
	const many = await Promise.all(Array.from({ length: 120 }, () => Raw.open(own.port)));
	for (const raw of many)
		raw.socket.write(frame(0x83));
	await Promise.all(many.map((raw) => raw.until(() => raw.ended || raw.gone, 'the end')));
	const lingering = sockets(own.port);
	assert.ok(lingering <= 64, `${lingering} linger`);
	await untilSockets(own.port, 0);
	for (const raw of many)
		raw.socket.destroy();
});

test('beyond max_connections a connection is closed with 1013, and one that ends makes room', async (t) => {
	const own = await Daemon.start({ settings: { max_connections: 2 } });
	t.after(() => own.end());
	const first = await own.connect(), second = await own.connect();
	for (let i = 0; i < 3; i++) {
		const beyond = new Client(own.url());
		const { code, reason } = await beyond.closed;
		assert.equal(code, 1013);
		assert.match(reason, /setting max_connections/);
	}
	await first.call('session.list');
	await second.close();
	const third = await own.connect();
	await third.call('session.list');
	await Promise.all([first.close(), third.close()]);
});

test('a connection that answers no ping is closed with 4006', async (t) => {
	const own = await Daemon.start({ settings: { ping_s: 1, hello_timeout_s: 60 } });
	t.after(() => own.end());
	const raw = await Raw.open(own.port);
	assert.equal(await raw.closeCode(), 4006);
	assert.ok(raw.frames.some((f) => f.first === 0x89), 'a ping before');
	raw.socket.destroy();
});
