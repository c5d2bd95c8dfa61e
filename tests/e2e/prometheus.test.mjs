// SPDX-License-Identifier: GPL-3.0-or-later
// Debian's Prometheus with the settings and rules of deploy/monitoring, but for addresses and times, scrapes a
// daemon that wants tokens; alerts fire when the thing happens, and end with it. Ends with 77, for skipped,
// where Prometheus is missing.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { createInterface } from 'node:readline';
import { after, before, test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';

if (spawnSync('prometheus', ['--version']).error) {
	console.log('skipped: there is no prometheus (package prometheus)');
	process.exit(77);
}

const MONITORING = process.env.MONITORING;
const ADMIN = 'admin-token-0123456789', VIEW = 'view-token-0123456789';
const ALL = { kind: 'box', least_m: [-1, -1, -1], most_m: [1, 1, 1] };
const PATIENCE_MS = 40_000;
const folder = mkdtempSync(join(tmpdir(), 'cautery-prometheus-'));
let daemon, client, prometheus, address;

// As shipped, but that nobody waits: 500 ms for 15 s, and what must last for minutes must last for a second.
function shipped(name, ...changes) {
	let text = readFileSync(join(MONITORING, name), 'utf8').replaceAll('interval: 15s', 'interval: 500ms');
	for (const [from, to] of [[/for: \d+m/g, 'for: 1s'], ...changes]) {
		assert.ok(name === 'prometheus.yml' || text.match(from), `${name} has no ${from}`);
		text = text.replace(from, to);
	}
	writeFileSync(join(folder, name), text);
}

async function startPrometheus() {
	shipped('cautery.rules.yml');
	shipped('prometheus.yml', ['/etc/prometheus/cautery.token', join(folder, 'token')], ['127.0.0.1:8740', `127.0.0.1:${daemon.port}`]);
	writeFileSync(join(folder, 'token'), VIEW);
	prometheus = spawn('prometheus', [`--config.file=${folder}/prometheus.yml`, `--storage.tsdb.path=${folder}/data`,
		'--web.listen-address=127.0.0.1:0'], { stdio: ['ignore', 'ignore', 'pipe'] });
	const lines = [];
	return new Promise((resolve, reject) => {
		createInterface({ input: prometheus.stderr }).on('line', (line) => {
			lines.push(line);
			const found = /msg="Listening on" address=(\S+)/.exec(line);
			if (found)
				resolve(found[1]);
		});
		prometheus.on('exit', (code) => reject(new Error(`prometheus ended ${code}:\n${lines.join('\n')}`)));
	});
}

before(async () => {
	writeFileSync(join(folder, 'tokens'), `admin ${ADMIN}\nview ${VIEW}\n`, { mode: 0o600 });
	// on the double of the core, which faults and is slow at will
	daemon = await Daemon.start({ program: process.env.CAUTERYD_DOUBLE, settings: { tokens: join(folder, 'tokens') } });
	client = await daemon.connect({ hello: { token: ADMIN } });
	address = await startPrometheus();
});
after(async () => {
	prometheus?.kill();
	await daemon?.end();
	rmSync(folder, { recursive: true, force: true });
});

async function ask(path) {
	const { data } = await (await fetch(`http://${address}/api/v1/${path}`)).json();
	return data;
}

// Prometheus tells of alerts to who asks.
async function alerts(name) {
	const { alerts: all } = await ask('alerts');
	return all.filter(({ labels, state }) => labels.alertname === name && state === 'firing');
}

async function until(what, look) {
	for (const end = performance.now() + PATIENCE_MS; performance.now() < end;) {
		const found = await look().catch(() => undefined); // it may be starting
		if (found)
			return found;
		await new Promise((resolve) => setTimeout(resolve, 100));
	}
	throw new Error(`not seen: ${what}; alerts: ${JSON.stringify(await ask('alerts'))}`);
}

test('it scrapes the daemon, with its token', async () => {
	const target = await until('a target that answers', async () => {
		const { activeTargets } = await ask('targets');
		return activeTargets.find(({ health }) => health === 'up');
	});
	assert.equal(target.scrapePool, 'cautery');
	assert.equal(target.lastError, '');
	const { result } = await until('the version', async () => {
		const data = await ask('query?query=cautery_build_info');
		return data.result.length && data;
	});
	assert.equal(`cauteryd ${result[0].metric.version}`, client.hello.server);
	assert.deepEqual(await alerts('CauteryDown'), []);
});

test('a session that faults is an alert, until it is rewound', async () => {
	const session = 'd1-sick';
	for (const name of ['sick', 'well'])
		await client.call('session.create', { name, scene: 'fascia' });
	const stream = await client.join(session);
	await client.until(() => stream.tick > 10, 'running');
	assert.deepEqual(await alerts('CauterySessionFaulted'), []);
	await client.call('force.set', { session, selection: ALL, force_n: [1000, 0, 0] });
	const [alert] = await until('the alert', async () => {
		const firing = await alerts('CauterySessionFaulted');
		return firing.length && firing;
	});
	assert.equal(alert.labels.session, session);
	assert.equal(alert.annotations.summary, 'Session d1-sick is faulted');
	assert.equal((await alerts('CauterySessionFaulted')).length, 1);
	await client.call('session.rewind', { session, tick: 5 });
	await until('its end', async () => (await alerts('CauterySessionFaulted')).length === 0);
});

test('a session that cannot keep its speed is an alert, and its pace is recorded', async () => {
	const session = 'd1-well';
	assert.deepEqual(await alerts('CauterySessionBehind'), []);
	await client.call('force.set', { session, selection: ALL, force_n: [0, 1000, 0] });
	const [alert] = await until('the alert', async () => {
		const firing = await alerts('CauterySessionBehind');
		return firing.length && firing;
	});
	assert.equal(alert.labels.session, session);
	const { result } = await ask('query?query=cautery:session_pace:ratio');
	const pace = Number(result.find(({ metric }) => metric.session === session).value[1]);
	assert.ok(pace > 0 && pace < 0.95, `a pace of ${pace}`);
	await client.call('force.set', { session, selection: ALL, force_n: [0, 0, 0] });
	await until('its end', async () => (await alerts('CauterySessionBehind')).length === 0);
});

test('a daemon that is gone is an alert', async () => {
	await client.close();
	await daemon.stop();
	const [alert] = await until('the alert', async () => {
		const firing = await alerts('CauteryDown');
		return firing.length && firing;
	});
	assert.equal(alert.labels.instance, `127.0.0.1:${daemon.port}`);
});
