// SPDX-License-Identifier: GPL-3.0-or-later
// Tests sessions that are created, changed and ended by requests on DDS.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { after, before, test } from 'node:test';
import { DOMAIN } from './domain.mjs';
import { Observer } from './observer.mjs';
import { Requester } from './requester.mjs';
import { PATIENCE_S } from './wire/client.mjs';
import { Daemon } from './wire/daemon.mjs';
import { smallSession } from './wire/scene.mjs';

let daemon, client;
before(async () => {
	daemon = await Daemon.start({ settings: { dds: true, dds_domain: DOMAIN } });
	client = await daemon.connect({ hello: { client: 'admin' } });
});
after(async () => {
	await client.close();
	await daemon.end();
});

const describe = async (session) => (await client.call('session.describe', { session })).summary;

test('a session is made, paused, resumed, forked, rewound, listed and destroyed', async (t) => {
	const requester = await Requester.start(t);
	const made = await requester.done('CREATE', { name: 'made', scene: 'fascia', session: 'd1' });
	assert.equal(made.session, 'd1-made');
	assert.equal(made.epoch, (await describe('d1-made')).epoch);
	assert.deepEqual(made.sessions.map((s) => [s.session, s.scene]), [['d1-made', 'fascia']]);
	const numberOf = async (id) => (await requester.done('LIST')).sessions.find((s) => s.session === id).number;
	assert.ok(made.sessions[0].number > 0);
	assert.equal(made.sessions[0].number, await numberOf('d1-made'));
	const session = made.session;

	const paused = await requester.done('PAUSE', { session });
	const summary = await describe(session);
	assert.deepEqual([summary.state, summary.tick], ['paused', paused.tick]);
	await client.call('session.step', { session, ticks: 5 });

	const forked = await requester.done('FORK', { session, name: 'forked', tick: 3, paused: 1 });
	assert.equal(forked.session, 'd1-forked');
	assert.deepEqual(await describe('d1-forked').then((s) => [s.state, s.tick]), ['paused', 3]);
	assert.equal(forked.sessions[0].number, await numberOf('d1-forked'));

	const rewound = await requester.done('REWIND', { session, tick: 2 });
	assert.equal(rewound.tick, 2);
	assert.deepEqual(await describe(session).then((s) => [s.tick, s.epoch]), [2, rewound.epoch]);
	assert.notEqual(rewound.epoch, made.epoch);

	await requester.done('RESUME', { session });
	assert.equal((await describe(session)).state, 'running');
	const { sessions, session: label } = await requester.done('LIST');
	assert.equal(label, 'd1');
	assert.deepEqual(sessions.map((s) => s.session), ['d1-forked', 'd1-made']);

	await requester.done('DESTROY', { session: 'd1-forked' });
	await requester.done('DESTROY', { session });
	assert.deepEqual((await client.call('session.list')).sessions, []);
	assert.equal(requester.replies.length, requester.number);
});

test('errors have the codes, words and members of JSON-RPC', async (t) => {
	const requester = await Requester.start(t);
	const session = await smallSession(client, 'errors');
	t.after(() => client.call('session.destroy', { session }));
	const fails = async (operation, members, code, status, path) => {
		const reply = await requester.request(operation, members);
		assert.deepEqual([reply.code, reply.status, reply.path], [code, status, path], reply.reason);
	};
	await fails('PAUSE', { session: 'd1-nowhere' }, -32040, 'not_here', 'session');
	await fails('CREATE', { scene: 'nothing' }, -32005, 'not_found', 'scene');
	await fails('CREATE', { scene: 'fascia', name: 'Upper' }, -32602, 'bad_value', 'name');
	await fails('CREATE', { scene: 'fascia', name: 'errors' }, -32006, 'already_exists', 'name');
	await fails('REWIND', { session }, -32602, 'bad_value', 'has_tick');
	await fails('REWIND', { session, tick: '18446744073709551615' }, -32602, 'bad_value', 'tick');
	await fails('TAKE_OVER', { session, tool: 'spoon' }, -32005, 'not_found', 'driver');
});

test('a request of another daemon is left to it', async (t) => {
	const requester = await Requester.start(t);
	requester.tell('request 1 PAUSE session=d2-knee');
	requester.tell('request 2 LIST session=d2');
	requester.number = 2;
	await requester.done('LIST');
	assert.equal(requester.replies.length, 1);
});

test('a request sent again gets its first answer, of a client that comes back too', async (t) => {
	const requester = await Requester.start(t);
	const first = await requester.done('CREATE', { scene: 'fascia', client_id: 'lasting' }, 7);
	const again = await requester.done('CREATE', { scene: 'fascia', client_id: 'lasting' }, 7);
	assert.equal(again.session, first.session);
	const later = await Requester.start(t);
	const once = await later.done('CREATE', { scene: 'fascia', client_id: 'lasting' }, 7);
	assert.equal(once.session, first.session);
	await later.done('DESTROY', { session: first.session, client_id: 'lasting' }, 8);
	await later.done('DESTROY', { session: first.session, client_id: 'lasting' }, 8);
	assert.deepEqual((await client.call('session.list')).sessions, []);
});

test('a number that was another operation\'s is a conflict, and does nothing', async (t) => {
	const requester = await Requester.start(t);
	const { session } = await requester.done('CREATE', { scene: 'fascia', name: 'conflict' }, 1);
	await requester.done('PAUSE', { session }, 2);
	const conflicts = async (operation, members, number, method) => {
		const reply = await requester.request(operation, members, number);
		assert.deepEqual([reply.operation, reply.code, reply.status, reply.path],
			[operation, -32050, 'sequence_conflict', 'number'], reply.reason);
		assert.match(reply.reason, new RegExp(method));
	};
	await conflicts('RESUME', { session }, 2, 'session.pause');
	await conflicts('DESTROY', { session }, 2, 'session.pause');
	await conflicts('CREATE', { scene: 'fascia', name: 'other' }, 2, 'session.pause');
	await conflicts('FORK', { session, name: 'other' }, 1, 'session.create');
	assert.equal((await describe(session)).state, 'paused');
	assert.deepEqual((await client.call('session.list')).sessions.map((s) => s.session), [session]);
	await requester.done('DESTROY', { session }, 3);
	await conflicts('PAUSE', { session }, 3, 'session.destroy'); // the session is gone
});

test('JOIN brings a key frame, where nothing moves too', async (t) => {
	const requester = await Requester.start(t);
	const session = await smallSession(client, 'join', { paused: true });
	const observer = new Observer(session);
	t.after(async () => {
		await observer.kill();
		await client.call('session.destroy', { session });
	});
	const { keys, epoch } = await observer.until((s) => s.synced);
	const joined = await requester.done('JOIN', { session });
	assert.equal(joined.epoch, epoch);
	await observer.until((s) => s.keys > keys);
});

test('TAKE_OVER gives a tool to a writer of the same participant; from its driver it takes an admin', async (t) => {
	const requester = await Requester.start(t);
	const session = await smallSession(client, 'tool'), tool = 'hook';
	t.after(() => client.call('session.destroy', { session }));
	const stream = await client.join(session);
	await requester.open(session);
	const { driver, reason } = await requester.takeOver(session, tool);
	assert.equal(reason, '');
	await client.until(() => stream.tools[0].driver === driver, 'it drives');
	// Writes the command again and again, as a controller does. A command that comes late is refused.
	const moving = setInterval(() => requester.tell('move hook 0 0.01 0.03'), 20);
	t.after(() => clearInterval(moving));
	await client.until(() => Math.abs(stream.tools[0].position[2] - 0.03) < 1e-4, 'it moves');
	clearInterval(moving);
	await client.call('tool.take_over', { session, tool });
	const refused = await requester.takeOver(session, tool);
	assert.deepEqual([refused.code, refused.status], [-32043, 'forbidden']);
});

test('the role that the settings give binds every operation, and their rate', async (t) => {
	const viewed = await Daemon.start({ settings: { dds: true, dds_domain: DOMAIN, label: 'd9', dds_role: 'view', max_requests_per_s: 50 } });
	t.after(() => viewed.end());
	const requester = await Requester.start(t, 2);
	const made = await requester.request('CREATE', { scene: 'fascia', session: 'd9' });
	assert.deepEqual([made.code, made.status], [-32043, 'forbidden']);
	assert.deepEqual((await requester.done('LIST', { session: 'd9' })).sessions, []);
	// The rate of requests in the settings binds every operation too.
	const told = new Set();
	for (const end = Date.now() + 1000 * PATIENCE_S; !told.has('rate') && Date.now() < end;) {
		const many = Array.from({ length: 60 }, () => requester.request('LIST', { session: 'd9' }));
		(await Promise.all(many)).forEach((reply) => told.add(reply.status));
	}
	assert.deepEqual([...told].sort(), ['', 'rate']);
	const wrong = spawnSync(process.env.CAUTERYD, ['--dds', '--dds-role', 'king'], { encoding: 'utf8' });
	assert.equal(wrong.status, 2);
	assert.match(wrong.stderr, /path="dds_role"/);
});
