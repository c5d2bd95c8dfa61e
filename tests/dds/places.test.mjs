// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the limits on drivers: a participant with many writers takes no place from others, and its refusals are logged.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Controller } from './controller.mjs';
import { Crowd } from './crowd.mjs';
import { DOMAIN } from './domain.mjs';
import { Daemon } from './wire/daemon.mjs';
import { AT_REST } from './wire/scene.mjs';
import { watchSession } from './watch.mjs';

const MANY = 300, DEADLINE_S = 1;
const PARTICIPANT_LEASE_S = 10; // Cyclone's lease of a participant, s
const IDLE_MOST = 64; // largest number of clients of one participant that drive nothing

let daemon;
before(async () => {
	daemon = await Daemon.start({ settings: { dds: true, dds_domain: DOMAIN, dds_deadline_s: DEADLINE_S } });
});
after(() => daemon.end());

const watched = (t, name) => watchSession(t, daemon, name, { first: () => Controller.killAll() });
const count = (name) => daemon.metric(name);

async function drives(session, stream, client) {
	const robot = await Controller.start({ domain: DOMAIN, session, tool: 'hook', via: 'native', deadline: DEADLINE_S });
	robot.tell('write on');
	const { driver } = await robot.until((s) => s.driver_name.startsWith('dds '));
	await client.until(() => stream.tools[0].driver === driver, 'it drives');
	return robot;
}

test(`${MANY} writers of one participant whose samples are bad take no place`, async (t) => {
	const { client, session, stream } = await watched(t, 'bad');
	const crowd = await Crowd.start(t, session, MANY);
	await crowd.write('bad', 3);
	assert.equal(await count('dds_clients'), 0);
	await drives(session, stream, client);
	assert.equal(await count('dds_clients'), 1);
});

test(`${MANY} writers of one participant that stand by take a few places, counted and logged, and another drives`, async (t) => {
	const theirs = await watched(t, 'theirs'), ours = await watched(t, 'ours');
	const crowd = await Crowd.start(t, theirs.session, MANY);
	await crowd.write('good', 3);
	await theirs.client.until(() => theirs.stream.tools[0].driver !== 0, 'one of them drives');
	await daemon.log(/ event=dds_no_place count=1 client="dds [0-9a-f]+" .*reason=/);
	assert.ok(await count('dds_places_denied_total') > 0);
	assert.ok(await count('dds_clients') <= IDLE_MOST + 1);
	await drives(ours.session, ours.stream, ours.client);
	assert.equal(daemon.lines.filter((line) => / event=dds_no_place /.test(line)).length, 1, 'one line, not many');
	// When the driver of the crowd's tool has ended, another participant can drive the tool.
	await crowd.end();
	await theirs.client.until(() => theirs.stream.tools[0].driver === 0, 'nobody drives it');
	await drives(theirs.session, theirs.stream, theirs.client);
});

test('who would drive gets a place though others stand by for the tool in numbers', async (t) => {
	const { client, session, stream } = await watched(t, 'queue');
	await client.call('tool.take_over', { session, tool: 'hook' });
	const crowd = await Crowd.start(t, session, MANY);
	await crowd.write('good', 3);
	const robot = await Controller.start({ domain: DOMAIN, session, tool: 'hook', via: 'native', deadline: DEADLINE_S });
	await crowd.write('off', 0);
	robot.tell('write on');
	await daemon.log(new RegExp(`session=${session} event=dds_refused .*`));
	await client.call('tool.hand_over', { session, tool: 'hook' });
	await robot.until((s) => s.driver_name.startsWith('dds ') && s.driver_name.length > 4);
	await client.until(() => stream.tools[0].driver !== 0, 'it drives');
});

test('several writers that hang together all lose their tools', async (t) => {
	const { client, session, stream } = await watched(t, 'hang');
	const tools = ['hook', 'b', 'c', 'd', 'e', 'f'];
	for (const name of tools.slice(1)) {
		await client.call('tool.add', { session, name, shape: 'grasper', position_m: [0, 0, 0.05], rotation: AT_REST });
		await client.call('tool.hand_over', { session, tool: name }); // the client that adds a tool drives it
	}
	await client.until(() => tools.every((_, i) => stream.tools[i]?.driver === 0), 'nobody drives yet');
	const crowd = await Crowd.start(t, session, tools.length, { lease_ms: 1000, tools });
	await crowd.write('good');
	await client.until(() => tools.every((_, i) => stream.tools[i]?.driver > 0), 'they drive');
	crowd.process.kill('SIGSTOP');
	const hung_s = performance.now() / 1000;
	await client.until(() => tools.every((_, i) => stream.tools[i].driver === 0), 'nobody drives');
	const seconds = performance.now() / 1000 - hung_s;
	assert.ok(seconds < PARTICIPANT_LEASE_S / 2, `by their own leases, not by their participant's: ${seconds} s`);
});
