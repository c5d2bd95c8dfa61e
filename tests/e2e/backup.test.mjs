// SPDX-License-Identifier: GPL-3.0-or-later
// store.backup: a copy that is made while a session goes on, restored by starting a daemon with it.
import assert from 'node:assert/strict';
import { copyFileSync, mkdtempSync, readFileSync, readdirSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';
import { cutMiddle, smallSession } from './wire/scene.mjs';

const ADMIN = 'admin-token-0123456789', DRIVER = 'driver-token-0123456789';
const folder = mkdtempSync(join(tmpdir(), 'cautery-backup-'));
const backups = join(folder, 'backups');
const settings = { tokens: join(folder, 'tokens'), store: join(folder, 'store.db') };
let daemon, admin;
before(async () => {
	writeFileSync(settings.tokens, `admin ${ADMIN}\noperate ${DRIVER}\n`, { mode: 0o600 });
	daemon = await Daemon.start({ settings });
	admin = await daemon.connect({ hello: { token: ADMIN } });
});
after(async () => {
	await daemon.end();
	rmSync(folder, { recursive: true });
});

test('what was there at the copy is restored, to the bit, and nothing of what came later', async () => {
	const session = await smallSession(admin, 'kept', { paused: true });
	const running = await smallSession(admin, 'running'); // commits come in meanwhile
	await cutMiddle(admin, session, 40);
	await admin.call('tool.energize', { session, tool: 'hook', energized: false }); // as after a restart
	await admin.call('session.step', { session, ticks: 1 });
	const then = await admin.call('session.snapshot', { session, name: 'then' });
	const copy = await admin.call('store.backup', { name: 'first' });
	assert.equal(copy.file, join(backups, 'first.db'));
	assert.equal(statSync(copy.file).size, copy.byte_count);
	assert.equal(statSync(copy.file).mode & 0o777, 0o600);
	assert.equal(statSync(backups).mode & 0o777, 0o700);
	await admin.call('session.step', { session, ticks: 20 });
	await admin.call('session.snapshot', { session, name: 'later' });
	await smallSession(admin, 'new', { paused: true });

	copyFileSync(copy.file, join(folder, 'restored.db'));
	const restored = await Daemon.start({ settings: { store: join(folder, 'restored.db') } });
	const client = await restored.connect();
	const { sessions } = await client.call('session.list', {});
	assert.deepEqual(sessions.map((summary) => summary.session).sort(), [session, running].sort());
	const kept = sessions.find((summary) => summary.session === session);
	assert.equal(kept.tick, then.tick);
	const again = await client.call('session.snapshot', { session, name: 'again' });
	assert.equal(again.hash, then.hash);
	const { snapshots } = await client.call('session.snapshots', { session });
	assert.deepEqual(snapshots.map(({ name }) => name).sort(), ['again', 'then']);
	// from there both go on alike
	await client.call('session.step', { session, ticks: 20 });
	const onward = await client.call('session.snapshot', { session, name: 'onward' });
	const here = await admin.call('session.restore', { session, name: 'later' });
	assert.equal(onward.tick, here.tick);
	assert.equal((await admin.call('session.snapshot', { session, name: 'compare' })).hash, onward.hash);
	await client.close();
	await restored.end();
});

test('without a name it has that of the time', async () => {
	const { file } = await admin.call('store.backup', {});
	assert.match(file, /\/backups\/\d{8}T\d{6}Z\.db$/);
	assert.ok(statSync(file).size > 0);
});

test('nothing is replaced, and nothing half is left', async () => {
	writeFileSync(join(backups, 'mine.db'), 'mine');
	await assert.rejects(admin.call('store.backup', { name: 'mine' }), { code: -32006 });
	assert.equal(statSync(join(backups, 'mine.db')).size, 4);
	for (const name of ['../mine', 'a/b', '', '.hidden'])
		await assert.rejects(admin.call('store.backup', { name }), { code: -32602 }, name);
	assert.deepEqual(readdirSync(backups).filter((name) => !name.endsWith('.db')), []);
	await admin.call('store.backup', { name: 'another' }); // a refusal keeps nobody from the next one
});

test('it is for administrators', async () => {
	const driver = await daemon.connect({ hello: { token: DRIVER } });
	await assert.rejects(driver.call('store.backup', {}), { code: -32043 });
	await driver.close();
});

test('a store of a newer version is refused with what to do, and left as it is', async () => {
	const { file } = await admin.call('store.backup', { name: 'of-today' });
	const newer = join(folder, 'newer.db'), bytes = readFileSync(file);
	const schema = bytes.readUInt32BE(60); // SQLite's user_version
	bytes.writeUInt32BE(schema + 1, 60);
	writeFileSync(newer, bytes);
	const ended = await Daemon.start({ settings: { store: newer } }).catch((error) => error);
	assert.equal(ended.code, 1, String(ended));
	assert.match(ended.message, new RegExp(`event=start_failed status=unsupported .*reason="written by a newer Cautery: schema ${schema + 1}, `
		+ `this build reads ${schema}: run the newer Cautery, or restore a copy from before the upgrade"`));
	assert.deepEqual(readFileSync(newer), bytes);
	bytes.writeUInt32BE(schema, 60); // it was the version alone
	writeFileSync(newer, bytes);
	await (await Daemon.start({ settings: { store: newer } })).end();
});

test('a folder that the settings name must be there', async () => {
	const other = await Daemon.start({ settings: { backups: join(folder, 'nowhere') } });
	const client = await other.connect();
	await assert.rejects(client.call('store.backup', {}), { code: -32010 });
	assert.match(await other.log(/event=backup_failed/), /nowhere/);
	await client.close();
	await other.end();
});
