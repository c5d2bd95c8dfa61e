// SPDX-License-Identifier: GPL-3.0-or-later
// Prometheus' own checks: of /metrics, and of deploy/monitoring's rules, alerts and dashboard. Ends with 77,
// for skipped, where promtool is missing.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';
import { readExposition } from './wire/exposition.mjs';
import { smallSession } from './wire/scene.mjs';

if (spawnSync('promtool', ['--version']).error) {
	console.log('skipped: there is no promtool (package prometheus)');
	process.exit(77);
}

const MONITORING = process.env.MONITORING;
const rules = readFileSync(join(MONITORING, 'cautery.rules.yml'), 'utf8');
const dashboard = JSON.parse(readFileSync(join(MONITORING, 'dashboard.json'), 'utf8'));
const RECORDED = [...rules.matchAll(/record: (\S+)/g)].map(([, name]) => name);
const ALERTS = [...rules.matchAll(/alert: (\S+)/g)].map(([, name]) => name);
// Names of a daemon that has DDS open; here it has not.
const DDS = ['cautery_dds_clients', 'cautery_dds_clients_most', 'cautery_dds_places_denied_total', 'cautery_dds_places_evicted_total',
	'cautery_dds_peers_incompatible_total'];

let folder, bytes, told;
before(async () => {
	folder = mkdtempSync(join(tmpdir(), 'cautery-promtool-'));
	const daemon = await Daemon.start();
	const client = await daemon.connect();
	for (const name of ['a', 'a-a', 'a_a', 'total'])
		await client.join(await smallSession(client, name));
	({ bytes } = await daemon.get('/metrics'));
	await client.close();
	await daemon.end();
	told = new Set(DDS);
	for (const { samples } of readExposition(bytes, { open: false }).values())
		for (const key of samples.keys())
			told.add(JSON.parse(key)[0]);
});
after(() => rmSync(folder, { recursive: true }));

function promtool(...options) {
	const { stdout, stderr, status } = spawnSync('promtool', options, { input: bytes, encoding: 'utf8' });
	return { status, said: stdout + stderr };
}

// The names of ours in an expression: what the daemon tells, and what rules record.
function namesIn(expression) {
	return expression.match(/\bcautery[_:][a-z0-9_:]+/g) ?? [];
}

function areThere(expression, what) {
	for (const name of namesIn(expression))
		assert.ok(name.includes(':') ? RECORDED.includes(name) : told.has(name), `${what} asks for ${name}, which nobody tells`);
}

// What Grafana puts in the place of its variables.
function filled(expression) {
	return expression.replaceAll('$__rate_interval', '1m').replaceAll('$instance', '.*').replaceAll('$session', '.*');
}

test('/metrics, with several sessions', () => {
	assert.deepEqual(promtool('check', 'metrics'), { status: 0, said: '' });
});

test('the rules, and each alert fires when it should and not before', () => {
	const checked = promtool('check', 'rules', join(MONITORING, 'cautery.rules.yml'));
	assert.equal(checked.status, 0, checked.said);
	const played = promtool('test', 'rules', join(MONITORING, 'alerts_test.yml'));
	assert.equal(played.status, 0, played.said);
	const course = readFileSync(join(MONITORING, 'alerts_test.yml'), 'utf8');
	for (const alert of ALERTS)
		for (const wanted of [`- {alertname: ${alert}, eval_time`, `- alertname: ${alert}\n`])
			assert.ok(course.includes(wanted), `alerts_test.yml has no ${wanted}`);
});

test('the test of the rules can fail', () => {
	writeFileSync(join(folder, 'cautery.rules.yml'), rules.replace('cautery_session_faulted == 1', 'cautery_session_faulted == 2'));
	writeFileSync(join(folder, 'alerts_test.yml'), readFileSync(join(MONITORING, 'alerts_test.yml')));
	assert.equal(promtool('test', 'rules', join(folder, 'alerts_test.yml')).status, 1);
});

test('the settings for Prometheus', () => {
	const own = readFileSync(join(MONITORING, 'prometheus.yml'), 'utf8');
	writeFileSync(join(folder, 'cautery.rules.yml'), rules);
	writeFileSync(join(folder, 'token'), 'a token');
	writeFileSync(join(folder, 'prometheus.yml'), own.replace('/etc/prometheus/cautery.token', join(folder, 'token')));
	const checked = promtool('check', 'config', join(folder, 'prometheus.yml'));
	assert.equal(checked.status, 0, checked.said);
});

test('what rules and dashboard ask for is there', () => {
	assert.ok(RECORDED.length > 5 && ALERTS.length > 10);
	areThere(rules.replace(/^ *(record|alert|summary|description): .*$/gm, ''), 'a rule');
	const panels = dashboard.panels.filter(({ type }) => type !== 'row');
	assert.ok(panels.length > 20);
	for (const { title, targets } of panels)
		for (const { expr } of targets)
			areThere(expr, `the panel ${title}`);
	for (const { query } of dashboard.templating.list)
		areThere(query, 'a variable');
	assert.throws(() => areThere('cautery_nonsense', 'this test'));
});

test('the dashboard is one that Grafana can show', () => {
	const ids = dashboard.panels.map(({ id }) => id);
	assert.equal(new Set(ids).size, ids.length);
	const taken = new Set();
	for (const { title, gridPos: { x, y, w, h } } of dashboard.panels)
		for (let column = x; column < x + w; column++)
			for (let line = y; line < y + h; line++) {
				assert.ok(column < 24 && !taken.has(`${column} ${line}`), `${title} lies over another`);
				taken.add(`${column} ${line}`);
			}
	const expressions = dashboard.panels.flatMap(({ targets = [] }) => targets.map(({ expr }) => filled(expr)));
	for (const expression of expressions)
		assert.ok(!expression.includes('$'), expression);
	const asRules = { groups: [{ name: 'panels', rules: expressions.map((expr, i) => ({ record: `panel:${i}`, expr })) }] };
	writeFileSync(join(folder, 'panels.yml'), JSON.stringify(asRules)); // JSON is YAML
	const checked = promtool('check', 'rules', join(folder, 'panels.yml'));
	assert.equal(checked.status, 0, checked.said);
});

test('the page for operators tells of each alert, and of no other', () => {
	const page = readFileSync(join(MONITORING, 'README.md'), 'utf8');
	const told = [...page.matchAll(/^\| `(Cautery\w+)`/gm)].map(([, name]) => name);
	assert.deepEqual(told.sort(), [...ALERTS].sort());
});
