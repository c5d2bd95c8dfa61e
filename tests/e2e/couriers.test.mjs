// SPDX-License-Identifier: GPL-3.0-or-later
// Random couriers between two daemons. They lose, damage, repeat and mix up what they carry, show wrong and old proofs,
// give up and begin again, and both daemons are killed meanwhile. An honest courier comes after each of them. Then one
// daemon serves the session, as it was before. E2E_COURIERS sets their number, E2E_SEED where they begin.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Courier } from './wire/courier.mjs';
import { Daemon } from './wire/daemon.mjs';
import { cutMiddle, smallSession } from './wire/scene.mjs';

const COURIERS = Number(process.env.E2E_COURIERS ?? (process.env.E2E_SLOW === '1' ? 20 : 150));
const SEED = Number(process.env.E2E_SEED ?? 1);
const A_SESSION = 20; // couriers: each leaves a named snapshot behind
const HEX = '0123456789abcdef';

// xorshift32, as in sequences.test.mjs
function randomOf(seed) {
	let state = (seed * 2654435761 + 1) >>> 0;
	return (below) => {
		state ^= state << 13, state >>>= 0;
		state ^= state >>> 17;
		state ^= state << 5, state >>>= 0;
		return state % below;
	};
}

// Two daemons that may be killed, an admin's connection to each, and all pieces, keys and moves that couriers have seen.
class Field {
	constructor() {
		Object.assign(this, { daemons: [], clients: [], seen: { pieces: [], keys: [''], moves: ['m0'] }, counts: {} });
	}

	async start(at) {
		this.daemons[at] = await Daemon.start({ folder: this.daemons[at]?.folder, settings: { label: `d${at + 1}` } });
		this.clients[at] = await this.daemons[at].connect();
	}

	async kill(at) {
		await this.daemons[at].kill();
		await this.start(at);
	}

	note(what) {
		this.counts[what] = (this.counts[what] ?? 0) + 1;
	}
}

// A courier goes on after a refusal. A closed connection fails the test: a daemon has died by itself.
async function attempt(promise) {
	try {
		return await promise;
	} catch (error) {
		if (!error.data)
			throw error;
		return undefined;
	}
}

class Mischief {
	constructor(field, from, name, random) {
		Object.assign(this, { field, from, to: 1 - from, random, courier: null });
		this.session = `d${from + 1}-${name}`;
		this.target = `d${this.to + 1}-${name}`;
	}

	pick(list) {
		return list[this.random(list.length)];
	}

	ask(at, method, params) {
		return attempt(this.field.clients[at].call(method, params));
	}

	ref(at, move = this.move) {
		return { session: at === this.from ? this.session : this.target, move };
	}

	key(own) {
		if (own && this.random(3))
			return own;
		return this.random(2) ? this.pick(this.field.seen.keys) : Array.from({ length: 64 }, () => HEX[this.random(16)]).join('');
	}

	saw(...keys) {
		this.field.seen.keys.push(...keys.filter(Boolean));
	}

	async begin() {
		const begun = await this.ask(this.from, 'move.begin', { session: this.session, target: this.target, label: `d${this.to + 1}` });
		if (!begun)
			return;
		Object.assign(this, { move: begun.move, receipt: '', proof: '', release: '' });
		this.field.seen.moves.push(begun.move);
	}

	async give(piece) {
		const client = this.field.clients[this.to];
		await attempt(client.upload('piece', 'piece.caum', piece));
		const received = await this.ask(this.to, 'move.receive', { ...this.ref(this.to), upload: 'piece' });
		if (received?.receipt)
			this.saw(this.receipt = received.receipt);
		return received;
	}

	async carry() {
		const piece = await attempt(this.field.clients[this.from].file('move.read', this.ref(this.from)));
		if (!piece)
			return;
		this.piece = piece;
		this.field.seen.pieces.push(piece);
		switch (this.random(20)) {
		case 0: // is lost
			return;
		case 1: { // is damaged
			const damaged = Buffer.from(piece);
			damaged[this.random(damaged.length)] ^= 1 << this.random(8);
			assert.equal(await this.give(damaged), undefined, 'a damaged piece was taken');
			return;
		}
		case 2:
			assert.equal(await this.give(piece.subarray(0, this.random(piece.length))), undefined, 'half a piece was taken');
			return;
		case 3:
			await this.give(this.pick(this.field.seen.pieces));
			break;
		case 4:
			await this.give(piece);
			break; // and again
		}
		await this.give(piece);
	}

	async commit() {
		const decision = await this.ask(this.from, 'move.commit', { ...this.ref(this.from), receipt: this.key(this.receipt) });
		if (decision)
			this.saw(this.proof = decision.proof);
	}

	async cancel() {
		const at = this.random(8) ? this.from : this.to, move = this.random(8) ? this.move : this.pick(this.field.seen.moves);
		const decision = await this.ask(at, 'move.cancel', this.ref(at, move));
		if (decision && move === this.move)
			this.saw(this.release = decision.release ?? '', this.proof = decision.proof ?? '');
	}

	// Never with `source_lost`, which may lose a session by design.
	forget() {
		return this.ask(this.to, 'move.forget', { ...this.ref(this.to), release: this.key(this.release) });
	}

	accept() {
		return this.ask(this.to, 'move.accept', { ...this.ref(this.to), proof: this.key(this.proof) });
	}

	async kill() {
		await this.field.kill(this.random(2));
	}

	async stray() {
		const what = this.pick(['begin', 'carry', 'give', 'hold', 'ready', 'commit', 'cancel', 'cancel', 'forget', 'forget', 'accept', 'accept', 'kill']);
		this.field.note(what);
		if (what === 'give')
			await this.give(this.pick(this.field.seen.pieces) ?? Buffer.from('nothing'));
		else if (what === 'hold' || what === 'ready')
			await this.ask(what === 'hold' ? this.from : this.to, `move.${what}`, this.ref(what === 'hold' ? this.from : this.to));
		else
			await this[what]();
	}

	// A move's own order, with strays in between, until its courier has had enough.
	async walk() {
		await this.begin();
		if (!this.move)
			this.move = this.pick(this.field.seen.moves);
		const order = ['carry', 'ready', 'hold', 'carry', 'commit', 'accept'];
		for (const step of order) {
			while (!this.random(3))
				await this.stray();
			if (!this.random(12))
				return;
			if (step === 'hold' || step === 'ready')
				await this.ask(step === 'hold' ? this.from : this.to, `move.${step}`, this.ref(step === 'hold' ? this.from : this.to));
			else
				await this[step]();
		}
	}
}

// Everything that is not over ends, as by `cautery move` and `cautery move --cancel`.
async function settle(field, from) {
	const [source, target] = [field.clients[from], field.clients[1 - from]];
	await Courier.settle(source, target);
	const { moves } = await source.call('move.list');
	for (const { session, move } of moves.filter(({ state }) => ['leaving', 'held', 'deciding'].includes(state)))
		await source.call('move.cancel', { session, move });
}

const list = async (client) => (await client.call('session.list')).sessions.filter(({ state }) => state !== 'starting');

// The daemon that serves the session. There is exactly one, and no move of it is unfinished.
async function whoServes(field, name) {
	const at = [];
	for (const [i, client] of field.clients.entries()) {
		if ((await list(client)).some(({ session }) => session === `d${i + 1}-${name}`))
			at.push(i);
		const { moves } = await client.call('move.list');
		assert.deepEqual(moves.filter(({ state }) => state !== 'gone'), []);
	}
	assert.equal(at.length, 1, `${at.length} daemons serve ${name}`);
	return at[0];
}

test(`${COURIERS} random couriers lose no session, change none, and have none served twice`, async (t) => {
	const field = new Field();
	await Promise.all([field.start(0), field.start(1)]);
	let at = 0, moved = 0, name, state;
	for (let i = 0; i < COURIERS; i++) {
		const what = `courier ${i} of seed ${SEED}`;
		if (i % A_SESSION === 0) {
			if (name)
				await field.clients[at].call('session.destroy', { session: `d${at + 1}-${name}` });
			[at, name] = [0, `knee-${i}`];
			const session = await smallSession(field.clients[0], name, { paused: true, cells: [8, 6] });
			await cutMiddle(field.clients[0], session, 20);
			await field.clients[0].call('tool.energize', { session, tool: 'hook', energized: false }); // as a move does
			state = await field.clients[0].call('session.snapshot', { session, name: 'first' });
		}
		try {
			await new Mischief(field, at, name, randomOf(SEED * COURIERS + i)).walk();
			await settle(field, at);
			const now = await whoServes(field, name);
			moved += now !== at;
			at = now;
			const { tick, hash } = await field.clients[at].call('session.snapshot', { session: `d${at + 1}-${name}`, name: `after-${i}` });
			assert.deepEqual([tick, hash], [state.tick, state.hash]);
		} catch (error) {
			error.message = `${what}: ${error.message}`;
			throw error;
		}
	}
	t.diagnostic(`${moved} moved; strays: ${Object.entries(field.counts).map(([k, n]) => `${k} ${n}`).join(', ')}`);
	assert.ok(moved > COURIERS / 20, `${moved} of ${COURIERS} moved: too few to find anything`);
	for (const daemon of field.daemons)
		assert.equal((await daemon.end()).code, 0);
});
