// SPDX-License-Identifier: GPL-3.0-or-later
import { FrameDecoder } from '../../../../clients/web/src/wire/decoder';
import { decoderReady } from '../../../../clients/web/src/wire/elements';
import { WireError } from '../../../../clients/web/src/wire/header';
import { decodeTopology } from '../../../../clients/web/src/wire/topology';
import { isChunk, readChunk, writeChunk } from '../../../../clients/web/src/wire/chunk';
import { example } from './examples';

const SHAPE = { session_number: 7, profile: 1, vertex_count: 3, face_count: 1 };
const KEY = example('A key frame');
const DELTA = example('The delta after it');

function inStep(): FrameDecoder {
  const decoder = new FrameDecoder(SHAPE);
  decoder.decode(KEY);
  return decoder;
}

function changed(bytes: Uint8Array, offset: number, value: number): Uint8Array {
  const copy = bytes.slice();
  copy[offset] = value;
  return copy;
}

beforeAll(async () => decoderReady);

describe('the frames of protocol/examples.md', () => {
  it('makes the state of the key frame', () => {
    const { state } = inStep();
    expect([...state.quantised]).toEqual([0, 0, 0, 20, 0, 0, 0, 20, -1]);
    expect(state).toMatchObject({ synced: true, epoch: 0x0123456789abcdefn, sequence: 1, tick: 60, timeS: 1 });
    expect(state.tools).toHaveLength(1);
    expect(state.tools[0]).toMatchObject({ name: 'hook', shape: 'hook', driver: 2, energized: false, jaw: 0 });
    expect(state.tools[0]?.positionM).toEqual([0.5, 0.25, 0]);
  });

  it('takes the delta after it', () => {
    const decoder = inStep();
    const outcome = decoder.decode(DELTA);
    expect(outcome).toEqual({
      kind: 'applied',
      key: false,
      changes: { whole: false, moved: [1, 1], maskWords: [0, 1], scalars: true },
    });
    expect([...decoder.state.quantised]).toEqual([0, 0, 0, 24, 0, 0, 0, 20, -1]);
    expect([...decoder.state.exposure]).toEqual([0, 0, 255]);
    expect(decoder.state.mask[0]).toBe(1);
    expect(decoder.state.tools[0]).toMatchObject({ energized: true, sequence: 12, name: 'hook' });
  });

  it('reads the topology', () => {
    const topology = decodeTopology(SHAPE, example('A topology frame'));
    expect([...topology.faces]).toEqual([0, 1, 2]);
    expect([...topology.faceLayers]).toEqual([0]);
    expect(topology.texture).toBeNull();
    expect([...topology.rest]).toEqual([0, 0, 0, 20, 0, 0, 0, 20, 0]);
  });

  it('reads and writes the chunk', () => {
    const bytes = example('A chunk');
    expect(isChunk(bytes)).toBe(true);
    const chunk = readChunk(bytes);
    expect(new TextDecoder().decode(chunk.data)).toBe('hello');
    expect(chunk).toMatchObject({ transfer: 3, offset: 262144 });
    expect(writeChunk(chunk)).toEqual(bytes);
  });
});

describe('the rules of streams', () => {
  it('skips a delta before a key frame and says that it is a gap', () => {
    const decoder = new FrameDecoder(SHAPE);
    expect(decoder.decode(DELTA)).toMatchObject({ kind: 'skipped', gap: true });
    expect(decoder.state.synced).toBe(false);
  });

  it.each([
    ['another session', 12, 8, false],
    ['another profile', 64, 2, false],
    ['another epoch', 16, 0, true],
    ['another base', 32, 9, true],
  ])('keeps what it holds at a delta of %s', (_, offset, value, gap) => {
    const decoder = inStep();
    const later = changed(DELTA, 24, 12);
    expect(decoder.decode(changed(later, offset, value))).toMatchObject({ kind: 'skipped', gap });
    expect(decoder.state).toMatchObject({ synced: true, sequence: 1 });
    expect([...decoder.state.quantised.subarray(3, 6)]).toEqual([20, 0, 0]);
  });

  it('does not apply a delta twice', () => {
    const decoder = inStep();
    decoder.decode(DELTA);
    expect(decoder.decode(DELTA)).toMatchObject({ kind: 'skipped', gap: false });
    expect(decoder.state.quantised[3]).toBe(24);
  });

  it('takes a key frame of another epoch at any time, an older one of its own never', () => {
    const decoder = inStep();
    decoder.decode(DELTA);
    expect(decoder.decode(KEY).kind).toBe('skipped');
    expect(decoder.decode(changed(KEY, 16, 1))).toMatchObject({ kind: 'applied', key: true });
    expect([...decoder.state.exposure]).toEqual([0, 0, 0]);
    expect(decoder.state.mask[0]).toBe(0);
  });
});

describe('damage', () => {
  const damaged = (bytes: Uint8Array): void => {
    const decoder = inStep();
    expect(() => decoder.decode(bytes)).toThrow(WireError);
  };

  it('refuses what is cut off at any byte', () => {
    for (let length = 0; length < DELTA.length; length++) damaged(DELTA.slice(0, length));
  });

  it('refuses lengths that lie, at any cut', () => {
    for (let length = 72; length < DELTA.length; length += 4) {
      const cut = DELTA.slice(0, length);
      new DataView(cut.buffer).setUint32(8, length, true);
      damaged(cut);
    }
  });

  it('refuses a run beyond the array and waits for a key frame', () => {
    const decoder = inStep();
    expect(() => decoder.decode(changed(DELTA, 0x5c, 3))).toThrow(WireError);
    expect(decoder.state.synced).toBe(false);
    expect(decoder.decode(KEY).kind).toBe('applied');
  });

  it('never throws anything else, whatever byte is changed', () => {
    for (let offset = 0; offset < DELTA.length; offset++) {
      for (const value of [0, 1, 0x7f, 0x80, 0xff]) {
        try {
          inStep().decode(changed(DELTA, offset, value));
        } catch (error) {
          expect(error).toBeInstanceOf(WireError);
        }
      }
    }
  });

  it('refuses another version in words', () => {
    expect(() => inStep().decode(changed(KEY, 4, 2))).toThrow('frame version 2');
  });
});
