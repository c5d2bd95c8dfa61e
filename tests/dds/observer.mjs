// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the observer program (environment variable OBSERVER) and listens to it.
import { CYCLONE, DOMAIN } from './domain.mjs';
import { Program } from './program.mjs';

export class Observer extends Program {
	constructor(session) {
		super(process.env.OBSERVER, [DOMAIN, session], { environment: CYCLONE });
		this.session = session;
	}

	onLine(event) {
		if (event.event === 'status')
			this.status = event;
		super.onLine(event);
	}

	// Returns the newest status, once a status meets the condition.
	async statusThat(condition, what) {
		return this.status && condition(this.status)
			? this.status
			: this.event((e) => e.event === 'status' && condition(e), what);
	}
}

// Returns, from a WebSocket client's decoder, the hash that the observer reports of its state.
function hashed(hash, array) {
	for (const byte of new Uint8Array(array.buffer, array.byteOffset, array.byteLength))
		hash = Math.imul(hash ^ byte, 16777619) >>> 0; // FNV-1a
	return hash;
}

export const stateHash = (stream) => hashed(hashed(2166136261, stream.quantised), stream.mask);
export const topologyHash = (stream) =>
	hashed(hashed(hashed(2166136261, stream.faces), stream.faceLayers), stream.rest);
