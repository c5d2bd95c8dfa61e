// SPDX-License-Identifier: Apache-2.0
// A section of elements: which elements of an array change (run list) and their numbers, plain or in
// meshoptimizer's vertex codec, as values or as differences; see "Elements" in protocol/README.md.
import { MeshoptDecoder } from 'meshoptimizer/decoder';

import { viewOf, WireError } from './header';

const HEAD_BYTES = 12;
const CODING_PLAIN = 0;
const CODING_MESHOPT = 1;
const REFERENCE_PREVIOUS = 1;
const REFERENCE_HELD = 2;

/** Resolves when the codec is compiled; must be awaited before the first frame. */
export const decoderReady: Promise<void> = MeshoptDecoder.ready;

/** Start and length of each run of changed elements, one after the other. */
export type Runs = readonly number[];

interface Head {
  width: number;
  coding: number;
  reference: number;
  count: number;
  runBytes: number;
}

function readHead(payload: Uint8Array, components: number): Head {
  if (payload.byteLength < HEAD_BYTES) throw new WireError('elements without a head');
  const view = viewOf(payload);
  const head = {
    width: view.getUint8(0),
    coding: view.getUint8(2),
    reference: view.getUint8(3),
    count: view.getUint32(4, true),
    runBytes: view.getUint32(8, true),
  };
  if (head.width !== 1 && head.width !== 2 && head.width !== 4) throw new WireError(`elements of width ${head.width}`);
  if (view.getUint8(1) !== components) throw new WireError('elements with another number of components');
  if (head.coding > CODING_MESHOPT || head.reference > REFERENCE_HELD) throw new WireError('unknown coding');
  return head;
}

function readRuns(bytes: Uint8Array, count: number, elementCount: number): Runs {
  const runs: number[] = [];
  let offset = 0;
  let next = 0;
  let total = 0;
  const number = (): number => {
    let value = 0;
    for (let scale = 1; ; scale *= 128) {
      const byte = bytes[offset++];
      if (byte === undefined || scale > 2 ** 28) throw new WireError('a run list is cut off');
      value += (byte & 0x7f) * scale;
      if (byte < 0x80) return value;
    }
  };
  while (offset < bytes.byteLength) {
    const start = next + number();
    const length = number();
    if (length < 1 || start + length > elementCount) throw new WireError('a run beyond the array');
    runs.push(start, length);
    next = start + length;
    total += length;
  }
  if (total !== count) throw new WireError('runs that do not add up');
  return runs;
}

interface Numbers {
  bytes: Uint8Array;
  stride: number;
}

function padded(bytes: number): number {
  return Math.ceil(bytes / 4) * 4;
}

function readNumbers(data: Uint8Array, head: Head, components: number): Numbers {
  const packed = head.width * components;
  if (head.coding === CODING_PLAIN) {
    if (data.byteLength !== padded(packed * head.count)) throw new WireError('data of the wrong length');
    return { bytes: data, stride: packed };
  }
  if (data.byteLength < 4) throw new WireError('coded data without a length');
  const length = viewOf(data).getUint32(0, true);
  if (data.byteLength !== 4 + padded(length)) throw new WireError('coded data of the wrong length');
  const single = components === 1;
  const stride = single ? 4 : padded(packed);
  const vertices = single ? Math.ceil((packed * head.count) / 4) : head.count;
  const bytes = new Uint8Array(vertices * stride);
  if (vertices > 0) {
    try {
      MeshoptDecoder.decodeVertexBuffer(bytes, vertices, stride, data.subarray(4, 4 + length));
    } catch {
      throw new WireError('damaged coded data');
    }
  }
  return { bytes, stride: single ? packed : stride };
}

const SIGN_BITS: Readonly<Record<number, number>> = { 1: 0x80, 2: 0x8080, 4: 0x80808080 | 0 };

/**
 * Applies a section to `target` (elementCount x components, 32-bit values) and says which elements it
 * changed. `held` allows differences to what the target holds.
 */
export function applyElements(payload: Uint8Array, target: Int32Array, components: number, held: boolean): Runs {
  const head = readHead(payload, components);
  const runEnd = HEAD_BYTES + head.runBytes;
  const dataStart = HEAD_BYTES + padded(head.runBytes);
  if (dataStart > payload.byteLength) throw new WireError('a run list is cut off');
  const runs = readRuns(payload.subarray(HEAD_BYTES, runEnd), head.count, target.length / components);
  if (head.reference === REFERENCE_HELD && !held) throw new WireError('differences to a state in a frame that has none');
  const numbers = readNumbers(payload.subarray(dataStart), head, components);
  writeRuns(numbers, head, runs, target, components);
  return runs;
}

function writeRuns(numbers: Numbers, head: Head, runs: Runs, target: Int32Array, components: number): void {
  const { bytes, stride } = numbers;
  const { width, reference } = head;
  const sign = SIGN_BITS[width];
  const previous = new Int32Array(components);
  let source = 0;
  for (let run = 0; run < runs.length; run += 2) {
    let out = runs[run] * components;
    for (let i = 0; i < runs[run + 1]; i++, source += stride) {
      for (let c = 0; c < components; c++, out++) {
        const at = source + c * width;
        let value = bytes[at];
        if (width > 1) value |= bytes[at + 1] << 8;
        if (width > 2) value |= (bytes[at + 2] << 16) | (bytes[at + 3] << 24);
        if (reference === REFERENCE_PREVIOUS) {
          value = (previous[c] + ((value ^ sign) - sign)) | 0;
          previous[c] = value;
        } else if (reference === REFERENCE_HELD) {
          value = (target[out] + ((value ^ sign) - sign)) | 0;
        }
        target[out] = value;
      }
    }
  }
}
