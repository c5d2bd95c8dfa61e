// SPDX-License-Identifier: GPL-3.0-or-later
// Compares decoded frames of the C encoder (write_frames) with the results of the C decoder, bit for bit:
// meshoptimizer's codec, all widths and references, 24 frames in a chain.
import { existsSync, readFileSync } from 'node:fs';
import { join } from 'node:path';

import type { ContactState } from '../../../../clients/web/src/wire/contacts';
import { FrameDecoder } from '../../../../clients/web/src/wire/decoder';
import { decoderReady } from '../../../../clients/web/src/wire/elements';
import { SCALARS, type ScalarName } from '../../../../clients/web/src/wire/messages.gen';
import { decodeTopology } from '../../../../clients/web/src/wire/topology';
import type { VesselState } from '../../../../clients/web/src/wire/vessels';

const folder = process.env['CAUTERY_FRAMES'];
const COLUMNS = 40;
const ROWS = 25;
const FRAMES = 24;
const SHAPE = {
  session_number: 3,
  profile: 1,
  vertex_count: COLUMNS * ROWS,
  face_count: 2 * (COLUMNS - 1) * (ROWS - 1),
};

function read(kind: string, number: number): Uint8Array {
  return new Uint8Array(readFileSync(join(folder ?? '', `${kind}-${String(number).padStart(2, '0')}.bin`)));
}

/** Expects vessels as tests/protocol/wire/tissue.c moves them: no vessels before tick 8. */
function expectVessels(vessels: readonly VesselState[], tick: number): void {
  if (tick < 8) {
    expect(vessels).toEqual([]);
    return;
  }
  const single = Math.fround;
  const points = Array.from({ length: 3 + (tick % 2) }, (_, i) => [single(0.001) * i, single(0.0001) * tick, -0.002, i === 1 ? -1 : 0.5]);
  expect(vessels).toEqual([{
    name: 'artery-1', parted: (tick & 1) !== 0, pierced: (tick & 2) !== 0, shut: (tick & 4) !== 0, sealed: (tick & 8) !== 0, bleeds: (tick & 16) !== 0,
    radiusM: single(0.0015), bleedingM3S: single(1e-9 * tick), shedM3: single(1e-8 * tick), burstPa: single(100 * tick),
    points: Float32Array.from(points.flat()),
  }]);
}

/** Expects contacts as tests/protocol/wire/tissue.c makes them: no contacts before tick 8. */
function expectContacts(contacts: readonly ContactState[], tick: number): void {
  if (tick < 8) {
    expect(contacts).toEqual([]);
    return;
  }
  expect(contacts).toEqual([{
    name: 'hook', valid: tick % 4 !== 3, askedPositionM: [0.5, 0.25, -0.125 * tick], askedRotation: [1, 0, 0, 0], positionM: [0.5, 0.25, 0], rotation: [0.5, 0.5, 0.5, 0.5],
    forceN: [0.125, -0.25, 0.5 * tick], complianceMN: [1, 2, 3, 0.125, 0.25, 0.5], friction: 0.25, dampingNsM: 0.5, graspNM: tick % 2 === 1 ? 256 : 0, graspAnchorM: [1, 2, 0.5 * tick],
    planes: [{ normal: [0, 0, 1], offsetM: 0.25 * tick, velocityMS: -0 }, { normal: [0, 1, 0], offsetM: 0.25 * tick, velocityMS: -0.5 }].slice(0, tick % 3),
  }]);
}

function expectState(decoder: FrameDecoder, number: number): void {
  const bytes = read('state', number);
  const view = new DataView(bytes.buffer, bytes.byteOffset);
  const { state } = decoder;
  expect(state.epoch).toBe(view.getBigUint64(0, true));
  expect(state.sequence).toBe(Number(view.getBigUint64(8, true)));
  expect(state.tick).toBe(Number(view.getBigUint64(16, true)));
  let offset = 24;
  const scalars = (Object.keys(SCALARS) as ScalarName[]).map((name) => state[name]);
  for (const array of [state.quantised, state.mask, ...scalars]) {
    const wanted = bytes.slice(offset, offset + array.byteLength);
    expect(Buffer.compare(new Uint8Array(array.buffer), wanted), `array at ${offset} of frame ${number}`).toBe(0);
    offset += array.byteLength;
  }
  expect(offset).toBe(bytes.byteLength);
}

describe.skipIf(folder === undefined || !existsSync(join(folder, 'frame-00.bin')))('frames of the C encoder', () => {
  beforeAll(async () => decoderReady);

  it('makes the same state after every frame', () => {
    const decoder = new FrameDecoder(SHAPE);
    for (let i = 0; i < FRAMES; i++) {
      expect(decoder.decode(read('frame', i)).kind).toBe('applied');
      expectState(decoder, i);
      expectVessels(decoder.state.vessels, decoder.state.tick);
      expectContacts(decoder.state.contacts, decoder.state.tick);
      // tests/protocol/wire/tissue.c sends raw forces in these frames
      for (const { raw } of decoder.state.tools) expect(raw !== null).toBe(i % 5 !== 4);
    }
    const last = FRAMES - 1;
    expect(decoder.state.tools[0]?.raw).toEqual({ forceN: [0, 1, 2].map((c) => 0.125 * (last + c)), torqueNm: [0, 1, 2].map((c) => -0.0625 * (last + c)), filterS: Math.fround(0.02 * (last % 3)) });
    expect(decoder.state.tools.map((tool) => tool.name)).toEqual(['hook', 'left-grasper']);
    expect(decoder.state.statistics).toMatchObject({ iterations: 10, contacts: FRAMES - 1, contactsLeftOut: 2 * (FRAMES - 1), elementsTorn: 3 * (FRAMES - 1), touchingCutShort: 5 * (FRAMES - 1) });
    expect(decoder.state.statistics?.stageS.slice(0, 2)).toEqual([0.25, 0.5]);
  });

  it('makes the state of the chain from one key frame', () => {
    const decoder = new FrameDecoder(SHAPE);
    expect(decoder.decode(read('key', FRAMES - 1))).toMatchObject({ kind: 'applied', key: true });
    expectState(decoder, FRAMES - 1);
    expectVessels(decoder.state.vessels, FRAMES - 1);
    expectContacts(decoder.state.contacts, FRAMES - 1);
  });

  it('reads the topology', () => {
    const topology = decodeTopology(SHAPE, read('topology', 0));
    expect([...topology.faces.subarray(0, 6)]).toEqual([0, 1, 2, 7, 8, 9]);
    expect([...topology.faceLayers.subarray(0, 4)]).toEqual([0, 1, 2, 0]);
    expect([...topology.texture!.subarray(6, 12)]).toEqual([0.25, -0, 0.25, -0.5, 0.25, -1]);
    expect(topology.rest[3]).toBe(40);
  });
});
