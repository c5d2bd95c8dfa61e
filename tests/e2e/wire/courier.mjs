// SPDX-License-Identifier: GPL-3.0-or-later
// Carries a session between two daemons, step by step, so that a test can kill any of the three after
// each of them.
const PART_ENDS = 1, ENDS = 2;

export class Courier {
	constructor(from, to, session, target) {
		Object.assign(this, { from, to, session, target, index: 0 });
	}

	static STEPS = ['begin', 'part', 'ready', 'hold', 'rest', 'commit', 'accept'];

	ofSource() {
		return { session: this.session, move: this.move };
	}

	ofTarget() {
		return { session: this.target, move: this.move };
	}

	async begin(url) {
		const label = this.target.split('-')[0];
		const params = { session: this.session, target: this.target, label };
		({ move: this.move } = await this.from.call('move.begin', url ? { ...params, url } : params));
	}

	async piece() {
		const bytes = await this.from.file('move.read', this.ofSource());
		await this.to.upload('piece', 'piece.caum', bytes);
		({ receipt: this.receipt } = await this.to.call('move.receive', { ...this.ofTarget(), upload: 'piece' }));
		return bytes.readUInt32LE(12);
	}

	async carry(flag) {
		while (!((await this.piece()) & flag));
	}

	part() {
		return this.carry(PART_ENDS);
	}

	async ready() {
		this.stands = await this.to.call('move.ready', this.ofTarget());
	}

	async hold() {
		this.held = await this.from.call('move.hold', this.ofSource());
	}

	rest() {
		return this.carry(ENDS);
	}

	async commit() {
		({ proof: this.proof } = await this.from.call('move.commit', { ...this.ofSource(), receipt: this.receipt ?? '' }));
	}

	async accept() {
		this.served = await this.to.call('move.accept', { ...this.ofTarget(), proof: this.proof });
	}

	// All steps up to and with this one.
	async walk(last = 'accept', url) {
		for (const step of Courier.STEPS) {
			await this[step](url);
			if (step === last)
				return;
		}
	}

	// What a courier does that comes later: asks the source what became of what the target has.
	static async settle(from, to) {
		const { moves } = await to.call('move.list');
		for (const { session: target, other: session, move, state } of moves.filter((m) => m.state !== 'gone')) {
			const decision = await from.call('move.cancel', { session, move });
			if (decision.moved)
				await to.call('move.accept', { session: target, move, proof: decision.proof });
			else if (state !== 'accepting')
				await to.call('move.forget', { session: target, move, release: decision.release });
		}
	}
}
