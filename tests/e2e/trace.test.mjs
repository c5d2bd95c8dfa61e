// SPDX-License-Identifier: GPL-3.0-or-later
// What a session decided can be written down and played again to the same answers (trace_session).
import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { promisify } from 'node:util';
import { Daemon } from './wire/daemon.mjs';
import { AT_REST, cutMiddle, smallSession } from './wire/scene.mjs';

const run = promisify(execFile);
// as server/session/logic.h has them
const EVENTS = ['order', 'alive', 'away', 'forget', 'time', 'store', 'cancel', 'committed', 'arrived', 'stayed', 'fault', 'drain', 'end'];
const DEADLINE_S = 0.3;
const hook = (session) => ({ session, tool: 'hook' });
const forHook = (kind, session, more = {}) => [kind, { ...hook(session), ...more }];

let folder;
before(() => (folder = mkdtempSync(join(tmpdir(), 'cautery-trace-'))));
after(() => rmSync(folder, { recursive: true, force: true }));

const traces = () => readdirSync(folder).map((name) => join(folder, name));

async function replay(file) {
	const { stdout } = await run(process.env.REPLAY_TRACE, [file]);
	const counts = JSON.parse(stdout);
	return { ...counts, of: Object.fromEntries(EVENTS.map((name, i) => [name, counts.of_event[i]])) };
}

// Two operators and an admin: whatever the machine decides about, from the outside.
async function useSession(daemon, name) {
	const admin = await daemon.connect();
	const [first, second] = await Promise.all([1, 2].map(() => daemon.connect({ hello: { role: 'operate', client: 'operator' } })));
	const session = await smallSession(admin, name);
	const stream = await admin.join(session, { rate_hz: 1000, channels: ['mask', 'tools'] });
	const call = (client, [method, params]) => client.call(method, params);
	await call(first, forHook('tool.take_over', session));
	for (let i = 0; i < 20; i++)
		first.notify('tool.move', { ...hook(session), position_m: [0.001 * i, 0, 0.02], rotation: AT_REST, sequence: i + 1 });
	await call(first, forHook('tool.energize', session, { energized: true }));
	first.notify('heartbeat', { visible: true });
	await admin.until(() => !stream.tools[0].energized && stream.tools[0].energyOff === 'watchdog', 'it is cut for silence');
	await assert.rejects(call(second, forHook('tool.energize', session, { energized: true })));
	await call(second, forHook('tool.request_takeover', session));
	const far = call(first, forHook('tool.release', session, { tick: 1e9 })).catch((error) => error);
	await first.call('session.cancel', { session });
	await far;
	await call(first, forHook('tool.hand_over', session, { client: second.hello.client }));
	await call(second, forHook('tool.energize', session, { energized: true, ticks: 1000 }));
	second.notify('heartbeat', { visible: false });
	await call(admin, forHook('tool.take_over', session));
	await admin.call('session.pause', { session });
	await admin.call('session.snapshot', { session, name: 'here' });
	await admin.call('session.step', { session, ticks: 5 });
	await admin.call('session.rewind', { session, tick: 3 });
	await admin.call('session.restore', { session, name: 'here' });
	await assert.rejects(admin.call('session.rewind', { session, tick: 1e6 }));
	await cutMiddle(admin, session, 30);
	await call(admin, forHook('tool.hand_over', session, { client: first.hello.client }));
	await admin.call('session.resume', { session });
	await admin.until(() => stream.tools[0].driver === first.hello.client, 'another drives');
	second.terminate();
	await first.close();
	await admin.until(() => stream.tools[0].driver === 0, 'its driver will not come back');
	const { tick } = stream; // the trace goes to the disk after each slice
	await admin.until(() => stream.tick > tick + 2, 'some ticks');
	return { admin, session };
}

test('all that a session decides is written down and plays again, also of a daemon that was killed', async () => {
	const settings = { trace_session: folder, browser_deadline_s: DEADLINE_S, resume_s: 0 };
	const daemon = await Daemon.start({ settings });
	const { session } = await useSession(daemon, 'traced');
	await daemon.kill();
	const again = await Daemon.start({ folder: daemon.folder, settings });
	const admin = await again.connect();
	await admin.call('session.step', { session, ticks: 2 }).catch(() => admin.call('session.describe', { session }));
	await admin.call('session.destroy', { session });
	await again.end();

	const files = traces();
	assert.deepEqual(files.map((file) => file.slice(folder.length + 1)).sort(), [`${session}.1.trace`, `${session}.2.trace`]);
	const { events, acts, effects, of } = await replay(files.find((file) => file.includes('.1.')));
	assert.ok(of.order >= 30, `${of.order} orders`);
	for (const event of ['alive', 'away', 'forget', 'time', 'cancel', 'committed'])
		assert.ok(of[event] > 0, `no event '${event}'`);
	assert.ok(of.arrived >= 3, `${of.arrived} arrivals: start, rewind, restore`);
	assert.ok(events > 50 && acts > 100 && effects > 50, `${events} events, ${acts} acts, ${effects} effects`);
	const second = await replay(files.find((file) => file.includes('.2.')));
	assert.equal(second.of.arrived, 1);
});

test('a trace that tells another story is found out', async () => {
	const [file] = traces();
	const text = readFileSync(file, 'utf8');
	const off = text.replace(/( {2}effect=tell .*)drive\.energized=1/, '$1');
	assert.notEqual(off, text);
	const other = join(folder, 'other.trace');
	writeFileSync(other, off);
	await assert.rejects(run(process.env.REPLAY_TRACE, [other]), ({ code, stderr }) => {
		assert.equal(code, 1);
		assert.match(stderr, /line \d+: the trace has '.*effect=tell/);
		return true;
	});
});

test('a folder that cannot be written is told of, and nothing else happens', async () => {
	const daemon = await Daemon.start({ settings: { trace_session: join(folder, 'nowhere') } });
	const client = await daemon.connect();
	const session = await smallSession(client, 'untraced');
	await client.call('session.step', { session, ticks: 2 }).catch(() => client.call('session.describe', { session }));
	assert.match(await daemon.log(/event=not_traced/), new RegExp(`session=${session} .*file="[^"]*nowhere/${session}\\.1\\.trace" reason="No such file`));
	await daemon.end();
});
