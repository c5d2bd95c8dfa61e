// SPDX-License-Identifier: GPL-3.0-or-later
// A client of the wire over Node's `ws`.
import WebSocket from 'ws';
import { createHash } from 'node:crypto';
import { Decoder, header } from './decoder.mjs';

// Far beyond what any step needs; only failing tests reach it.
export const PATIENCE_S = process.env.E2E_SLOW === '1' ? 200 : 20;

// Methods that a file in chunks follows.
const FILES = ['move.read', 'session.export', 'session.frame_at', 'session.log'];

export class RpcError extends Error {
	constructor(error) {
		super(`${error.code} ${error.data?.status} ${error.data?.path ?? ''}: ${error.data?.reason}`);
		this.code = error.code;
		this.data = error.data ?? {};
	}
}

export class Client {
	constructor(url, options = {}) {
		this.socket = new WebSocket(url, options.protocols ?? ['cautery.v1'], {
			perMessageDeflate: false, ...options.socket,
		});
		this.socket.binaryType = 'nodebuffer';
		this.calls = new Map();
		this.nextId = 1;
		this.streams = new Map(); // by session_number
		this.transfers = new Map();
		this.notices = [];
		this.waiters = [];
		this.closed = new Promise((resolve) => {
			this.socket.on('close', (code, reason) => {
				this.closeCode = code;
				for (const call of this.calls.values())
					call.reject(new Error(`closed ${code} ${reason}`));
				this.calls.clear();
				this.check();
				resolve({ code, reason: reason.toString() });
			});
		});
		this.opened = new Promise((resolve, reject) => {
			this.socket.on('open', resolve);
			this.socket.on('error', reject);
		});
		this.opened.catch(() => {});
		this.socket.on('message', (data, binary) => (binary ? this.onBinary(data) : this.onText(data)));
	}

	static async connect(url, options = {}) {
		const client = new Client(url, options);
		await client.opened;
		client.hello = await client.call('hello', { version: 1, client: 'e2e', ...options.hello });
		return client;
	}

	onText(data) {
		const message = JSON.parse(data.toString());
		if (message.method) {
			this.notices.push(message);
			this.check();
			return;
		}
		const call = this.calls.get(message.id);
		this.calls.delete(message.id);
		if (!call)
			this.stray = message;
		else if (message.error)
			call.reject(new RpcError(message.error));
		else {
			if (call.method === 'session.join')
				this.streams.set(message.result.session_number, new Decoder(message.result));
			if (FILES.includes(call.method))
				this.transfers.set(message.result.transfer, { ...message.result, parts: [], received: 0 });
			call.resolve(message.result);
		}
		this.check();
	}

	onBinary(data) {
		if (data.toString('latin1', 0, 4) === 'CAUC') {
			const transfer = this.transfers.get(data.readUInt32LE(4));
			if (Number(data.readBigUInt64LE(8)) !== transfer.received)
				throw new Error('a chunk out of order');
			transfer.parts.push(data.subarray(16));
			transfer.received += data.length - 16;
		} else {
			const stream = this.streams.get(header(data).session);
			this.lastKind = stream.take(data);
			this.onFrame?.(stream, this.lastKind, data);
		}
		this.check();
	}

	send(message) {
		this.socket.send(typeof message === 'string' ? message : JSON.stringify(message));
	}

	call(method, params = {}) {
		const id = this.nextId++;
		const promise = new Promise((resolve, reject) => this.calls.set(id, { method, resolve, reject }));
		this.send({ jsonrpc: '2.0', id, method, params });
		return promise;
	}

	notify(method, params = {}) {
		this.send({ jsonrpc: '2.0', method, params });
	}

	// Resolves when `condition` is true; it is looked at after every message.
	until(condition, what, seconds = PATIENCE_S) {
		return new Promise((resolve, reject) => {
			const timer = setTimeout(() => reject(new Error(`did not happen: ${what}`)), seconds * 1000);
			this.waiters.push({
				condition,
				resolve: (value) => {
					clearTimeout(timer);
					resolve(value);
				},
			});
			this.check();
		});
	}

	check() {
		this.waiters = this.waiters.filter((waiter) => {
			const value = waiter.condition();
			if (value)
				waiter.resolve(value);
			return !value;
		});
	}

	notice(method, match = () => true) {
		return this.notices.find((n) => n.method === method && match(n.params));
	}

	async join(session, params = {}) {
		const description = await this.call('session.join', { session, ...params });
		const stream = this.streams.get(description.session_number);
		await this.until(() => stream.synced, 'the first key frame');
		return stream;
	}

	async file(method, params) {
		return (await this.announced(method, params)).bytes;
	}

	// What the session looked like at a tick, as a decoder that holds it.
	async past(session, tick, options = {}) {
		const { result, bytes } = await this.announced('session.frame_at', { session, tick, ...options });
		const decoder = new Decoder(result);
		if (decoder.take(bytes) !== 'key')
			throw new Error('the past is no key frame');
		return decoder;
	}

	async announced(method, params) {
		const result = await this.call(method, params);
		const transfer = this.transfers.get(result.transfer);
		await this.until(() => transfer.received >= result.byte_count, 'the whole file');
		const bytes = Buffer.concat(transfer.parts);
		if (createHash('sha256').update(bytes).digest('hex') !== result.sha256)
			throw new Error('the file has another hash');
		return { result, bytes };
	}

	async upload(name, fileName, bytes, chunkBytes = 65536) {
		const begun = await this.call('upload.begin', { name, file_name: fileName, byte_count: bytes.length });
		for (let offset = 0; offset < bytes.length; offset += chunkBytes)
			this.socket.send(chunk(begun.transfer, offset, bytes.subarray(offset, offset + chunkBytes)));
		const sha256 = createHash('sha256').update(bytes).digest('hex');
		return this.call('upload.end', { transfer: begun.transfer, sha256 });
	}

	async close() {
		this.socket.close(1000);
		return this.closed;
	}

	terminate() {
		this.socket.terminate();
	}
}

export function chunk(transfer, offset, bytes) {
	const head = Buffer.alloc(16);
	head.write('CAUC', 'latin1');
	head.writeUInt32LE(transfer, 4);
	head.writeBigUInt64LE(BigInt(offset), 8);
	return Buffer.concat([head, bytes]);
}
