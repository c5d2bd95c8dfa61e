// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the requester program (environment variable REQUESTER) and requests sessions with it.
import assert from 'node:assert/strict';
import { CYCLONE, DOMAIN } from './domain.mjs';
import { Program } from './program.mjs';
import { PATIENCE_S } from './wire/client.mjs';

export class Requester extends Program {
	constructor(daemons, environment) {
		super(process.env.REQUESTER, [DOMAIN, daemons], { environment });
		this.number = 0;
		this.replies = [];
	}

	// Resolves once the requester has found `daemons` daemons.
	static async start(t, daemons = 1, environment = CYCLONE) {
		const requester = new Requester(daemons, environment);
		t.after(() => requester.kill());
		await requester.event((e) => e.event === 'matched', 'matched');
		return requester;
	}

	onLine(event) {
		if (event.event === 'reply')
			this.replies.push(event);
		super.onLine(event);
	}

	request(operation, members = {}, number = this.number + 1) {
		this.number = number;
		const words = Object.entries(members).map(([name, value]) => `${name}=${value}`);
		const reply = this.event((e) => e.event === 'reply' && e.number === number, `a reply to ${operation}`);
		this.tell(`request ${number} ${operation} ${words.join(' ')}`);
		return reply;
	}

	async done(operation, members, number) {
		const reply = await this.request(operation, members, number);
		assert.deepEqual([reply.code, reply.reason], [0, '']);
		assert.equal(reply.operation, operation);
		return reply;
	}

	// Opens a writer of tool commands in this session.
	async open(session) {
		this.tell(`writer ${session}`);
		await this.event((e) => e.event === 'opened', 'a writer');
	}

	// Returns the answer once the daemon has found that writer. This is some time after the writer has found the daemon.
	async takeOver(session, tool) {
		for (const end = Date.now() + 1000 * PATIENCE_S; Date.now() < end;) {
			const reply = await this.request('TAKE_OVER', { session, tool, driver: 'writer' });
			if (reply.path !== 'driver')
				return reply;
		}
		throw new Error('the daemon never found the writer');
	}
}
