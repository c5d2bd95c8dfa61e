// SPDX-License-Identifier: GPL-3.0-or-later
// A worker that exists while a recording runs. It writes the shown scene into an MCAP file in memory.
import { SceneUpdate } from '@foxglove/schemas/jsonschema';
import { McapWriter } from '@mcap/core';

import { sceneUpdate, type SeenMoment } from '../model/scene_update';

export type ToMcap = { type: 'moment'; moment: SeenMoment } | { type: 'end' };
/** `full`: the file has reached its limit and should be saved */
export type FromMcap = { type: 'full' } | { type: 'file'; file: Blob; messages: number } | { type: 'failure'; message: string };

interface WorkerScope {
  postMessage(message: FromMcap): void;
  onmessage: ((event: MessageEvent<ToMcap>) => void) | null;
}
const scope = self as unknown as WorkerScope;

const FILE_BYTES_MAX = 1_000_000_000n; // four minutes of a scene of 12 000 faces; players in a page read no larger files
const PART_BYTES = 8 << 20; // size of each Blob; browsers move Blobs to the disk if memory runs short

const parts: Blob[] = [];
let loose: Uint8Array<ArrayBuffer>[] = [];
let looseBytes = 0;
let bytes = 0n;
let messages = 0;
let full = false;
const encoder = new TextEncoder();

const pack = (): void => {
  parts.push(new Blob(loose));
  loose = [];
  looseBytes = 0;
};

const writer = new McapWriter({
  writable: {
    write: (buffer: Uint8Array) => {
      loose.push(buffer.slice());
      looseBytes += buffer.byteLength;
      bytes += BigInt(buffer.byteLength);
      if (looseBytes >= PART_BYTES) pack();
      return Promise.resolve();
    },
    position: () => bytes,
  },
});

async function begin(): Promise<number> {
  await writer.start({ profile: '', library: 'cautery-viewer' });
  const schemaId = await writer.registerSchema({
    name: 'foxglove.SceneUpdate',
    encoding: 'jsonschema',
    data: encoder.encode(JSON.stringify(SceneUpdate)),
  });
  return writer.registerChannel({ schemaId, topic: '/scene', messageEncoding: 'json', metadata: new Map() });
}

async function take(channelId: number, moment: SeenMoment): Promise<void> {
  if (full) return;
  const data = encoder.encode(JSON.stringify(sceneUpdate(moment)));
  await writer.addMessage({ channelId, sequence: messages++, logTime: moment.timeNs, publishTime: moment.timeNs, data });
  full = bytes > FILE_BYTES_MAX;
  if (full) scope.postMessage({ type: 'full' });
}

async function end(): Promise<void> {
  await writer.end();
  pack();
  scope.postMessage({ type: 'file', file: new Blob(parts, { type: 'application/octet-stream' }), messages });
}

// The writer handles one message at a time.
let last: Promise<unknown> = begin();
const channel = last as Promise<number>;
scope.onmessage = ({ data }) => {
  last = last
    .then(async () => (data.type === 'end' ? end() : take(await channel, data.moment)))
    .catch((error: unknown) => scope.postMessage({ type: 'failure', message: String(error) }));
};
