// SPDX-License-Identifier: GPL-3.0-or-later
// Files of scenes that come, change and go while the daemon runs.
import assert from 'node:assert/strict';
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { Daemon } from './wire/daemon.mjs';

const PATIENCE_S = process.env.E2E_SLOW === '1' ? 60 : 10;

async function eventually(what, condition) {
	for (const end = Date.now() + 1000 * PATIENCE_S; ; await new Promise((resolve) => setTimeout(resolve, 50))) {
		if (await condition())
			return;
		assert.ok(Date.now() < end, `did not happen: ${what}`);
	}
}

test('a scene that is added to the folder, changed or removed is so for clients of a running daemon', async (t) => {
	const folder = mkdtempSync(join(tmpdir(), 'cautery-scenes-'));
	t.after(() => rmSync(folder, { recursive: true }));
	cpSync(process.env.SCENES, folder, { recursive: true });
	const daemon = await Daemon.start({ settings: { scenes: folder } });
	t.after(() => daemon.end());
	const client = await daemon.connect();
	const names = async () => (await client.call('scene.list')).scenes.map(({ name }) => name);
	const before = await names();
	const scene = { ...JSON.parse(readFileSync(join(folder, 'fascia.json'))), name: 'mine', description: 'first' };
	const file = join(folder, 'mine.json');
	const write = (text) => writeFileSync(file, text);
	write(JSON.stringify(scene));
	await eventually('the new scene is listed', async () => (await names()).includes('mine'));
	assert.equal((await client.call('scene.get', { scene: 'mine' })).definition.description, 'first');
	const { summary: { session } } = await client.call('session.create', { scene: 'mine', name: 'made', paused: true });
	write(JSON.stringify({ ...scene, description: 'second' }));
	await eventually('the changed scene is sent', async () =>
		(await client.call('scene.get', { scene: 'mine' })).definition.description === 'second');
	write('{"name": "mine", ');
	await daemon.log(/event=scenes_not_read .*mine\.json.*kept=true/);
	assert.equal((await client.call('scene.get', { scene: 'mine' })).definition.description, 'second');
	rmSync(file);
	await eventually('the removed scene is gone', async () => !(await names()).includes('mine'));
	await assert.rejects(client.call('session.create', { scene: 'mine' }), ({ data }) => data.status === 'not_found');
	assert.deepEqual(await names(), before);
	assert.equal((await client.call('session.step', { session, ticks: 1 })).tick, 1);
	await client.close();
});
