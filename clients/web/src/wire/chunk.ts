// SPDX-License-Identifier: Apache-2.0
// Files in binary chunks: "Chunks" in protocol/README.md.
import { viewOf, WireError } from './header';

const CHUNK_MAGIC = 0x43554143; // "CAUC", little-endian
const CHUNK_HEAD_BYTES = 16;

export interface Chunk {
  transfer: number;
  offset: number;
  data: Uint8Array;
}

export function isChunk(bytes: Uint8Array): boolean {
  return bytes.byteLength > CHUNK_HEAD_BYTES && viewOf(bytes).getUint32(0, true) === CHUNK_MAGIC;
}

export function readChunk(bytes: Uint8Array): Chunk {
  if (!isChunk(bytes)) throw new WireError('not a chunk');
  const view = viewOf(bytes);
  return {
    transfer: view.getUint32(4, true),
    offset: Number(view.getBigUint64(8, true)),
    data: bytes.subarray(CHUNK_HEAD_BYTES),
  };
}

export function writeChunk(chunk: Chunk): Uint8Array<ArrayBuffer> {
  const bytes = new Uint8Array(CHUNK_HEAD_BYTES + chunk.data.byteLength);
  const view = viewOf(bytes);
  view.setUint32(0, CHUNK_MAGIC, true);
  view.setUint32(4, chunk.transfer, true);
  view.setBigUint64(8, BigInt(chunk.offset), true);
  bytes.set(chunk.data, CHUNK_HEAD_BYTES);
  return bytes;
}
