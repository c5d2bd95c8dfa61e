// SPDX-License-Identifier: GPL-3.0-or-later
// The channel tool_contact through the daemon: a pressed sheet's record has the tick's force, and planes that push as the
// force does. No stream has it that did not ask.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';
import { AT_REST, smallSession } from './wire/scene.mjs';

test('a client that asks gets the contact of every tool', async () => {
	const daemon = await Daemon.start();
	const client = await daemon.connect(), other = await daemon.connect();
	const session = await smallSession(client, 'contact', { paused: true });
	const stream = await client.join(session, { rate_hz: 1000, channels: ['positions', 'tools', 'tool_contact'] });
	const plain = await other.join(session, {});
	assert.ok(!plain.description.channels.includes('tool_contact'));
	assert.deepEqual(stream.contacts.map(({ name, valid }) => ({ name, valid })), [{ name: 'hook', valid: false }]);
	await client.call('tool.take_over', { session, tool: 'hook' });
	await client.call('tool.move', { session, tool: 'hook', position_m: [0, 0, -0.004], rotation: AT_REST });
	const { tick } = await client.call('session.step', { session, ticks: 40 });
	await client.until(() => stream.tick === tick, 'the state after the steps');
	const [contact] = stream.contacts, [tool] = stream.tools;
	assert.ok(contact.valid);
	assert.deepEqual(contact.force, tool.raw.force);
	assert.deepEqual(contact.asked, [0, 0, -0.004].map(Math.fround));
	assert.ok(contact.force[2] > 0.01, `${contact.force[2]} N`);
	assert.ok(contact.planes.length > 0 && contact.planes.some(([, , up]) => up > 0.5));
	assert.ok(contact.compliance.slice(0, 3).every((each) => each > 0));
	await client.until(() => plain.tick === tick, 'the same for the other client');
	assert.equal(plain.contacts, undefined);
	await client.close();
	await other.close();
	await daemon.end();
});
