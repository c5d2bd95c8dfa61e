// SPDX-License-Identifier: GPL-3.0-or-later
import { readContacts } from '../../../../clients/web/src/wire/contacts';
import { WireError } from '../../../../clients/web/src/wire/header';

const NUMBERS = 29;

/** Returns a section like "Contact record" in protocol/README.md, with the numbers 1, 2, 3 and so on. */
function section(names: readonly string[], planes: number, spoilt?: number): Uint8Array {
  const parts = names.map((name) => {
    const first = 120 + 4 * Math.ceil(name.length / 4);
    const bytes = new Uint8Array(first + 20 * planes);
    const view = new DataView(bytes.buffer);
    bytes[0] = name.length;
    bytes[1] = 1;
    view.setUint16(2, planes, true);
    for (let i = 0; i < NUMBERS; i++) view.setFloat32(4 + 4 * i, i === spoilt ? NaN : i + 1, true);
    bytes.set(new TextEncoder().encode(name), 120);
    for (let i = 0; i < 5 * planes; i++) view.setFloat32(first + 4 * i, 100 + i, true);
    return bytes;
  });
  return Uint8Array.from([names.length, 0, 0, 0, ...parts.flatMap((part) => [...part])]);
}

describe('contacts of a frame', () => {
  it('are read one after the other', () => {
    const [hook, ball, ...others] = readContacts(section(['hook', 'ball-2'], 2));
    expect(others).toEqual([]);
    expect(ball?.name).toBe('ball-2');
    expect(hook).toEqual({
      name: 'hook', valid: true, askedPositionM: [1, 2, 3], askedRotation: [4, 5, 6, 7], positionM: [8, 9, 10], rotation: [11, 12, 13, 14], forceN: [15, 16, 17],
      complianceMN: [18, 19, 20, 21, 22, 23], friction: 24, dampingNsM: 25, graspNM: 26, graspAnchorM: [27, 28, 29],
      planes: [{ normal: [100, 101, 102], offsetM: 103, velocityMS: 104 }, { normal: [105, 106, 107], offsetM: 108, velocityMS: 109 }],
    });
  });

  it('are none in four bytes', () => expect(readContacts(section([], 0))).toEqual([]));

  it('are refused where they are cut off at any byte, or have more bytes', () => {
    const whole = section(['hook', 'ball'], 1);
    for (let length = 0; length < whole.length; length++) expect(() => readContacts(whole.slice(0, length)), `${length} bytes`).toThrow(WireError);
    expect(() => readContacts(Uint8Array.from([...whole, 0, 0, 0, 0]))).toThrow(WireError);
  });

  it('are refused where a number is none', () => {
    for (let i = 0; i < NUMBERS; i++) expect(() => readContacts(section(['hook'], 1, i))).toThrow(WireError);
  });
});
