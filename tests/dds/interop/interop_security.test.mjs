// SPDX-License-Identifier: GPL-3.0-or-later
// Tests DDS Security across vendors. A Fast DDS robot with an identity of the domain's authority drives a tool of the
// real daemon. A robot without an identity finds no daemon.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { after, before, test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';
import { DOMAIN } from './domain.mjs';
import { Program } from './program.mjs';
import { far, watchSession } from './watch.mjs';

const DEADLINE_MS = 500; // generous, because this test is not about being late
const AT_AIM_M = 1e-4;
const MAKE = join(dirname(process.env.PROFILE), 'security', 'make.sh');

const folder = mkdtempSync(join(tmpdir(), 'cautery-keys-'));
const enclave = (name) => join(folder, 'enclaves', name);

let daemon;
before(async () => {
	execFileSync(MAKE, [folder], { stdio: 'pipe' });
	daemon = await Daemon.start({
		settings: { dds: true, dds_domain: DOMAIN, dds_deadline_s: DEADLINE_MS / 1000, dds_security: enclave('daemon') },
	});
});
after(async () => {
	await daemon?.end();
	rmSync(folder, { recursive: true });
});

const watched = (t, name) => watchSession(t, daemon, name);

// Starts a robot with this identity; null: without an identity.
function robot(t, session, via, identity) {
	const profile = identity ? join(enclave(identity), 'loopback-fastdds.xml') : process.env.PROFILE;
	const made = new Program(process.env.INTEROP_ROBOT, [DOMAIN, session, 'hook', via, DEADLINE_MS],
		{ environment: { FASTRTPS_DEFAULT_PROFILES_FILE: profile } });
	t.after(() => made.end());
	return made;
}

for (const via of ['native', 'ros'])
	test(`Fast DDS with an identity drives over ${via} topics, and decodes frames; without one it finds nobody`, async (t) => {
		const { client, session, stream } = await watched(t, `secured-${via}`);
		const outsider = robot(t, session, via, null); // the outsider starts before the robot with an identity
		outsider.event((e) => e.event === 'matched', 'matched').then(() => (outsider.joined = true), () => {});
		outsider.tell('write on');
		const made = robot(t, session, via, 'controller');
		await made.event((e) => e.event === 'matched', 'matched');
		made.tell('write on');
		await client.until(() => stream.tools[0].driver !== 0, 'it drives');
		await daemon.log(/ event=dds_client .*subject="CN=controller,O=Cautery"/);
		const aim = [0.01, -0.005, 0.015];
		made.tell(`aim ${aim.join(' ')}`);
		await client.until(() => far(stream.tools[0].position, aim) < AT_AIM_M, 'the pose in a frame');
		const { stream: seen } = await made.until(({ native, stream: s }) =>
			far(native.position_m, aim) < AT_AIM_M && s.applied > 30);
		assert.equal(seen.refused, 0, seen.reason);

		const { native, cp, status, stream: frames } = await outsider.ask('state');
		assert.deepEqual([native.count, cp.count, status.session, frames.keys], [0, 0, '', 0]);
		assert.ok(!outsider.joined, 'it found nobody to write to');
	});

test('Fast DDS may write no commands as a viewer', async (t) => {
	const { session } = await watched(t, 'secured-viewer');
	assert.equal((await robot(t, session, 'native', 'viewer').exited).code, 1);
	assert.equal((await robot(t, session, 'ros', 'viewer').exited).code, 1);
});
