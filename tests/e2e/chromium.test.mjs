// SPDX-License-Identifier: GPL-3.0-or-later
// Chromium over https and wss to a daemon that does TLS itself, with a certificate that is made here and that
// Chromium is told to trust, it alone. What its page does over wss, a client of Node sees. Ends with 77, for
// skipped, where Chromium is missing.
import assert from 'node:assert/strict';
import { execFileSync, spawn, spawnSync } from 'node:child_process';
import { createHash, X509Certificate } from 'node:crypto';
import { chmodSync, existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';

const CHROMIUM = '/usr/bin/chromium';
if (!existsSync(CHROMIUM) || spawnSync(CHROMIUM, ['--version']).status !== 0) {
	console.log(`skipped: there is no ${CHROMIUM} (package chromium)`);
	process.exit(77);
}

const folder = mkdtempSync(join(tmpdir(), 'cautery-chromium-'));
const at = (name) => join(folder, name);
let daemon, client, browser;

// Says hello, makes a session, and joins it; forks it once frames have come.
const PAGE = `
const socket = new WebSocket('wss://' + location.host + '/v1', 'cautery.v1');
socket.binaryType = 'arraybuffer';
let id = 0, frames = 0;
const call = (method, params) => socket.send(JSON.stringify({ jsonrpc: '2.0', id: ++id, method, params }));
socket.onopen = () => call('hello', { version: 1, client: 'chromium' });
socket.onmessage = ({ data }) => {
	if (typeof data === 'string') {
		const { id: answered } = JSON.parse(data);
		if (answered === 1)
			call('session.create', { name: 'from-chromium', scene: 'fascia' });
		if (answered === 2)
			call('session.join', { session: 'd1-from-chromium' });
	} else if (++frames === 10)
		call('session.fork', { session: 'd1-from-chromium', name: 'saw-frames', paused: true });
};
`;

function makePair() {
	execFileSync('openssl', ['req', '-x509', '-newkey', 'ec', '-pkeyopt', 'ec_paramgen_curve:P-256', '-nodes',
		'-keyout', at('key.pem'), '-out', at('cert.pem'), '-days', '30', '-subj', '/CN=localhost',
		'-addext', 'subjectAltName=IP:127.0.0.1,DNS:localhost'], { stdio: 'ignore' });
	chmodSync(at('key.pem'), 0o600);
}

// What Chromium knows a key by: the hash of its public part.
function fingerprint() {
	const key = new X509Certificate(readFileSync(at('cert.pem'))).publicKey.export({ type: 'spki', format: 'der' });
	return createHash('sha256').update(key).digest('base64');
}

function open(trusted, profile) {
	const options = ['--headless=new', '--no-sandbox', '--disable-gpu', '--disable-dev-shm-usage', '--no-first-run',
		`--user-data-dir=${at(profile)}`, ...trusted];
	return spawn(CHROMIUM, [...options, `https://127.0.0.1:${daemon.port}/`], { stdio: 'ignore', detached: true });
}

// Its processes are a group of their own.
function close(started) {
	const ended = new Promise((resolve) => started.on('exit', resolve));
	process.kill(-started.pid, 'SIGKILL');
	return ended;
}

before(async () => {
	makePair();
	mkdirSync(at('viewer'));
	writeFileSync(at('viewer/index.html'), '<!doctype html><title>test</title><script src="/page.js"></script>');
	writeFileSync(at('viewer/page.js'), PAGE);
	daemon = await Daemon.start({ settings: { tls_certificate: at('cert.pem'), tls_key: at('key.pem'), viewer: at('viewer') } });
	client = await daemon.connect();
});
after(async () => {
	if (browser)
		await close(browser);
	await daemon.end();
	rmSync(folder, { recursive: true, force: true, maxRetries: 5, retryDelay: 200 });
});

const made = (name) => (params) => params.change === 'created' && params.summary.session === name;

test('its page is loaded over https, and makes, joins and sees a session over wss', async () => {
	browser = open([`--ignore-certificate-errors-spki-list=${fingerprint()}`], 'trusting');
	await client.until(() => client.notice('session.changed', made('d1-from-chromium')), 'a session of Chromium\'s', 60);
	await client.until(() => client.notice('session.changed', made('d1-saw-frames')), 'frames in Chromium', 60);
	const { sessions } = await client.call('session.list', {});
	assert.ok(sessions.find(({ session }) => session === 'd1-from-chromium').subscriber_count >= 1);
});

test('one that does not trust the certificate does not get in', async () => {
	await close(browser);
	browser = undefined;
	await client.call('session.destroy', { session: 'd1-from-chromium' });
	const accepted = await daemon.metric('connections_accepted_total');
	const wary = spawnSync(CHROMIUM, ['--headless=new', '--no-sandbox', '--disable-gpu', '--disable-dev-shm-usage', '--no-first-run',
		`--user-data-dir=${at('wary')}`, '--dump-dom', `https://127.0.0.1:${daemon.port}/`], { encoding: 'utf8', timeout: 60000 });
	assert.ok(!wary.stdout.includes('/page.js'), 'it must not see the page');
	assert.equal(await daemon.metric('connections_accepted_total'), accepted);
	const { sessions } = await client.call('session.list', {});
	assert.ok(!sessions.some(({ session }) => session === 'd1-from-chromium'));
});
