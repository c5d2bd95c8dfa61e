// SPDX-License-Identifier: GPL-3.0-or-later
// Colour maps that stay ordered for colour-blind eyes and in grey, joined by straight lines: cividis (Nunez,
// Anderton and Renslow 2018), and for temperature YlOrRd (Brewer, colorbrewer2.org), from the body's pale
// yellow to a dark red, which cannot be taken for the other.

type Colour = readonly [number, number, number];

const SAMPLES = {
  cividis: [
    [0, 34, 78],
    [26, 56, 111],
    [67, 78, 108],
    [97, 101, 111],
    [125, 124, 120],
    [156, 148, 120],
    [190, 174, 110],
    [225, 203, 93],
    [254, 232, 56],
  ],
  heat: [
    [255, 255, 204],
    [255, 237, 160],
    [254, 217, 118],
    [254, 178, 76],
    [253, 141, 60],
    [252, 78, 42],
    [227, 26, 28],
    [189, 0, 38],
    [128, 0, 38],
  ],
} satisfies Record<string, readonly Colour[]>;
export type ColourMap = keyof typeof SAMPLES;

/** Scalars that can be shown as colour. Temperature has another colour map, so that it cannot be mistaken for exposure. */
export type Scalar = 'exposure' | 'charring' | 'stress' | 'temperature';
export const MAP_OF: Readonly<Record<Scalar, ColourMap>> = {
  exposure: 'cividis',
  charring: 'cividis',
  stress: 'cividis',
  temperature: 'heat',
};

/** Returns the colour at a value from 0 to 1, as sRGB bytes. */
export function colourAt(map: ColourMap, value: number): [number, number, number] {
  const samples: readonly Colour[] = SAMPLES[map];
  const place = Math.min(Math.max(value, 0), 1) * (samples.length - 1);
  const low = Math.min(Math.floor(place), samples.length - 2);
  const share = place - low;
  const channel = (c: 0 | 1 | 2): number => Math.round(samples[low][c] + (samples[low + 1][c] - samples[low][c]) * share);
  return [channel(0), channel(1), channel(2)];
}

/** Returns a whole colour map as RGBA bytes, for a texture or a legend. */
export function colourRow(map: ColourMap, width: number): Uint8Array {
  const row = new Uint8Array(4 * width);
  for (let i = 0; i < width; i++) row.set([...colourAt(map, i / (width - 1)), 255], 4 * i);
  return row;
}
