// SPDX-License-Identifier: GPL-3.0-or-later
// A driver of a tool, for tests. As a program: driver.mjs URL; it energizes the hook of each session
// that a line of its standard input names, says so in a line, and goes on moving it.
import { createInterface } from 'node:readline';
import { pathToFileURL } from 'node:url';
import { Client } from './client.mjs';
import { AT_REST } from './scene.mjs';

export const now = () => Number(process.hrtime.bigint()) / 1e9; // the server's clock too

const PERIOD_MS = 16;

export class Driver {
	static async connect(url, options) {
		const driver = new Driver();
		driver.client = await Client.connect(url, options);
		driver.sent = []; // when signs of life were sent
		driver.sequence = 0;
		return driver;
	}

	// Sends motion like a hand does.
	drive(session) {
		this.rest();
		this.timer = setInterval(() => {
			this.sent.push(now());
			this.client.notify('tool.move', {
				session, tool: 'hook', position_m: [0.001 * (this.sequence % 10), 0, 0.02], rotation: AT_REST, sequence: ++this.sequence,
			});
		}, PERIOD_MS);
		this.timer.unref(); // a test that fails must not keep the process
	}

	rest() {
		clearInterval(this.timer);
	}

	async energize(session) {
		await this.client.call('tool.take_over', { session, tool: 'hook' });
		this.sent.push(now());
		await this.client.call('tool.energize', { session, tool: 'hook', energized: true });
	}
}

if (import.meta.url === pathToFileURL(process.argv[1]).href) {
	const driver = await Driver.connect(process.argv[2]);
	for await (const session of createInterface({ input: process.stdin })) {
		driver.drive(session);
		await driver.energize(session);
		console.log('on');
	}
}
