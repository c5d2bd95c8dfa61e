// SPDX-License-Identifier: GPL-3.0-or-later
// Pages, viewer files, tokens, and the program's own flags.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { once } from 'node:events';
import { chmodSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { gunzipSync } from 'node:zlib';
import { Client } from './wire/client.mjs';
import { Daemon } from './wire/daemon.mjs';

const ADMIN = 'admin-token-0123456789', VIEW = 'viewer-token-0123456789';
let folder, daemon;
before(async () => {
	folder = mkdtempSync(join(tmpdir(), 'cautery-viewer-'));
	mkdirSync(join(folder, 'viewer', 'assets'), { recursive: true });
	writeFileSync(join(folder, 'viewer', 'index.html'), '<!doctype html><title>viewer</title>');
	writeFileSync(join(folder, 'viewer', 'assets', 'main-abc.js'), 'export const a = 1;\n'.repeat(200));
	writeFileSync(join(folder, 'viewer', '.hidden'), 'no');
	mkdirSync(join(folder, 'manual', 'design'), { recursive: true });
	writeFileSync(join(folder, 'manual', 'index.html'), '<!doctype html><title>manual</title>');
	writeFileSync(join(folder, 'manual', 'design', 'a.html'), '<!doctype html><title>a page</title>');
	writeFileSync(join(folder, 'secret.txt'), 'no');
	writeFileSync(join(folder, 'tokens'), `# who may what\nadmin ${ADMIN}\nview ${VIEW}\n`);
	chmodSync(join(folder, 'tokens'), 0o600);
	daemon = await Daemon.start({ settings: { viewer: join(folder, 'viewer'), manual: join(folder, 'manual'), tokens: join(folder, 'tokens') } });
});
after(async () => {
	await daemon.end();
	rmSync(folder, { recursive: true });
});

test('viewer files come from memory, with the strict headers', async () => {
	const page = await daemon.get('/');
	assert.equal(page.status, 200);
	assert.match(page.text, /<title>viewer/);
	assert.match(page.headers['content-security-policy'], /default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; connect-src 'self'/);
	assert.equal(page.headers['x-content-type-options'], 'nosniff');
	const script = await daemon.get('/assets/main-abc.js', { 'accept-encoding': 'gzip' });
	assert.equal(script.headers['content-encoding'], 'gzip');
	assert.match(script.headers['content-type'], /javascript/);
	assert.match(script.headers['cache-control'], /immutable/);
	assert.equal(gunzipSync(script.bytes).toString(), 'export const a = 1;\n'.repeat(200));
	assert.equal((await daemon.get('/assets/main-abc.js')).text.length, 4000);
});

test('the manual is served at /manual/, without a token, and its names do not mix with the viewer\'s', async () => {
	for (const [path, title] of [['/manual/', 'manual'], ['/manual/index.html', 'manual'], ['/manual/design/a.html', 'a page']]) {
		const page = await daemon.get(path);
		assert.equal(page.status, 200);
		assert.match(page.text, new RegExp(`<title>${title}`));
		assert.match(page.headers['content-security-policy'], /default-src 'none'/);
	}
	const moved = await daemon.get('/manual');
	assert.deepEqual([moved.status, moved.headers.location], [301, '/manual/']);
	for (const path of ['/manual/assets/main-abc.js', '/manual/design', '/manual/../secret.txt', '/design/a.html', '/manuals/'])
		assert.equal((await daemon.get(path)).status, 404, path);
});

test('without a manual its addresses say so', async () => {
	const other = await Daemon.start({ settings: { viewer: join(folder, 'viewer') } });
	const answer = await other.get('/manual/');
	await other.end();
	assert.equal(answer.status, 404);
	assert.match(JSON.parse(answer.text).reason, /no manual is installed/);
});

test('HEAD is answered without a body, other methods are refused', async () => {
	const head = await daemon.get('/', {}, 'HEAD');
	assert.equal(head.status, 200);
	assert.equal(head.bytes.length, 0);
	assert.equal(head.headers['content-length'], '36');
	assert.equal((await daemon.get('/', {}, 'DELETE')).status, 405);
	assert.equal((await daemon.get('/healthz')).status, 200);
});

for (const path of ['/.hidden', '/../secret.txt', '/%2e%2e/secret.txt', '/assets/../../secret.txt', '/nothing', '/assets'])
	test(`nothing is served at ${path}`, async () => {
		const answer = await daemon.get(path);
		assert.ok(answer.status >= 400 || /<title>viewer/.test(answer.text), `${answer.status} ${answer.text}`);
		assert.ok(!answer.text.startsWith('no'));
	});

test('tokens that are refused are counted, by the door that they came to', async () => {
	const count = async (door) => {
		const { text } = await daemon.get('/metrics', { authorization: `Bearer ${VIEW}` });
		return Number(new RegExp(`^cautery_authentication_failures_total\\{door="${door}"\\} (.*)$`, 'm').exec(text)[1]);
	};
	const [hello, http] = [await count('hello'), await count('http')];
	await assert.rejects(daemon.connect({ hello: { token: 'not-a-token-of-ours-at-all' } }), { code: -32042 });
	assert.equal((await daemon.get('/metrics')).status, 401);
	assert.equal((await daemon.get('/api/sessions', { authorization: 'Bearer wrong' })).status, 401);
	assert.equal(await count('hello'), hello + 1);
	assert.match(await daemon.log(/event=token_refused/), /address=127\.0\.0\.1 total=\d+/);
	assert.equal(await count('http'), http + 2);
});

test('health is told to everybody, numbers and sessions to tokens alone', async () => {
	assert.equal((await daemon.get('/healthz')).status, 200);
	assert.equal((await daemon.get('/readyz')).status, 200);
	assert.deepEqual(JSON.parse((await daemon.get('/api/fleet')).text), { labels: [] }); // a daemon alone
	for (const path of ['/metrics', '/api/sessions']) {
		assert.equal((await daemon.get(path)).status, 401);
		assert.equal((await daemon.get(path, { authorization: 'Bearer wrong-token-000000000' })).status, 401);
		assert.equal((await daemon.get(path, { authorization: `Bearer ${VIEW}` })).status, 200);
	}
	const { text } = await daemon.get('/metrics', { authorization: `Bearer ${VIEW}` });
	for (const line of text.split('\n').filter((l) => l && !l.startsWith('#')))
		assert.match(line, /^cautery_[a-z0-9_]+(\{[a-z]+="[^"]*"(,[a-z]+="[^"]*")*\})? [-+0-9.e]+$/);
});

test('a token gives its role, and none is refused with 4002', async () => {
	const admin = await daemon.connect({ hello: { token: ADMIN } });
	assert.equal(admin.hello.role, 'admin');
	const viewer = await daemon.connect({ hello: { token: VIEW, role: 'admin' } });
	assert.equal(viewer.hello.role, 'view');
	for (const token of ['wrong-token-0123456789', undefined]) {
		const client = new Client(daemon.url());
		await client.opened;
		const began = performance.now();
		await assert.rejects(client.call('hello', { version: 1, client: 'x', token }), { code: -32042 });
		assert.ok(!token || performance.now() - began > 900, 'a wrong one is answered after a second');
		assert.equal((await client.closed).code, 4002);
	}
	await Promise.all([admin.close(), viewer.close()]);
});

const run = (args, environment = {}) =>
	spawnSync(process.env.CAUTERYD, args, { encoding: 'utf8', env: { PATH: process.env.PATH, ...environment } });

test('flags over environment over file over defaults', () => {
	const file = join(folder, 'settings.json');
	writeFileSync(file, '{"port": 1001, "label": "from-file", "max_sessions": 3}');
	const shown = run(['--config', file, '--label=from-flag', '--print-config'],
		{ CAUTERY_MAX_SESSIONS: '5', CAUTERY_LABEL: 'from-environment' });
	const settings = JSON.parse(shown.stdout);
	assert.equal(settings.port, 1001);
	assert.equal(settings.label, 'from-flag');
	assert.equal(settings.max_sessions, 5);
	assert.equal(settings.workers, 0);
	writeFileSync(file, shown.stdout); // what is printed can be read
	assert.deepEqual(JSON.parse(run(['--config', file, '--print-config']).stdout), settings);
});

for (const [what, args, environment, file] of [
	['an unknown flag', ['--speed', '9'], {}],
	['an unknown variable', [], { CAUTERY_SPEED: '9' }],
	['an unknown member', [], {}, '{"speed": 9}'],
	['a value of the wrong type', [], {}, '{"port": "80"}'],
	['a value out of range', ['--port', '70000'], {}],
	['a file that is no JSON', [], {}, '{"port": 80,}'],
	['another address without tokens', ['--listen', '0.0.0.0', '--tls-by-proxy'], {}],
	['another address without TLS', ['--listen', '0.0.0.0', '--tokens', '/dev/null'], {}],
	['a certificate without its key', ['--tls-certificate', 'cert.pem'], {}],
])
	test(`refused settings: ${what}`, () => {
		const all = [...args, '--print-config'];
		if (file) {
			writeFileSync(join(folder, 'bad.json'), file);
			all.push('--config', join(folder, 'bad.json'));
		}
		const ended = run(all, environment);
		assert.equal(ended.status, 2, ended.stdout);
		assert.match(ended.stderr, /event=bad_settings .*reason="[^"]+"/);
	});

test('a port that is taken ends the daemon with the reason', () => {
	const ended = run(['--port', String(daemon.port), '--store', join(folder, 'other.db'), '--scenes', process.env.SCENES]);
	assert.equal(ended.status, 1);
	assert.match(ended.stderr, /cannot listen/);
});

test('the address of an IPv6 daemon has brackets, and leads to it', async (t) => {
	const started = spawn(process.env.CAUTERYD, ['--json', '--listen', '::1', '--port', '0', '--store', join(folder, 'six.db'),
		'--scenes', process.env.SCENES], { stdio: ['ignore', 'pipe', 'inherit'], env: { PATH: process.env.PATH } });
	t.after(() => started.kill());
	const [line] = await once(started.stdout, 'data');
	const { url, address, port } = JSON.parse(line);
	assert.deepEqual([url, address], [`http://[::1]:${port}/`, '::1']);
	assert.equal((await fetch(`${url}healthz`)).status, 200);
	started.kill();
	await once(started, 'exit');
});

test('--help tells every setting', () => {
	const { stdout, status } = run(['--help']);
	assert.equal(status, 0);
	for (const name of Object.keys(JSON.parse(run(['--print-config']).stdout)))
		assert.ok(stdout.includes(`--${name.replaceAll('_', '-')}`), name);
});
