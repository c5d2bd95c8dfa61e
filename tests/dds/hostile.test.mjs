// SPDX-License-Identifier: GPL-3.0-or-later
// Tests storms of bad samples: they are counted and refused, and do not slow the simulation.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { Controller } from './controller.mjs';
import { DOMAIN } from './domain.mjs';
import { Daemon } from './wire/daemon.mjs';
import { far, watchSession } from './watch.mjs';

const STORM_HZ = 10000;
// Quiet and storm take turns, and the best window of each is used, because other programs on the machine slow windows
// of both.
const TURNS = 5, WINDOW_STEPS = 60;
// Allowed ratio of the costs and slack, s: the storm's two programs and the transport take processor time from the
// step.
const RATIO_MOST = 2, SLACK_S = 0.001;
const AT_AIM_M = 1e-4;
// An instance in Cyclone's tables takes some hundred bytes, so this number of instances would take tens of megabytes.
// With a sanitizer, freed memory stays in quarantine, so the size shows nothing.
const SLOW = Boolean(process.env.E2E_SLOW);
const MADE_UP_KEYS = SLOW ? 5000 : 100000, GROWTH_MOST_BYTES = 16e6;

let daemon;
before(async () => {
	daemon = await Daemon.start({ settings: { dds: true, dds_domain: DOMAIN, dds_deadline_s: 1 } });
});
after(() => daemon.end());

const watched = (t, name) => watchSession(t, daemon, name, { first: () => Controller.killAll() });
const controller = (session, via) => Controller.start({ domain: DOMAIN, session, tool: 'hook', via, deadline: 1 });

const quantile = (values, share) => values.toSorted((a, b) => a - b)[Math.floor(share * (values.length - 1))];

// Returns the costs of the next steps, s, from the frames.
async function costs(client, stream) {
	const seen = [];
	client.onFrame = () => seen.push(stream.stepCost);
	await client.until(() => seen.length >= WINDOW_STEPS, 'a window of steps');
	client.onFrame = null;
	return quantile(seen, 0.99);
}

for (const via of ['native', 'ros'])
	test(`a ${via} storm of bad samples at ${STORM_HZ} a second is counted, and the step costs what it did`, async (t) => {
		const { client, session } = await watched(t, `storm-${via}`);
		const stream = await client.join(session, { channels: ['tools', 'statistics'] });
		const driver = await controller(session, via);
		driver.tell('write on');
		const { driver: driving } = await driver.until((s) => s.driver_name.startsWith(via === 'ros' ? 'ros ' : 'dds '));
		const stranger = await controller(session, via);

		const quiet = [], stormy = [];
		const before = await daemon.metric('session_refused_total', session);
		for (let turn = 0; turn < TURNS; turn++) {
			quiet.push(await costs(client, stream));
			stranger.tell(`storm ${STORM_HZ}`);
			stormy.push(await costs(client, stream));
			stranger.tell('storm 0');
			await stranger.state();
		}
		const { stormed } = await stranger.state();
		const refused = await daemon.metric('session_refused_total', session) - before;
		const [a, b] = [Math.min(...quiet), Math.min(...stormy)];
		t.diagnostic(`step p99 ${(1e3 * a).toFixed(3)} ms quiet, ${(1e3 * b).toFixed(3)} ms in the storm; ` +
			`${stormed} bad samples, ${refused} refused`);
		assert.ok(stormed > 1000, `${stormed} samples`);
		assert.ok(refused > stormed / 10 && refused <= stormed + 10, `${refused} of ${stormed} refused`);
		if (!SLOW)
			assert.ok(b <= RATIO_MOST * a + SLACK_S, `${b} s, ${a} s when quiet`);

		// The driver has kept its tool all the time, and still moves it.
		assert.equal(stream.tools[0].driver, driving);
		const aim = [0.01, 0.01, 0.02];
		driver.tell(`aim ${aim.join(' ')}`);
		await client.until(() => far(stream.tools[0].position, aim) < AT_AIM_M, 'it follows');
	});

const residentBytes = (process) =>
	1024 * Number(/VmRSS:\s*(\d+)/.exec(readFileSync(`/proc/${process.pid}/status`, 'utf8'))[1]);

test(`${MADE_UP_KEYS} made-up keys are counted and take no memory, and the driver goes on`, async (t) => {
	const { client, session, stream } = await watched(t, 'strangers');
	const driver = await controller(session, 'native');
	driver.tell('write on');
	const { driver: driving } = await driver.until((s) => s.driver_name.startsWith('dds '));
	const stranger = await controller(session, 'native');
	const refused = await daemon.metric('session_refused_total', session);
	const some = MADE_UP_KEYS / 10; // after these keys, every buffer on the way has its final size
	await stranger.ask(`strangers ${some}`, 'strangers');
	const before = residentBytes(daemon.process);
	await stranger.ask(`strangers ${MADE_UP_KEYS - some}`, 'strangers', 120);
	const aim = [0.01, 0.01, 0.02];
	driver.tell(`aim ${aim.join(' ')}`);
	await client.until(() => far(stream.tools[0].position, aim) < AT_AIM_M, 'it follows');
	while (await daemon.metric('session_refused_total', session) < refused + MADE_UP_KEYS)
		await stranger.state();
	const grown = residentBytes(daemon.process) - before;
	t.diagnostic(`${(before / 1e6).toFixed(1)} MB, grown by ${(grown / 1e6).toFixed(1)} MB`);
	assert.equal(await daemon.metric('session_refused_total', session), refused + MADE_UP_KEYS);
	await daemon.log(new RegExp(`session=${session} event=dds_refused .*samples were dropped because their session or tool`));
	if (!SLOW)
		assert.ok(grown < GROWTH_MOST_BYTES, `${grown} bytes`);
	assert.equal(stream.tools[0].driver, driving);
});
