// SPDX-License-Identifier: GPL-3.0-or-later
// Files that settings name, where something else stands in their place: the daemon says so and ends, at its start, or
// goes on as before, at SIGHUP. A FIFO must not hold it up, nor a device that never ends.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { cpSync, mkdirSync, mkdtempSync, rmSync, symlinkSync, truncateSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { PATIENCE_S } from './wire/client.mjs';
import { Daemon } from './wire/daemon.mjs';

const ADMIN = 'admin-token-0123456789';
const folder = mkdtempSync(join(tmpdir(), 'cautery-files-'));
after(() => rmSync(folder, { recursive: true }));

const OTHERS = {
	fifo: (path) => execFileSync('mkfifo', ['-m', '600', path]),
	folder: (path) => mkdirSync(path),
	'a device that never ends': (path) => symlinkSync('/dev/zero', path),
	'a device without a word': (path) => symlinkSync('/dev/tty', path),
	huge: (path) => (writeFileSync(path, '', { mode: 0o600 }), truncateSync(path, 2 ** 33)),
	nothing: () => {},
};

let made = 0;
// Good files of every kind, and the settings and environment that name them.
function world() {
	const home = join(folder, `${++made}`);
	mkdirSync(home);
	const at = (name) => join(home, name);
	writeFileSync(at('tokens'), `admin ${ADMIN}\n`, { mode: 0o600 });
	writeFileSync(at('settings.json'), '{"log_level": "info"}');
	cpSync(process.env.SCENES, at('scenes'), { recursive: true });
	execFileSync('openssl', ['req', '-x509', '-newkey', 'ec', '-pkeyopt', 'ec_paramgen_curve:P-256', '-nodes', '-days', '2',
		'-subj', '/CN=127.0.0.1', '-addext', 'subjectAltName=IP:127.0.0.1', '-keyout', at('key.pem'), '-out', at('chain.pem')],
	{ stdio: 'ignore' });
	return {
		paths: {
			tokens: at('tokens'), config: at('settings.json'), tls_certificate: at('chain.pem'), tls_key: at('key.pem'),
			scenes: at('scenes/other.json'), store: at('store.db'),
		},
		options: {
			settings: {
				tokens: at('tokens'), tls_certificate: at('chain.pem'), tls_key: at('key.pem'), scenes: at('scenes'), store: at('store.db'),
			},
			environment: { CAUTERY_CONFIG: at('settings.json') },
		},
	};
}

function within(promise, what) {
	let timer;
	const late = new Promise((_, reject) => (timer = setTimeout(() => reject(new Error(`hangs: ${what}`)), 1000 * PATIENCE_S)));
	return Promise.race([promise, late]).finally(() => clearTimeout(timer));
}

function replace(path, make) {
	rmSync(path, { recursive: true, force: true });
	make(path);
}

for (const [what, make] of Object.entries(OTHERS))
	for (const setting of ['tokens', 'config', 'tls_certificate', 'tls_key', 'scenes', 'store'])
		if (what !== 'nothing' || !['scenes', 'store'].includes(setting)) // these may be missing
			test(`at the start ${setting} is ${what}: it ends and says so`, async () => {
				const { paths, options } = world();
				replace(paths[setting], make);
				await assert.rejects(within(Daemon.start(options), setting), ({ code, message }) => {
					assert.ok(code === 1 || code === 2, message);
					assert.ok(message.includes(setting === 'config' ? 'settings.json' : setting), message);
					return true;
				});
			});

test('at SIGHUP: it says so, and serves as before', async () => {
	const { paths, options } = world();
	const daemon = await Daemon.start(options);
	const hello = { token: ADMIN };
	for (const [what, make] of Object.entries(OTHERS))
		for (const setting of ['tokens', 'config', 'tls_certificate', 'tls_key']) {
			const good = `${paths[setting]}.good`;
			cpSync(paths[setting], good);
			replace(paths[setting], make);
			const seen = daemon.lines.length;
			const told = new Promise((resolve) => daemon.waiters.push({ pattern: /event=reloaded/, resolve }));
			daemon.process.kill('SIGHUP');
			await within(told, `${setting} is ${what}`);
			const failed = daemon.lines.slice(seen).filter((line) => /event=reload_failed/.test(line));
			assert.equal(failed.length, 1, `${setting} is ${what}: ${failed.join('\n')}`);
			assert.ok(failed[0].includes(paths[setting]), failed[0]);
			await (await daemon.connect({ hello })).close();
			rmSync(paths[setting], { recursive: true, force: true });
			cpSync(good, paths[setting]);
		}
	await daemon.end();
});

test('a token that stands in the file twice is refused, by its line, as itself or as its hash', async () => {
	const { createHash } = await import('node:crypto');
	const hash = `sha256:${createHash('sha256').update(ADMIN).digest('hex')}`;
	for (const second of [`view ${ADMIN}`, `admin ${ADMIN}`, `operate ${hash}`]) {
		const { paths, options } = world();
		writeFileSync(paths.tokens, `# ours\nadmin ${ADMIN} name=a\n\n${second} name=b\n`, { mode: 0o600 });
		await assert.rejects(within(Daemon.start(options), 'tokens'), /lines 4 and 2 have the same token/);
	}
});
