// SPDX-License-Identifier: Apache-2.0
// The fixed start of every frame and the walk over its sections; layouts in protocol/README.md.
import { FRAME_KIND, WIRE_VERSION } from './messages.gen';

/** The bytes violate the format; the held state may be lost. */
export class WireError extends Error {}

export type FrameKind = 'key' | 'delta' | 'topology';

export interface FrameHeader {
  kind: FrameKind;
  paused: boolean;
  faulted: boolean;
  session: number;
  epoch: bigint;
  sequence: number;
  baseSequence: number;
  tick: number;
  timeS: number;
  publishedUs: number;
  profile: number;
  sectionCount: number;
}

export const HEADER_BYTES = 72;
const SECTION_HEAD_BYTES = 8;
const FRAME_MAGIC = 0x46554143; // "CAUF", little-endian
const FLAG_PAUSED = 1;
const FLAG_FAULTED = 2;

const KINDS: Readonly<Record<number, FrameKind>> = {
  [FRAME_KIND.key]: 'key',
  [FRAME_KIND.delta]: 'delta',
  [FRAME_KIND.topology]: 'topology',
};

export function viewOf(bytes: Uint8Array): DataView {
  return new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
}

function unsigned64(view: DataView, offset: number): number {
  const value = view.getBigUint64(offset, true);
  if (value > BigInt(Number.MAX_SAFE_INTEGER)) throw new WireError('a count beyond 2^53');
  return Number(value);
}

export function isFrame(bytes: Uint8Array): boolean {
  return bytes.byteLength >= HEADER_BYTES && viewOf(bytes).getUint32(0, true) === FRAME_MAGIC;
}

export function readHeader(bytes: Uint8Array): FrameHeader {
  if (!isFrame(bytes)) throw new WireError('not a frame');
  const view = viewOf(bytes);
  if (view.getUint8(4) !== WIRE_VERSION) throw new WireError(`frame version ${view.getUint8(4)} is not spoken here`);
  const kind = KINDS[view.getUint8(5)];
  if (kind === undefined) throw new WireError(`unknown frame kind ${view.getUint8(5)}`);
  if (view.getUint32(8, true) !== bytes.byteLength) throw new WireError('the frame is not as long as it says');
  const flags = view.getUint16(6, true);
  return {
    kind,
    paused: (flags & FLAG_PAUSED) !== 0,
    faulted: (flags & FLAG_FAULTED) !== 0,
    session: view.getUint32(12, true),
    epoch: view.getBigUint64(16, true),
    sequence: unsigned64(view, 24),
    baseSequence: unsigned64(view, 32),
    tick: unsigned64(view, 40),
    timeS: view.getFloat64(48, true),
    publishedUs: unsigned64(view, 56),
    profile: view.getUint16(64, true),
    sectionCount: view.getUint16(66, true),
  };
}

/** Returns the payloads by section type, ascending. Unknown types are kept; readers skip them. */
export function readSections(bytes: Uint8Array, count: number): Map<number, Uint8Array> {
  const view = viewOf(bytes);
  const sections = new Map<number, Uint8Array>();
  let offset = HEADER_BYTES;
  let last = -1;
  for (let i = 0; i < count; i++) {
    if (offset + SECTION_HEAD_BYTES > bytes.byteLength) throw new WireError('a section is cut off');
    const type = view.getUint8(offset);
    const length = view.getUint32(offset + 4, true);
    const start = offset + SECTION_HEAD_BYTES;
    if (type <= last || length % 4 !== 0 || start + length > bytes.byteLength)
      throw new WireError(`section ${type} is out of order or cut off`);
    sections.set(type, bytes.subarray(start, start + length));
    last = type;
    offset = start + length;
  }
  if (offset !== bytes.byteLength) throw new WireError('bytes after the last section');
  return sections;
}
