// SPDX-License-Identifier: GPL-3.0-or-later
// The DDS domain of this test program. No other test program on this machine has the same domain.
import { createServer } from 'node:net';

const DOMAINS = 200, FIRST_PORT = 21000;

// Takes a domain: the program that listens on the domain's port has the domain until the program ends.
function take(domain) {
	return new Promise((resolve) => {
		const server = createServer().unref();
		server.on('error', () => resolve(false));
		server.listen(FIRST_PORT + domain, '127.0.0.1', () => resolve(true));
	});
}

async function takeAny() {
	for (let i = 0; i < DOMAINS; i++) {
		const domain = 1 + ((process.pid + i) % DOMAINS);
		if (await take(domain))
			return domain;
	}
	throw new Error('every DDS domain is taken');
}

export const DOMAIN = await takeAny();

// Environment variables of a test's Cyclone programs.
export const CYCLONE = { CYCLONEDDS_URI: process.env.LOOPBACK };
