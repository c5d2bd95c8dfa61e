// SPDX-License-Identifier: GPL-3.0-or-later
import { WireError } from '../../../../clients/web/src/wire/header';
import { readVessels } from '../../../../clients/web/src/wire/vessels';

interface Written {
  name: string;
  flags: number;
  numbers: readonly [number, number, number, number];
  points: readonly number[];
}

/** Returns a section like "Vessel record" in protocol/README.md. */
function section(vessels: readonly Written[]): Uint8Array {
  const parts = vessels.map(({ name, flags, numbers, points }) => {
    const padded = 4 * Math.ceil(name.length / 4);
    const bytes = new Uint8Array(20 + padded + 4 * points.length);
    const view = new DataView(bytes.buffer);
    bytes[0] = name.length;
    bytes[1] = flags;
    view.setUint16(2, points.length / 4, true);
    numbers.forEach((number, i) => view.setFloat32(4 + 4 * i, number, true));
    bytes.set(new TextEncoder().encode(name), 20);
    points.forEach((number, i) => view.setFloat32(20 + padded + 4 * i, number, true));
    return bytes;
  });
  return Uint8Array.from([vessels.length, 0, 0, 0, ...parts.flatMap((part) => [...part])]);
}

const ARTERY: Written = { name: 'artery', flags: 1 | 16, numbers: [0.5, 0.25, 2, 0], points: [0, 1, 2, 1, 3, 4, 5, -1] };
const VEIN: Written = { name: 'vein', flags: 2 | 4 | 8, numbers: [1, 0, 0, 1024], points: [] };

describe('vessels of a frame', () => {
  it('are read one after the other', () => {
    const [artery, vein, ...others] = readVessels(section([ARTERY, VEIN]));
    expect(others).toEqual([]);
    expect(artery).toEqual({
      name: 'artery', parted: true, pierced: false, shut: false, sealed: false, bleeds: true,
      radiusM: 0.5, bleedingM3S: 0.25, shedM3: 2, burstPa: 0, points: Float32Array.from(ARTERY.points),
    });
    expect(vein).toEqual({
      name: 'vein', parted: false, pierced: true, shut: true, sealed: true, bleeds: false,
      radiusM: 1, bleedingM3S: 0, shedM3: 0, burstPa: 1024, points: new Float32Array(0),
    });
  });

  it('are none in four bytes', () => expect(readVessels(section([]))).toEqual([]));

  it('are refused where they are cut off at any byte, or have more bytes', () => {
    const whole = section([ARTERY, VEIN]);
    for (let length = 0; length < whole.length; length++) expect(() => readVessels(whole.slice(0, length)), `${length} bytes`).toThrow(WireError);
    expect(() => readVessels(Uint8Array.from([...whole, 0, 0, 0, 0]))).toThrow(WireError);
  });

  it('are refused where a number is none', () => {
    expect(() => readVessels(section([{ ...ARTERY, numbers: [NaN, 0, 0, 0] }]))).toThrow(WireError);
    expect(() => readVessels(section([{ ...ARTERY, points: [0, Infinity, 0, 1] }]))).toThrow(WireError);
  });
});
