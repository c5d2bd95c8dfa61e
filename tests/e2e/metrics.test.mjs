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

// The samples of a family whose name has this ending and whose labels hold these.
function samplesOf(families, family, ending = '', wanted = {}) {
	return [...families.get(`cautery_${family}`).samples].filter(([key, { labels }]) =>
		JSON.parse(key)[0] === `cautery_${family}${ending}` && Object.entries(wanted).every(([name, text]) => labels.get(name) === text))
		.map(([, sample]) => sample);
}
const valueOf = (...asked) => samplesOf(...asked).reduce((sum, { value }) => sum + value, 0);

// Stages are parts of a step: never more than it, and most of it. A tick at rest has no stages, so gravity changes before
// each try, and the tissue is at rest again after half a second at the earliest. Both are times of the wall clock. Where
// other programs take the processor between two stages, stages are a smaller share; not in each of five tries.
async function expectStagesToMakeUpTheSteps(session) {
	const shares = [];
	for (let i = 0; i < 5; i++) {
		await client.call('gravity.set', { session, gravity_m_s2: [0, 0, i % 2 ? -9.81 : 9.81] });
		const earlier = await scrape(false);
		await client.call('session.step', { session, ticks: 10 });
		const later = await scrape(false);
		const grown = (family) => valueOf(later, family, '_sum') - valueOf(earlier, family, '_sum');
		shares.push(grown('step_stage_seconds') / grown('step_seconds'));
	}
	assert.ok(Math.max(...shares) <= 1.001 && Math.max(...shares) > 0.9, `stages are ${shares} of the steps`);
}

test('steps, their stages, lateness and commits are counted by how long they take', async () => {
	const session = await smallSession(client, 'timed', { paused: true });
	const earlier = await scrape(false);
	await client.call('session.step', { session, ticks: 50 });
	const later = await scrape(false);
	const grown = (...asked) => valueOf(later, ...asked) - valueOf(earlier, ...asked);
	assert.equal(grown('step_seconds', '_count'), 50);
	assert.ok(grown('step_seconds', '_sum') > 0);
	const stages = samplesOf(later, 'step_stage_seconds', '_count').map(({ labels }) => labels.get('stage'));
	assert.deepEqual(stages, ['commands', 'predict', 'local', 'global', 'contact', 'heat', 'dissect', 'frame']);
	for (const stage of stages)
		assert.equal(grown('step_stage_seconds', '_count', { stage }), 50, stage);
	await expectStagesToMakeUpTheSteps(session);
	assert.equal(grown('lateness_seconds', '_count'), 0, 'the clock does not say when a paused session steps');
	assert.ok(grown('store_commit_seconds', '_count') >= 1);
	assert.equal(valueOf(later, 'store_commit_seconds', '_count'), valueOf(later, 'store_commits_total'));
	await client.call('session.destroy', { session });
});

test('while the clock runs, lateness is counted, and a command until a frame shows it', async () => {
	const session = await smallSession(client, 'watched');
	const stream = await client.join(session);
	assert.ok(stream);
	await client.call('tool.take_over', { session, tool: 'hook' });
	const earlier = await scrape(false);
	for (let i = 0; i < 5; i++)
		await client.call('tool.move', { session, tool: 'hook', position_m: [0.001 * i, 0, 0.02], rotation: [1, 0, 0, 0] });
	let later = await scrape(false);
	const grown = (...asked) => valueOf(later, ...asked) - valueOf(earlier, ...asked);
	// an answer may come before the frame does
	for (const until = performance.now() + 20000; grown('command_to_frame_seconds', '_count') < 5 && performance.now() < until;)
		later = await scrape(false);
	assert.equal(grown('command_to_frame_seconds', '_count'), 5);
	assert.ok(grown('command_to_frame_seconds', '_sum') > 0);
	assert.ok(grown('lateness_seconds', '_count') > 0);
	await client.call('session.destroy', { session });
});

test('calls and answers are counted by method and code', async () => {
	const earlier = await scrape(false);
	await client.call('session.list', {});
	await assert.rejects(client.call('session.describe', { session: 'd1-nowhere' }));
	await assert.rejects(client.call('session.pause', { session: 'd1-a', nonsense: 1 }));
	await client.call('session.timeline', { session: 'd1-a' });
	const later = await scrape(false);
	const grown = (...asked) => valueOf(later, ...asked) - valueOf(earlier, ...asked);
	for (const [method, code] of [['session.list', 'ok'], ['session.describe', 'not_here'], ['session.timeline', 'ok'], ['session.pause', 'bad_value']]) {
		assert.equal(grown('calls_total', '', { method }), 1, method);
		assert.equal(grown('answers_total', '', { method, code }), 1, `${method} ${code}`);
		assert.equal(grown('answers_total', '', { method }), 1, method);
	}
	assert.equal(valueOf(later, 'answers_total', '', { method: 'scene.list', code: 'ok' }), 0);
	assert.equal(samplesOf(later, 'answers_total', '', { method: 'scene.list', code: 'ok' }).length, 1, 'told before it is called');
});

test('what runs, its process and its disk are told', async () => {
	const families = await scrape(false);
	const [{ labels, value }] = samplesOf(families, 'build_info');
	assert.equal(value, 1);
	assert.equal(`cauteryd ${labels.get('version')}`, client.hello.server);
	assert.equal(labels.get('dds'), 'off');
	const age = Date.now() / 1000 - valueOf(families, 'start_time_seconds');
	assert.ok(age > 0 && age < 600, `begun ${age} s ago`);
	const files = valueOf(families, 'open_files');
	assert.ok(files > 5 && files < valueOf(families, 'open_files_most'), `${files} files`);
	assert.ok(valueOf(families, 'disk_free_bytes') <= valueOf(families, 'disk_size_bytes'));
	assert.ok(valueOf(families, 'disk_free_bytes') > 0 && valueOf(families, 'resident_bytes') > 1e6);
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

const HISTOGRAM = '# TYPE h histogram\nh_bucket{le="1"} 2\nh_bucket{le="+Inf"} 3\nh_sum 4\nh_count 3';

test('the strict reader takes what is right', () => {
	assert.equal(readExposition(Buffer.from(GOOD), { open: true }).size, 2);
	const escaped = readExposition(Buffer.from('# TYPE a gauge\na{b="\\"\\\\\\n"} +Inf\n# EOF\n'), { open: true });
	const counted = readExposition(Buffer.from(`${HISTOGRAM}\n# EOF\n`), { open: true });
	assert.equal(counted.get('h').samples.size, 4);
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
	['buckets that fall', GOOD.replace('# TYPE d gauge\nd 1e-3', HISTOGRAM.replace('"1"} 2', '"1"} 4'))],
	['buckets without an end', GOOD.replace('# TYPE d gauge\nd 1e-3', HISTOGRAM.replace('h_bucket{le="+Inf"} 3\n', ''))],
	['a count that is not the last bucket', GOOD.replace('# TYPE d gauge\nd 1e-3', HISTOGRAM.replace('h_count 3', 'h_count 2'))],
	['a sample without a type', GOOD.replace('# TYPE d gauge\n', '')],
])
	test(`the strict reader refuses ${what}`, () => {
		assert.notEqual(text, GOOD);
		assert.throws(() => readExposition(Buffer.from(text), { open: true }), /line \d+|the histogram h/);
	});
