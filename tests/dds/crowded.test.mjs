// SPDX-License-Identifier: GPL-3.0-or-later
// Tests a machine with many DDS programs. Each program holds two ports of its domain, and a domain has 120 pairs.
import assert from 'node:assert/strict';
import { createSocket } from 'node:dgram';
import { after, afterEach, test } from 'node:test';
import { Controller } from './controller.mjs';
import { DOMAIN } from './domain.mjs';
import { Daemon } from './wire/daemon.mjs';
import { smallSession } from './wire/scene.mjs';

const INDICES = 120;
let held = [];

// Binds the ports that `count` other DDS programs would hold. Programs get random ports of the same range, so some may be
// taken already. A taken port serves as well.
async function crowd(count) {
	await Promise.all([...Array(2 * count).keys()].map((i) => new Promise((resolve, reject) => {
		const socket = createSocket('udp4');
		held.push(socket);
		socket.on('error', (error) => error.code === 'EADDRINUSE' ? resolve() : reject(error));
		socket.bind(7410 + 250 * DOMAIN + i, resolve);
	})));
}
afterEach(() => {
	for (const socket of held)
		socket.close();
	held = [];
});
after(() => Controller.killAll());

const settings = { dds: true, dds_domain: DOMAIN };

test('beside more programs than Cyclone expects by itself, controllers and the daemon find each other', async () => {
	await crowd(INDICES - 20);
	const daemon = await Daemon.start({ settings });
	const client = await daemon.connect();
	assert.ok(client.hello.capabilities.includes('dds'));
	const session = await smallSession(client, 'crowded');
	const controller = await Controller.start({ domain: DOMAIN, session, tool: 'hook', via: 'native' });
	assert.equal(controller.firstDriver, 0);
	await Controller.killAll();
	await client.close();
	await daemon.end();
});

test('where all indices are taken the daemon says so, and what to do', async () => {
	await crowd(INDICES);
	await assert.rejects(Daemon.start({ settings }), ({ code, message }) => {
		assert.equal(code, 1);
		assert.match(message, /120 DDS programs run in domain \d+ on this machine, the most that can: .*dds_domain.*dds_optional/);
		return true;
	});
});

test('with dds_optional the daemon serves WebSocket, and logs that there is no DDS', async () => {
	await crowd(INDICES);
	const daemon = await Daemon.start({ settings: { ...settings, dds_optional: true } });
	assert.ok(daemon.lines.some((line) => /^warning .*event=dds_not_open .*120 DDS programs/.test(line)), daemon.lines.join('\n'));
	const client = await daemon.connect();
	assert.ok(!client.hello.capabilities.includes('dds'));
	await smallSession(client, 'alone');
	await client.close();
	await daemon.end();
});

test('dds_optional does not excuse wrong settings', async () => {
	const wrong = { ...settings, dds_optional: true, dds_security: '/nowhere' };
	await assert.rejects(Daemon.start({ settings: wrong }), /path="dds_security"/);
});
