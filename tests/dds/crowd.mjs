// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the crowd program (environment variable CROWD): many writers in one participant.
import { CYCLONE, DOMAIN } from './domain.mjs';
import { Program } from './program.mjs';

export class Crowd extends Program {
	// Resolves once all writers have found the daemon.
	static async start(t, session, count, { lease_ms = 500, tools = ['hook'], environment = CYCLONE, wrap = [] } = {}) {
		const crowd = new Crowd(process.env.CROWD, [DOMAIN, session, count, lease_ms, ...tools], { environment, wrap });
		t.after(() => crowd.kill());
		await crowd.event((e) => e.event === 'matched', 'matched');
		return crowd;
	}

	// Resolves when each writer has written `rounds` more times.
	async write(what, rounds = 1) {
		this.tell(`write ${what}`);
		for (let round = 0; round < rounds; round++)
			await this.event((e) => e.event === 'written', 'a round');
	}
}
