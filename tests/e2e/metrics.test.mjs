// SPDX-License-Identifier: GPL-3.0-or-later
// /metrics in both formats, while sessions come and go; and that the readers here are strict.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';
import { readExposition } from './wire/exposition.mjs';
import { smallSession } from './wire/scene.mjs';

const OPEN = { accept: 'application/openmetrics-text; version=1.0.0' };
// One the beginning of another, words of the formats themselves, the longest that fits.
const AWKWARD = ['a', 'a-a', 'a_a', 'total', 'eof', 'nan', 'x'.repeat(45)];
let daemon, client;
before(async () => {
	daemon = await Daemon.start();
	client = await daemon.connect();
	for (const name of AWKWARD)
		await smallSession(client, name, { paused: true });
});
after(() => daemon.end());

async function scrape(open) {
	const answer = await daemon.get('/metrics', open ? OPEN : {});
	assert.equal(answer.status, 200);
	assert.equal(answer.headers['content-type'], open
		? 'application/openmetrics-text; version=1.0.0; charset=utf-8' : 'text/plain; version=0.0.4; charset=utf-8');
	assert.match(answer.headers.vary, /accept/i);
	return readExposition(answer.bytes, { open });
}

const sessionsOf = (family) => [...family.samples.values()].map(({ labels }) => labels.get('session')).sort();

// Every family of sessions tells the same ones, as many as there are said to be.
function checkSessions(families) {
	const told = [...families.values()].filter(({ name }) => name.startsWith('cautery_session_'));
	const sessions = sessionsOf(told[0]);
	for (const family of told)
		assert.deepEqual(sessionsOf(family), sessions, family.name);
	assert.equal([...families.get('cautery_sessions').samples.values()][0].value, sessions.length);
	return sessions;
}

for (const open of [false, true])
	test(`${open ? 'OpenMetrics' : 'text'} holds for awkward names`, async () => {
		const families = await scrape(open);
		const sessions = checkSessions(families);
		for (const name of AWKWARD)
			assert.ok(sessions.includes(`d1-${name}`), name);
		for (const { name, help, type } of families.values())
			assert.ok(help && type, name);
	});

test('both formats tell the same families', async () => {
	const [text, open] = [await scrape(false), await scrape(true)];
	const named = [...open.values()].map(({ name, type }) => name + (type === 'counter' ? '_total' : ''));
	assert.deepEqual([...text.keys()].sort(), named.sort());
	for (const { name, unit } of open.values())
		assert.equal(unit, name.match(/_(seconds|bytes|joules)$/)?.[1], name);
});

test('while sessions are made and destroyed, each answer is whole and counters only rise', async () => {
	let going = true;
	const churn = (async () => {
		for (let i = 0; i < 12; i++) {
			const names = [`d1-come-${i}`, 'd1-again'];
			await Promise.all([smallSession(client, `come-${i}`), smallSession(client, 'again')]);
			await Promise.all(names.map((session) => client.call('session.destroy', { session })));
		}
		going = false;
	})();
	const before = new Map();
	for (let i = 0; going || i < 4; i++) {
		const families = await scrape(i % 2 === 1);
		checkSessions(families);
		for (const { name, type, samples } of families.values())
			for (const [key, { labels, value }] of samples) {
				const series = `${i % 2} ${key}`, passing = /come|again/.test(labels.get('session'));
				assert.ok(type !== 'counter' || passing || value >= (before.get(series) ?? 0), `${name} ${key}`);
				before.set(series, value);
			}
	}
	await churn;
});

test('Accept alone decides', async () => {
	for (const [accept, open] of [['*/*', false], ['application/openmetrics-text;q=0.2, text/plain;q=0.3', false],
		['application/openmetrics-text;q=0', false], ['text/plain;q=0.1, application/openmetrics-text;q=0.2', true]]) {
		const answer = await daemon.get('/metrics?format=openmetrics', { accept });
		assert.equal(/^application\/openmetrics/.test(answer.headers['content-type']), open, accept);
		readExposition(answer.bytes, { open });
	}
});

const HEAD = '# TYPE a_seconds counter\n# UNIT a_seconds seconds\n# HELP a_seconds Text\n';
const GOOD = `${HEAD}a_seconds_total{b="c"} 1\n# TYPE d gauge\nd 1e-3\n# EOF\n`;

test('the strict reader takes what is right', () => {
	assert.equal(readExposition(Buffer.from(GOOD), { open: true }).size, 2);
	const escaped = readExposition(Buffer.from('# TYPE a gauge\na{b="\\"\\\\\\n"} +Inf\n# EOF\n'), { open: true });
	assert.equal([...escaped.get('a').samples.values()][0].labels.get('b'), '"\\\n');
});

for (const [what, text] of [
	['no end', GOOD.replace('# EOF\n', '')],
	['an end that does not end', GOOD.trimEnd()],
	['something behind the end', `${GOOD}d 1\n`],
	['a blank line', GOOD.replace('d 1', '\nd 1')],
	['two blanks', GOOD.replace('d 1', 'd  1')],
	['a carriage return', GOOD.replace('1e-3\n', '1e-3\r\n')],
	['a type twice', GOOD.replace('d 1', '# TYPE d gauge\nd 1')],
	['a type behind samples', GOOD.replace('# EOF', '# HELP d late\n# EOF')],
	['a family in two pieces', GOOD.replace('# EOF', 'a_seconds_total{b="d"} 1\n# EOF')],
	['a series twice', GOOD.replace('# TYPE d', 'a_seconds_total{b="c"} 2\n# TYPE d')],
	['a counter named as its samples', GOOD.replaceAll('a_seconds', 'a_total')],
	['a counter without total', GOOD.replace('a_seconds_total', 'a_seconds')],
	['a counter below 0', GOOD.replace('} 1', '} -1')],
	['a counter that is no number', GOOD.replace('} 1', '} NaN')],
	['a gauge with total', GOOD.replace('TYPE d', 'TYPE d_total').replace('\nd 1', '\nd_total 1')],
	['a name that belongs to a counter', GOOD.replace('TYPE d', 'TYPE a_seconds_created').replace('\nd 1', '\na_seconds_created 1')],
	['a unit that the name does not have', GOOD.replace('UNIT a_seconds seconds', 'UNIT a_seconds bytes')],
	['a quote in help', GOOD.replace('Text', 'a "word"')],
	['a lone backslash', GOOD.replace('"c"', '"\\c"')],
	['a label twice', GOOD.replace('b="c"', 'b="c",b="d"')],
	['a trailing comma', GOOD.replace('b="c"', 'b="c",')],
	['infinity without a sign', GOOD.replace('1e-3', 'Inf')],
	['a sample without a type', GOOD.replace('# TYPE d gauge\n', '')],
])
	test(`the strict reader refuses ${what}`, () => {
		assert.notEqual(text, GOOD);
		assert.throws(() => readExposition(Buffer.from(text), { open: true }), /line \d+/);
	});
