// SPDX-License-Identifier: GPL-3.0-or-later
// Colour maps that stay ordered for colour-blind eyes and in grey: cividis (Nunez, Anderton and
// Renslow 2018), sampled at nine points and joined by straight lines.

const CIVIDIS: readonly (readonly [number, number, number])[] = [
  [0, 34, 78],
  [26, 56, 111],
  [67, 78, 108],
  [97, 101, 111],
  [125, 124, 120],
  [156, 148, 120],
  [190, 174, 110],
  [225, 203, 93],
  [254, 232, 56],
];

/** sRGB bytes at 0 to 1. */
export function colourAt(value: number): [number, number, number] {
  const place = Math.min(Math.max(value, 0), 1) * (CIVIDIS.length - 1);
  const low = Math.min(Math.floor(place), CIVIDIS.length - 2);
  const share = place - low;
  const channel = (c: number): number => Math.round(CIVIDIS[low][c] + (CIVIDIS[low + 1][c] - CIVIDIS[low][c]) * share);
  return [channel(0), channel(1), channel(2)];
}

/** RGBA bytes of the whole map, for a texture or a legend. */
export function colourRow(width: number): Uint8Array {
  const row = new Uint8Array(4 * width);
  for (let i = 0; i < width; i++) row.set([...colourAt(i / (width - 1)), 255], 4 * i);
  return row;
}
