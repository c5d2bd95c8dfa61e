// SPDX-License-Identifier: GPL-3.0-or-later
// SIGHUP: tokens and the log's level are read anew, and nobody is dropped but whom it concerns.
import assert from 'node:assert/strict';
import { chmodSync, mkdtempSync, renameSync, rmSync, unlinkSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, beforeEach, test } from 'node:test';
import { Client } from './wire/client.mjs';
import { Daemon } from './wire/daemon.mjs';
import { AT_REST, smallSession } from './wire/scene.mjs';

const ADMIN = 'admin-token-0123456789', DRIVER = 'driver-token-0123456789', OTHER = 'other-token-0123456789';
const USUAL = `# line 1\nadmin ${ADMIN}\noperate ${DRIVER}\n`;
let folder, tokens, settings, daemon, admin, session, sessions = 0;
before(async () => {
	folder = mkdtempSync(join(tmpdir(), 'cautery-reload-'));
	tokens = join(folder, 'tokens');
	settings = join(folder, 'settings.json');
	writeTokens(USUAL);
	writeFileSync(settings, '{"log_level": "info"}');
	daemon = await Daemon.start({ settings: { tokens }, environment: { CAUTERY_CONFIG: settings } });
	admin = await daemon.connect({ hello: { token: ADMIN } });
});
beforeEach(async () => {
	await reload(USUAL);
	session = await smallSession(admin, `kept-${++sessions}`);
});
after(async () => {
	await daemon.end();
	rmSync(folder, { recursive: true });
});

function writeTokens(text, mode = 0o600) {
	writeFileSync(`${tokens}.new`, text, { mode });
	chmodSync(`${tokens}.new`, mode);
	renameSync(`${tokens}.new`, tokens);
}

// Tells the daemon; the log line of the end, after those of what was wrong.
async function hup() {
	const seen = daemon.lines.length;
	daemon.process.kill('SIGHUP');
	const isEnd = (line, i) => i >= seen && /event=reloaded/.test(line);
	while (!daemon.lines.some(isEnd))
		await new Promise((resolve) => daemon.waiters.push({ pattern: /event=reloaded/, resolve }));
	return daemon.lines.slice(seen);
}

function reload(text, mode) {
	writeTokens(text, mode);
	return hup();
}

const greet = (token, more = {}) => daemon.connect({ hello: { token, ...more } });

async function isRefused(token) {
	const client = new Client(daemon.url());
	await client.opened;
	await assert.rejects(client.call('hello', { version: 1, client: 'x', token }), { code: -32042 });
	assert.equal((await client.closed).code, 4002);
}

// Drives the hook with energy on, and says nothing more: only its browser_deadline_s of 10 s would cut it.
async function energized(client) {
	await client.call('tool.take_over', { session, tool: 'hook' });
	await client.call('tool.move', { session, tool: 'hook', position_m: [-0.02, 0, 0.02], rotation: AT_REST });
	await client.call('tool.energize', { session, tool: 'hook', energized: true });
}

test('a token that is taken back ends its connection at once, energy off; others notice nothing', async () => {
	const driver = await greet(DRIVER);
	const stream = await admin.join(session);
	await energized(driver);
	await admin.until(() => stream.tools[0].energized, 'energy');
	const started = performance.now();
	await reload(`admin ${ADMIN}\nview ${OTHER}\n`);
	const { code, reason } = await driver.closed;
	assert.equal(code, 4002);
	assert.match(reason, /was revoked/);
	await admin.until(() => !stream.tools[0].energized, 'energy off');
	assert.ok(performance.now() - started < 5000, 'long before its deadline');
	await isRefused(DRIVER);
	const { delta, key } = stream.counts;
	await admin.until(() => stream.counts.delta > delta + 20, 'the stream goes on');
	assert.equal(stream.counts.key, key);
	assert.equal(admin.closeCode, undefined);
	const viewer = await greet(OTHER);
	assert.equal(viewer.hello.role, 'view');
	assert.equal((await daemon.get('/metrics', { authorization: `Bearer ${OTHER}` })).status, 200);
	assert.equal((await daemon.get('/metrics', { authorization: `Bearer ${DRIVER}` })).status, 401);
	await viewer.close();
});

test('energy is off even if the one whose token was taken back does not read its close frame', async () => {
	const driver = await greet(DRIVER);
	const stream = await admin.join(session);
	await energized(driver);
	await admin.until(() => stream.tools[0].energized, 'energy');
	driver.socket.pause();
	await reload(`admin ${ADMIN}\n`);
	await admin.until(() => !stream.tools[0].energized, 'energy off', 2);
	driver.socket.terminate();
});

test('who gets a new token comes back to its tools', async () => {
	const driver = await greet(DRIVER);
	await driver.call('tool.take_over', { session, tool: 'hook' });
	await reload(`admin ${ADMIN}\noperate ${OTHER}\n`);
	await driver.closed;
	const again = await greet(OTHER, { resume: driver.hello.resume });
	assert.equal(again.hello.client, driver.hello.client);
	await again.call('tool.energize', { session, tool: 'hook', energized: true });
	await again.call('tool.energize', { session, tool: 'hook', energized: false });
	await again.close();
});

test('a role that becomes less ends the connections that have more, and no others', async () => {
	const driver = await greet(DRIVER), looker = await greet(DRIVER, { role: 'view' });
	await reload(`admin ${ADMIN}\nview ${DRIVER}\n`);
	const { code, reason } = await driver.closed;
	assert.equal(code, 4002);
	assert.match(reason, /was lowered/);
	await looker.call('session.list');
	const again = await greet(DRIVER);
	assert.equal(again.hello.role, 'view');
	await reload(USUAL); // more: kept as it is until it says hello again
	await assert.rejects(again.call('session.pause', { session }), { code: -32043 });
	const more = await greet(DRIVER);
	assert.equal(more.hello.role, 'operate');
	await Promise.all([looker.close(), again.close(), more.close()]);
});

test('a broken file changes nothing, and the log says what is wrong and where', async () => {
	const driver = await greet(DRIVER);
	for (const [text, mode, reason] of [
		[`admin ${ADMIN}\n\nking ${OTHER}\n`, 0o600, 'line 3: roles are'],
		[`admin ${ADMIN}\noperate short\n`, 0o600, 'line 2: a token must have'],
		['', 0o600, 'contains no token'],
		[`admin ${OTHER}\n`, 0o644, 'read by other users'],
	]) {
		const lines = await reload(text, mode);
		const failed = lines.find((line) => /event=reload_failed/.test(line));
		assert.match(failed, /^error /);
		assert.ok(failed.includes('setting=tokens') && failed.includes(tokens) && failed.includes(reason), failed);
		await driver.call('session.list');
		await (await greet(DRIVER)).close();
		await isRefused(OTHER);
	}
	unlinkSync(tokens);
	assert.ok((await hup()).some((line) => /reload_failed .*cannot open/.test(line)));
	await driver.call('session.list');
	await driver.close();
});

test('the log\'s level follows the settings, what cannot follow is named, what is wrong is kept', async () => {
	const says = async () => {
		const seen = daemon.lines.length;
		await (await greet(DRIVER)).close();
		await hup();
		return daemon.lines.slice(seen).some((line) => /event=hello/.test(line));
	};
	assert.equal(await says(), true);
	writeFileSync(settings, '{"log_level": "notice", "max_sessions": 7}');
	const lines = await hup();
	assert.ok(lines.some((line) => /^warning .*event=needs_restart setting=max_sessions/.test(line)), lines.join('\n'));
	assert.equal(await says(), false);
	for (const [text, wrong] of [['{"log_level": "loud"}', /setting=log_level.*loud/], ['{"log_level": ', /settings\.json/],
		['{"sessions_max": 3}', /sessions_max/]]) {
		writeFileSync(settings, text);
		const failed = (await hup()).find((line) => /event=reload_failed/.test(line));
		assert.match(failed, wrong);
	}
	assert.equal(await says(), false);
	writeFileSync(settings, '{"log_level": "info"}');
	await hup();
	assert.equal(await says(), true);
});

test('a hundred in a row drop nobody', async () => {
	const stream = await admin.join(session);
	const { key } = stream.counts;
	for (let i = 0; i < 100; i++) {
		daemon.process.kill('SIGHUP');
		await admin.call('session.list');
	}
	await hup();
	const { delta } = stream.counts;
	await admin.until(() => stream.counts.delta > delta + 5, 'the stream goes on');
	assert.equal(stream.counts.key, key);
});
