// SPDX-License-Identifier: GPL-3.0-or-later
// Starts cauteryd for a test, on a free port, with a store of its own. The program is named by the
// environment variable CAUTERYD, the scenes' folder by SCENES.
import { spawn } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { createInterface } from 'node:readline';
import { after } from 'node:test';
import http from 'node:http';
import https from 'node:https';
import { Client, PATIENCE_S } from './client.mjs';

// A test that fails leaves its daemon running, perhaps a timer or a connection too: nothing of that may
// keep this process until its time is over.
const running = new Set();
after(async () => {
	await Promise.all([...running].map((daemon) => daemon.stop()));
	setTimeout(() => process.exit(), 30000).unref();
});

export class Daemon {
	static async start({ folder, settings = {}, program = process.env.CAUTERYD, environment: added = {} } = {}) {
		const daemon = new Daemon();
		daemon.folder = folder ?? mkdtempSync(join(tmpdir(), 'cautery-e2e-'));
		daemon.lines = [];
		daemon.waiters = [];
		// A test that does not mean the watchdog must not meet it on a slow machine.
		const all = { browser_deadline_s: 10, port: 0, store: join(daemon.folder, 'store.db'), scenes: process.env.SCENES, ...settings };
		const flags = Object.entries(all).map(([name, value]) => `--${name.replaceAll('_', '-')}=${value}`);
		const environment = Object.fromEntries(Object.entries(process.env).filter(([k]) => !k.startsWith('CAUTERY')));
		Object.assign(environment, added);
		daemon.process = spawn(program, ['--json', ...flags],
			{ stdio: ['ignore', 'pipe', 'pipe'], env: environment });
		daemon.exited = new Promise((resolve) => daemon.process.on('exit', (code, signal) => resolve({ code, signal })));
		running.add(daemon);
		daemon.exited.then(() => running.delete(daemon));
		createInterface({ input: daemon.process.stderr }).on('line', (line) => daemon.onLine(line));
		const ready = new Promise((resolve) =>
			createInterface({ input: daemon.process.stdout }).once('line', (line) => resolve(JSON.parse(line))));
		const first = await Promise.race([ready, daemon.exited]);
		if (!first.port)
			throw Object.assign(new Error(`cauteryd ended ${first.code}:\n${daemon.lines.join('\n')}`), first);
		daemon.port = first.port;
		daemon.authority = settings.tls_certificate ? readFileSync(settings.tls_certificate) : undefined; // of its own
		await daemon.ready();
		return daemon;
	}

	onLine(line) {
		this.lines.push(line);
		if (line.includes('event=rule_broken')) // whatever the test looks for, it has found a mistake
			process.exitCode = 1, console.error(line);
		if (process.env.E2E_LOG)
			console.error(line);
		this.waiters = this.waiters.filter((w) => !(w.pattern.test(line) && (w.resolve(line), true)));
	}

	// The first log line, past or coming, that matches.
	log(pattern, seconds = PATIENCE_S) {
		const past = this.lines.find((line) => pattern.test(line));
		if (past)
			return Promise.resolve(past);
		return new Promise((resolve, reject) => {
			const timer = setTimeout(() => reject(new Error(`no log line ${pattern}`)), seconds * 1000);
			this.waiters.push({ pattern, resolve: (line) => (clearTimeout(timer), resolve(line)) });
		});
	}

	url(session) {
		return `${this.authority ? 'wss' : 'ws'}://127.0.0.1:${this.port}/v1${session ? `?session=${session}` : ''}`;
	}

	connect(options = {}) {
		const trusted = this.authority ? { socket: { ca: this.authority, ...options.socket } } : {};
		return Client.connect(this.url(options.session), { ...options, ...trusted });
	}

	get(path, headers = {}, method = 'GET') {
		return new Promise((resolve, reject) => {
			(this.authority ? https : http).request({ host: '127.0.0.1', port: this.port, path, headers, method, agent: false, ca: this.authority }, (answer) => {
				const parts = [];
				answer.on('data', (part) => parts.push(part));
				answer.on('end', () => resolve({
					status: answer.statusCode, headers: answer.headers, bytes: Buffer.concat(parts),
					text: Buffer.concat(parts).toString(),
				}));
			}).on('error', reject).end();
		});
	}

	/** Asks for a minute at most, in which a sanitized daemon on a busy machine has opened its store's sessions. */
	async ready() {
		const until = performance.now() + 60_000;
		while (performance.now() < until) {
			if ((await this.get('/readyz')).status === 200)
				return;
			await new Promise((resolve) => setTimeout(resolve, 25)); // there is no event to await over HTTP
		}
		throw new Error('never ready');
	}

	async metric(name, session) {
		const { text } = await this.get('/metrics');
		const label = session ? `{session="${session}"}` : '';
		const line = text.split('\n').find((l) => l.startsWith(`cautery_${name}${label} `));
		return Number(line.split(' ')[1]);
	}

	kill() {
		this.process.kill('SIGKILL');
		return this.exited;
	}

	async stop() {
		if (this.process.exitCode === null && this.process.signalCode === null)
			this.process.kill('SIGTERM');
		return this.exited;
	}

	async end() {
		const result = await this.stop();
		rmSync(this.folder, { recursive: true, force: true });
		return result;
	}
}
