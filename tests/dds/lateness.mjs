// SPDX-License-Identifier: GPL-3.0-or-later
// Measures the longest delay with which this program was run since reset(). On a busy machine all threads wake late,
// the daemon's too. Tests of times must allow for this delay.
import { after } from 'node:test';

const LOOK_MS = 5;

export const now_us = () => Number(process.hrtime.bigint() / 1000n);

class Lateness {
	constructor() {
		this.reset();
		this.timer = setInterval(() => this.look(), LOOK_MS);
	}

	look() {
		const at_us = now_us();
		this.worst_s = Math.max(this.worst_s, (at_us - this.last_us) / 1e6 - LOOK_MS / 1e3);
		this.last_us = at_us;
	}

	reset() {
		this.worst_s = 0;
		this.last_us = now_us();
	}
}

export const lateness = new Lateness();
after(() => clearInterval(lateness.timer));
