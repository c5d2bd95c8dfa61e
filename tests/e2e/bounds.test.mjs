// SPDX-License-Identifier: GPL-3.0-or-later
// Tokens that are for some sessions alone, and tokens with a quota of their own.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';
import { smallScene, smallSession } from './wire/scene.mjs';

const ADMIN = 'admin-token-0123456789', ANNA = 'anna-token-0123456789', SPARSE = 'sparse-token-0123456789';
const BOUNDED_ADMIN = 'bounded-admin-0123456789';
const FORBIDDEN = { code: -32043 }, RATE = { code: -32046 };
const folder = mkdtempSync(join(tmpdir(), 'cautery-bounds-'));
let daemon, admin, anna;

function writeTokens(annas = 'sessions=d1-anna-*,d1-demo') {
	writeFileSync(join(folder, 'tokens'), `admin ${ADMIN}\noperate ${ANNA} name=anna ${annas}\noperate ${SPARSE} quota=2\n`
		+ `admin ${BOUNDED_ADMIN} sessions=d1-demo\n`, { mode: 0o600 });
}

before(async () => {
	writeTokens();
	daemon = await Daemon.start({ settings: { tokens: join(folder, 'tokens') } });
	admin = await daemon.connect({ hello: { token: ADMIN } });
	for (const name of ['demo', 'demo-2', 'other', 'anna-1'])
		await smallSession(admin, name, { paused: true });
	anna = await daemon.connect({ hello: { token: ANNA } });
});
after(async () => {
	await daemon.end();
	rmSync(folder, { recursive: true });
});

test('it sees its own, and they alone', async () => {
	const { sessions } = await anna.call('session.list', {});
	assert.deepEqual(sessions.map(({ session }) => session), ['d1-anna-1', 'd1-demo']);
	assert.equal((await admin.call('session.list', {})).sessions.length, 4);
});

test('no method reaches another, nor tells whether it is there', async () => {
	for (const session of ['d1-other', 'd1-demo-2', 'd1-nowhere', 'd2-anna-1'])
		for (const [method, params] of [['session.describe', {}], ['session.join', {}], ['session.step', { ticks: 1 }],
			['session.destroy', {}], ['session.timeline', {}], ['session.export', { format: 'vtu' }], ['session.log', {}],
			['session.frame_at', { tick: 0 }], ['session.snapshot', {}], ['session.rewind', { tick: 0 }],
			['session.fork', { name: 'anna-stolen' }], ['tool.take_over', { tool: 'hook' }],
			['tool.energize', { tool: 'hook', energized: true }], ['gravity.set', { gravity_m_s2: [0, 0, 0] }]])
			await assert.rejects(anna.call(method, { session, ...params }), FORBIDDEN, `${method} of ${session}`);
	const named = await daemon.connect({ session: 'd1-other', hello: { token: ANNA } }); // by the URL
	await assert.rejects(named.call('session.describe', {}), FORBIDDEN);
	await named.close();
	await anna.call('session.describe', { session: 'd1-demo' });
	await anna.call('session.step', { session: 'd1-anna-1', ticks: 1 });
});

const greet = (token, more) => daemon.connect({ hello: { token, ...more } });
const step = (client, sequence, ticks) => client.call('session.step', { session: 'd1-demo', ticks, client_sequence: sequence });

test('the client_id of another owner gets neither its answers nor its numbers', async () => {
	const [surgeon, stranger] = [await greet(ADMIN, { client_id: 'surgeon' }), await greet(ANNA, { client_id: 'surgeon' })];
	assert.equal(stranger.hello.client_id, 'surgeon');
	const first = await step(surgeon, 1, 1);
	assert.deepEqual(await step(stranger, 1, 2), { tick: first.tick + 2 }); // no answer of the surgeon's
	assert.deepEqual(await step(stranger, 1000, 1), { tick: first.tick + 3 });
	assert.deepEqual(await step(surgeon, 2, 1), { tick: first.tick + 4 }); // its 2 is not past
	assert.deepEqual(await step(surgeon, 1, 1), first);
	await surgeon.close();
	await stranger.close();
});

test('who resumes with another token keeps the client_id: what is sent again acts once', async () => {
	const surgeon = await greet(ADMIN, { client_id: 'lasting' });
	const answer = await step(surgeon, 1, 1);
	surgeon.terminate();
	const again = await greet(BOUNDED_ADMIN, { client_id: 'lasting', resume: surgeon.hello.resume });
	assert.deepEqual(await step(again, 1, 1), answer);
	assert.deepEqual(await step(again, 2, 1), { tick: answer.tick + 1 });
	await again.close();
	const stranger = await greet(BOUNDED_ADMIN, { client_id: 'lasting' }); // without the secret
	assert.deepEqual(await step(stranger, 1, 1), { tick: answer.tick + 2 });
	await stranger.close();
});

test('what it makes must have such a name', async () => {
	const definition = await smallScene(anna);
	await assert.rejects(anna.call('session.create', { name: 'theirs', definition, paused: true }), FORBIDDEN);
	await assert.rejects(anna.call('session.create', { definition, paused: true }), FORBIDDEN);
	await assert.rejects(anna.call('session.fork', { session: 'd1-demo', name: 'copy', paused: true }), FORBIDDEN);
	await assert.rejects(anna.call('session.fork', { session: 'd1-demo', paused: true }), FORBIDDEN);
	const made = await anna.call('session.create', { name: 'anna-2', definition, paused: true });
	assert.equal(made.summary.session, 'd1-anna-2');
	const forked = await anna.call('session.fork', { session: 'd1-demo', name: 'anna-3', paused: true });
	assert.equal(forked.summary.session, 'd1-anna-3');
});

test('it is not told when others come and go', async () => {
	await smallSession(admin, 'secret', { paused: true });
	await smallSession(admin, 'anna-4', { paused: true }); // which it is told of, after the other
	const ours = (params) => params.summary.session === 'd1-anna-4';
	await anna.until(() => anna.notice('session.changed', ours), 'its own');
	assert.equal(anna.notice('session.changed', (params) => params.summary.session === 'd1-secret'), undefined);
	assert.ok(admin.notice('session.changed', (params) => params.summary.session === 'd1-secret'));
});

test('it opens no page, and takes no copy, that has them all', async () => {
	for (const path of ['/metrics', '/api/sessions']) {
		assert.equal((await daemon.get(path, { authorization: `Bearer ${ANNA}` })).status, 401);
		assert.equal((await daemon.get(path, { authorization: `Bearer ${SPARSE}` })).status, 200);
	}
	const bounded = await daemon.connect({ hello: { token: BOUNDED_ADMIN } });
	await assert.rejects(bounded.call('store.backup', {}), FORBIDDEN);
	await bounded.close();
});

test('its quota is for all its connections together, and for nobody else', async () => {
	const [one, other] = [await daemon.connect({ hello: { token: SPARSE } }), await daemon.connect({ hello: { token: SPARSE } })];
	await one.call('session.fork', { session: 'd1-demo', name: 'sparse-1', paused: true });
	await other.call('session.fork', { session: 'd1-demo', name: 'sparse-2', paused: true });
	await assert.rejects(one.call('session.fork', { session: 'd1-demo', name: 'sparse-3', paused: true }),
		(error) => error.code === RATE.code && /this token: 2 expensive requests.*quota= in the file of tokens/.test(error.data.reason));
	await assert.rejects(other.call('session.log', { session: 'd1-demo' }), RATE);
	await one.call('session.list', {}); // what is cheap is not counted
	await anna.call('session.fork', { session: 'd1-demo', name: 'anna-5', paused: true });
	await Promise.all([one.close(), other.close()]);
});

test('with other sessions in its line, its connections are closed', async () => {
	writeTokens('sessions=d1-demo');
	daemon.process.kill('SIGHUP');
	assert.equal((await anna.closed).code, 4002);
	const again = await daemon.connect({ hello: { token: ANNA } });
	assert.deepEqual((await again.call('session.list', {})).sessions.map(({ session }) => session), ['d1-demo']);
	await again.close();
});

for (const wrong of ['sessions=', 'sessions=a,,b', 'sessions=a,', 'sessions=a*b', 'sessions=**', 'quota=0', 'quota=-1', 'quota=x', 'quota=', 'sesions=a'])
	test(`a line with ${wrong} is refused`, async () => {
		writeFileSync(join(folder, 'wrong'), `admin ${ADMIN} ${wrong}\n`, { mode: 0o600 });
		const ended = await Daemon.start({ settings: { tokens: join(folder, 'wrong') } }).catch((error) => error);
		assert.equal(ended.code, 1, String(ended));
		assert.match(ended.message, /path="tokens" reason="line 1/);
	});
