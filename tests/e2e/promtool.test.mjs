// SPDX-License-Identifier: GPL-3.0-or-later
// Prometheus' own check of /metrics. Ends with 77, for skipped, where promtool is missing.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';
import { smallSession } from './wire/scene.mjs';

if (spawnSync('promtool', ['--version']).error) {
	console.log('skipped: there is no promtool (package prometheus)');
	process.exit(77);
}

test('promtool finds nothing, with several sessions', async () => {
	const daemon = await Daemon.start();
	const client = await daemon.connect();
	for (const name of ['a', 'a-a', 'a_a', 'total'])
		await client.join(await smallSession(client, name));
	const { bytes } = await daemon.get('/metrics');
	const checked = spawnSync('promtool', ['check', 'metrics'], { input: bytes, encoding: 'utf8' });
	assert.equal(checked.stdout + checked.stderr, '');
	assert.equal(checked.status, 0);
	await daemon.end();
});
