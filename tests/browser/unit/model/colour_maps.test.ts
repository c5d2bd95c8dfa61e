// SPDX-License-Identifier: GPL-3.0-or-later
// Tests colour maps as colour-blind eyes see them (Vienot, Brettel and Mollon 1999) and in grey.
import { colourAt, colourRow, type ColourMap } from '../../../../clients/web/src/model/colour_maps';

const STEPS = 64;
const LEAST_STEP = 1e-3; // least change of lightness, 0 to 1, in a step: every step must change it
const LEAST_RANGE = 0.4;
const EYES: Record<string, number[][]> = {
  'all colours': [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
  'no red cones': [[0.11238, 0.88762, 0], [0.11238, 0.88762, 0], [0.00401, -0.00401, 1]],
  'no green cones': [[0.29275, 0.70725, 0], [0.29275, 0.70725, 0], [-0.02234, 0.02234, 1]],
};

/** Returns L* of CIE 1976 divided by 100, of the colour that these eyes see. */
function lightness(colour: readonly number[], eyes: readonly number[][]): number {
  const linear = colour.map((byte) => (byte / 255 <= 0.04045 ? byte / 255 / 12.92 : ((byte / 255 + 0.055) / 1.055) ** 2.4));
  const seen = eyes.map((row) => row.reduce((sum, weight, c) => sum + weight * linear[c], 0));
  const luminance = 0.2126 * seen[0] + 0.7152 * seen[1] + 0.0722 * seen[2];
  return luminance > 0.008856 ? 1.16 * Math.cbrt(luminance) - 0.16 : 9.033 * luminance;
}

describe.each<[ColourMap, number]>([['cividis', 1], ['heat', -1]])('the colour map %s', (map, direction) => {
  it.each(Object.entries(EYES))('gets steadily lighter or darker for eyes with %s', (_, eyes) => {
    const shades = Array.from({ length: STEPS + 1 }, (_step, i) => direction * lightness(colourAt(map, i / STEPS), eyes));
    for (let i = 1; i <= STEPS; i++) expect(shades[i] - shades[i - 1], `step ${i}`).toBeGreaterThan(LEAST_STEP);
    expect(shades[STEPS] - shades[0]).toBeGreaterThan(LEAST_RANGE);
  });

  it('is as long as asked for, opaque, and ends where it ends', () => {
    const row = colourRow(map, 9);
    expect(row).toHaveLength(36);
    expect([...row.subarray(0, 4)]).toEqual([...colourAt(map, -1), 255]);
    expect([...row.subarray(32)]).toEqual([...colourAt(map, 2), 255]);
  });
});

describe('the two colour maps', () => {
  it('cannot be taken for each other', () => {
    for (let i = 0; i <= STEPS; i++) {
      const [a, b] = [colourAt('cividis', i / STEPS), colourAt('heat', i / STEPS)];
      expect(Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]), `step ${i}`).toBeGreaterThan(60);
    }
  });
});
