// SPDX-License-Identifier: GPL-3.0-or-later
// TLS by the daemon itself: what it speaks, what it refuses to begin with, and how certificates change.
import assert from 'node:assert/strict';
import { execFileSync, spawn, spawnSync } from 'node:child_process';
import { chmodSync, copyFileSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import tls from 'node:tls';
import { Client } from './wire/client.mjs';
import { Daemon } from './wire/daemon.mjs';
import { cutMiddle, smallSession } from './wire/scene.mjs';

const folder = mkdtempSync(join(tmpdir(), 'cautery-tls-'));
const at = (name) => join(folder, name);
const used = { tls_certificate: at('cert.pem'), tls_key: at('key.pem') };
let daemon;

// A pair of its own authority.
function makePair(name) {
	execFileSync('openssl', ['req', '-x509', '-newkey', 'ec', '-pkeyopt', 'ec_paramgen_curve:P-256', '-nodes',
		'-keyout', at(`${name}-key.pem`), '-out', at(`${name}-cert.pem`), '-days', '30', '-subj', `/CN=${name}`,
		'-addext', 'subjectAltName=IP:127.0.0.1,DNS:localhost'], { stdio: 'ignore' });
	chmodSync(at(`${name}-key.pem`), 0o600);
}

// The pair as it would have been long ago: `openssl ca` alone lets its dates be chosen.
function letExpire(name) {
	const authority = at('authority');
	mkdirSync(authority);
	writeFileSync(join(authority, 'index'), '');
	writeFileSync(join(authority, 'config'), `[ca]\ndefault_ca = own\n[own]\ndatabase = ${join(authority, 'index')}\n`
		+ `new_certs_dir = ${authority}\nrand_serial = yes\ndefault_md = sha256\npolicy = any\n[any]\ncommonName = supplied\n`);
	execFileSync('openssl', ['req', '-new', '-key', at(`${name}-key.pem`), '-subj', `/CN=${name}`, '-out', at('request')]);
	execFileSync('openssl', ['ca', '-batch', '-selfsign', '-config', join(authority, 'config'), '-keyfile', at(`${name}-key.pem`),
		'-in', at('request'), '-out', at(`${name}-cert.pem`), '-startdate', '20200101000000Z', '-enddate', '20200201000000Z',
		'-notext'], { stdio: 'ignore' });
}

function usePair(name, key = name) {
	copyFileSync(at(`${name}-cert.pem`), used.tls_certificate);
	copyFileSync(at(`${key}-key.pem`), used.tls_key);
	chmodSync(used.tls_key, 0o600);
}

before(async () => {
	for (const name of ['first', 'second'])
		makePair(name);
	usePair('first');
	daemon = await Daemon.start({ settings: used });
});
after(async () => {
	await daemon.end();
	rmSync(folder, { recursive: true });
});

// What OpenSSL's own client sees.
function ask(...options) {
	const { stdout, stderr } = spawnSync('openssl', ['s_client', '-connect', `127.0.0.1:${daemon.port}`, ...options],
		{ input: '', encoding: 'utf8' });
	return stdout + stderr;
}

// The name in the certificate that new connections get.
function certificateOfNow() {
	return new Promise((resolve, reject) => {
		const socket = tls.connect({ host: '127.0.0.1', port: daemon.port, rejectUnauthorized: false }, () => {
			resolve(socket.getPeerCertificate().subject.CN);
			socket.destroy();
		});
		socket.on('error', reject);
	});
}

async function reload() {
	const seen = daemon.lines.length;
	daemon.process.kill('SIGHUP');
	const isEnd = (line, i) => i >= seen && /event=reloaded/.test(line);
	while (!daemon.lines.some(isEnd))
		await new Promise((resolve) => daemon.waiters.push({ pattern: /event=reloaded/, resolve }));
	return daemon.lines.slice(seen).join('\n');
}

test('a session is driven and watched over wss', async () => {
	const client = await daemon.connect();
	const session = await smallSession(client, 'over-tls', { paused: true });
	const stream = await client.join(session);
	assert.ok(stream);
	await cutMiddle(client, session);
	await client.close();
});

test('messages larger than a record of TLS come whole, both ways', async () => {
	const client = await daemon.connect();
	// an error tells the beginning of what was unknown: the message has been read to its end
	const filling = 'x'.repeat(500_000);
	await assert.rejects(client.call('session.describe', { session: 'd1-over-tls', [filling.slice(0, 60)]: filling }),
		(error) => error.code !== undefined);
	assert.equal(typeof (await client.call('session.list', {})), 'object');
	await client.close();
});

test('TLS 1.2 and 1.3 with HTTP/1.1, nothing older, no weak cipher', () => {
	for (const version of ['-tls1_2', '-tls1_3']) {
		const said = ask(version, '-alpn', 'h2,http/1.1');
		assert.match(said, /ALPN protocol: http\/1\.1/, version);
		assert.match(said, /Cipher is (TLS_|ECDHE-)/, version);
	}
	assert.match(ask('-tls1_1', '-cipher', 'ALL:@SECLEVEL=0'), /alert protocol version|no protocols available/);
	assert.match(ask('-tls1_2', '-cipher', 'AES256-SHA'), /handshake failure|Cipher is \(NONE\)/);
});

test('who speaks no TLS gets no answer', async () => {
	const client = new Client(`ws://127.0.0.1:${daemon.port}/v1`);
	await assert.rejects(client.opened);
	assert.match(await certificateOfNow(), /first/);
});

test('what comes behind the request in one record, before its answer, serves nobody', async () => {
	const request = `GET /v1 HTTP/1.1\r\nHost: 127.0.0.1:${daemon.port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n`
		+ 'Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Protocol: cautery.v1\r\n\r\n';
	for (const count of [1, 200, 1500]) { // beyond what libwebsockets reads at once
		const socket = tls.connect({ host: '127.0.0.1', port: daemon.port, ca: daemon.authority });
		const ended = new Promise((resolve) => socket.on('close', resolve));
		socket.on('error', () => {}); // a reset will do
		socket.resume();
		await new Promise((resolve) => socket.once('secureConnect', resolve));
		socket.write(Buffer.concat([Buffer.from(request), Buffer.concat(Array(count).fill(Buffer.from([0x89, 0x80, 1, 2, 3, 4])))]));
		await ended; // by the timer of hello at the latest
	}
	const { sessions } = await (await daemon.connect()).call('session.list', {});
	assert.ok(Array.isArray(sessions));
});

test('a connection is closed with its code, and TLS ends in order', async () => {
	const socket = tls.connect({ host: '127.0.0.1', port: daemon.port, ca: daemon.authority });
	const parts = [];
	const ended = new Promise((resolve) => socket.on('end', resolve));
	socket.on('data', (part) => parts.push(part));
	await new Promise((resolve) => socket.once('secureConnect', resolve));
	socket.write(`GET /v1 HTTP/1.1\r\nHost: 127.0.0.1:${daemon.port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n`
		+ 'Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Protocol: cautery.v1\r\n\r\n');
	while (!Buffer.concat(parts).includes('\r\n\r\n'))
		await new Promise((resolve) => socket.once('data', resolve));
	socket.write(Buffer.from([0x81, 0x02, 0x7b, 0x7d])); // a frame without a mask, which is not allowed
	await ended;
	const all = Buffer.concat(parts);
	const frame = all.subarray(all.indexOf('\r\n\r\n') + 4);
	assert.equal(frame[0], 0x88);
	assert.equal(frame.readUInt16BE(2), 1002);
	socket.destroy();
});

test('a new pair is there for new connections, and drops nobody', async () => {
	const kept = await daemon.connect();
	const session = await smallSession(kept, 'kept');
	usePair('second');
	assert.match(await reload(), /event=reloaded .*tls=1/);
	assert.equal(await certificateOfNow(), 'second');
	const { sessions } = await kept.call('session.list', {});
	assert.ok(sessions.some((summary) => summary.session === session));
	await kept.close();
});

for (const [what, spoil, path] of [
	['a key of another certificate', () => usePair('second', 'first'), 'tls_key'],
	['a certificate that is none', () => writeFileSync(used.tls_certificate, 'nonsense'), 'tls_certificate'],
	['a key that everybody may read', () => chmodSync(used.tls_key, 0o644), 'tls_key'],
	['a key behind a passphrase', () => execFileSync('openssl', ['ec', '-in', at('second-key.pem'), '-aes256', '-passout',
		'pass:secret', '-out', used.tls_key], { stdio: 'ignore' }), 'tls_key'],
	['an expired certificate', () => {
		makePair('old');
		letExpire('old');
		usePair('old');
	}, 'tls_certificate'],
	['no certificate', () => rmSync(used.tls_certificate), 'tls_certificate'],
])
	test(`${what} is refused, and the pair before stays`, async () => {
		usePair('second');
		await reload();
		spoil();
		const said = await reload();
		assert.match(said, new RegExp(`event=reload_failed setting=\\S+ .*file="${folder}/\\w+.pem" reason="[^"]+" kept=true`));
		assert.match(said, /event=reloaded .*tls=0/);
		assert.equal(await certificateOfNow(), 'second');
		// nor does a daemon begin with it
		const ended = await Daemon.start({ settings: used }).catch((error) => error);
		assert.equal(ended.code, 1, String(ended));
		assert.match(ended.message, new RegExp(`path="${path}"`));
	});

test('handshakes that are begun and left do not keep others waiting', async () => {
	usePair('second');
	await reload();
	const left = Array.from({ length: 20 }, () => spawn('openssl',
		['s_client', '-connect', `127.0.0.1:${daemon.port}`, '-quiet'], { stdio: ['pipe', 'ignore', 'ignore'] }));
	assert.equal(await certificateOfNow(), 'second');
	left.forEach((client) => client.kill());
});
