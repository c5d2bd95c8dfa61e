// SPDX-License-Identifier: GPL-3.0-or-later
// Tests a cut that is recorded as MCAP, by the page and by `cautery record --mcap` at the same time. The format's own
// library reads both files.
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

import { SceneUpdate as PUBLISHED } from '@foxglove/schemas/jsonschema';
import type { SceneUpdate } from '@foxglove/schemas';
import { McapIndexedReader } from '@mcap/core';
import Ajv from 'ajv';

import { Stage } from './stage';

const HOT_C = 900;
const STEP_NS = 100_000_000n;
const SHARE_TAKEN = 0.5; // least share of the steps between the first and the last: a busy machine misses some steps

interface Recorded {
  schema: unknown;
  messages: { timeNs: bigint; update: SceneUpdate }[];
}

async function read(file: string): Promise<Recorded> {
  const bytes = readFileSync(file);
  const reader = await McapIndexedReader.Initialize({
    readable: {
      size: () => Promise.resolve(BigInt(bytes.byteLength)),
      read: (offset, length) => Promise.resolve(new Uint8Array(bytes.subarray(Number(offset), Number(offset + length)))),
    },
  });
  const [channel, ...others] = reader.channelsById.values();
  expect(others).toEqual([]);
  expect(channel).toMatchObject({ topic: '/scene', messageEncoding: 'json' });
  const schema = reader.schemasById.get(channel.schemaId)!;
  expect(schema).toMatchObject({ name: 'foxglove.SceneUpdate', encoding: 'jsonschema' });
  const messages: Recorded['messages'] = [];
  for await (const { logTime, data } of reader.readMessages())
    messages.push({ timeNs: logTime, update: JSON.parse(new TextDecoder().decode(data)) as SceneUpdate });
  expect(reader.statistics?.messageCount).toBe(BigInt(messages.length));
  return { schema: JSON.parse(new TextDecoder().decode(schema.data)), messages };
}

/** Returns a schema without its descriptions. */
function bare(schema: unknown): unknown {
  if (Array.isArray(schema)) return schema.map(bare);
  if (typeof schema !== 'object' || schema === null) return schema;
  const kept = Object.entries(schema).filter(([key, value]) => !(['description', '$comment'].includes(key) && typeof value === 'string'));
  return Object.fromEntries(kept.map(([key, value]) => [key, bare(value)]));
}

const triangleCount = (update: SceneUpdate): number =>
  update.entities.flatMap((entity) => entity.triangles).reduce((sum, { indices }) => sum + indices.length / 3, 0);
const tickOf = (update: SceneUpdate): string => update.entities[0].metadata.find(({ key }) => key === 'tick')!.value;

function checkTimes(messages: Recorded['messages']): void {
  const steps = messages.slice(1).map(({ timeNs }, i) => timeNs - messages[i].timeNs);
  for (const step of steps) expect(step > 0n && step % STEP_NS === 0n, `${step} ns between two messages`).toBe(true);
  const all = Number((messages.at(-1)!.timeNs - messages[0].timeNs) / STEP_NS);
  expect(messages.length).toBeGreaterThan(10);
  expect(steps.length).toBeGreaterThanOrEqual(SHARE_TAKEN * all);
  for (const { timeNs, update } of messages)
    for (const { timestamp } of update.entities) expect(BigInt(timestamp.sec) * 1_000_000_000n + BigInt(timestamp.nsec)).toBe(timeNs);
}

function checkScenes(messages: Recorded['messages'], whole: number, left: number): void {
  const valid = new Ajv({ strict: false }).compile(PUBLISHED);
  for (const { update } of messages) {
    expect(valid(update), JSON.stringify(valid.errors)).toBe(true);
    expect(update.entities.map(({ id }) => id)).toEqual(['tissue', 'tool hook']);
    for (const { points, indices } of update.entities[0].triangles)
      expect(indices.reduce((most, index) => Math.max(most, index), -1)).toBe(points.length - 1);
  }
  const counts = messages.map(({ update }) => triangleCount(update));
  expect(counts[0]).toBe(whole);
  expect(counts.at(-1)).toBe(left);
}

describe('a recording as MCAP', () => {
  const stage = new Stage(['--demo', 'fascia']);
  const folder = mkdtempSync(join(tmpdir(), 'cautery-mcap-'));
  const written = join(folder, 'written.mcap');
  const saved = join(folder, 'saved.mcap');
  let whole = 0;
  let left = 0;

  beforeAll(async () => {
    const program = process.env['CAUTERY'];
    if (program === undefined) throw new Error('CAUTERY names no command line');
    const viewer = await stage.open();
    const { page } = viewer;
    await viewer.live('d1-fascia');
    await viewer.heatTool(HOT_C);
    whole = await viewer.faces();
    await page.getByRole('tab', { name: 'View' }).click();
    await page.getByRole('button', { name: 'Record as MCAP' }).click();
    const url = stage.daemon.url.replace('http', 'ws');
    const command = spawn(program, ['record', '--mcap', written, '--seconds', '600', '--url', url], { stdio: ['ignore', 'ignore', 'pipe'] });
    const ended = once(command, 'exit');
    await once(command.stderr, 'data'); // the program has written its first message
    await viewer.grab([-0.02, 0, 0]);
    await viewer.cut(0, 0, -0.02, -0.012, 2);
    await viewer.pause(); // after the pause, both recorders get the same last state
    left = await viewer.faces();
    await page.evaluate(() => new Promise((resolve) => setTimeout(resolve, 300))); // waits for three steps of the recordings
    const [download] = await Promise.all([page.waitForEvent('download'), page.getByRole('button', { name: 'Stop and save the MCAP file' }).click()]);
    expect(download.suggestedFilename()).toMatch(/^cautery-d1-fascia-\d+\.mcap$/);
    await download.saveAs(saved);
    command.kill('SIGINT');
    expect(await ended).toEqual([0, null]);
    expect(viewer.complaints).toEqual([]);
    await viewer.close();
  });
  afterAll(() => rmSync(folder, { recursive: true, force: true }));

  it('by the page, has ten scenes a second with the faces that are present', async () => {
    const { schema, messages } = await read(saved);
    expect(schema).toEqual(PUBLISHED);
    checkTimes(messages);
    checkScenes(messages, whole, left);
  });

  it('by the command line, has the same, under the same schema without its explanations', async () => {
    const { schema, messages } = await read(written);
    expect(schema).toEqual(bare(PUBLISHED));
    checkTimes(messages);
    checkScenes(messages, whole, left);
    expect(left).toBeLessThan(whole);
  });

  it('is the same by both where both have seen the same tick', async () => {
    const byTick = new Map((await read(written)).messages.map(({ update }) => [tickOf(update), update]));
    const both = (await read(saved)).messages.filter(({ update }) => byTick.has(tickOf(update)));
    expect(both.length).toBeGreaterThan(0);
    for (const { update } of both) {
      const other = byTick.get(tickOf(update))!;
      const extent = (of: SceneUpdate): number[] => of.entities[0].triangles.map(({ indices }) => indices.length);
      expect(extent(other)).toEqual(extent(update));
      const place = (of: SceneUpdate): number[] => Object.values(of.entities[1].spheres[0].pose.position);
      place(other).forEach((metres, c) => expect(metres).toBeCloseTo(place(update)[c], 6));
    }
  });
});
