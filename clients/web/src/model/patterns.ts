// SPDX-License-Identifier: GPL-3.0-or-later
// Periodic patterns of flesh: lobes of fat, and branching vessels. They are always the same.

/** Returns a generator of random numbers from 0 to 1. */
export function random(seed: number): () => number {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) | 0;
    return (state >>> 0) / 2 ** 32;
  };
}

const LOBES = 6; // along each axis
const DOME = 0.85; // radius of a lobe, as a share of its width

/** size^3 bytes: 255 in the middle of a lobe, 0 far from any. */
export function lobeValues(size: number): Uint8Array {
  const next = random(11);
  const jitter = Float32Array.from({ length: 3 * LOBES ** 3 }, next);
  const wrap = (cell: number): number => (cell + LOBES) % LOBES;
  const values = new Uint8Array(size ** 3);
  /** Returns the squared distance to the nearest middle of a lobe. */
  const nearest = (p: readonly [number, number, number]): number => {
    const [cx, cy, cz] = [Math.floor(p[0]), Math.floor(p[1]), Math.floor(p[2])];
    let least = Infinity;
    for (let z = cz - 1; z <= cz + 1; z++) {
      for (let y = cy - 1; y <= cy + 1; y++) {
        for (let x = cx - 1; x <= cx + 1; x++) {
          const at = 3 * ((wrap(z) * LOBES + wrap(y)) * LOBES + wrap(x));
          const dx = x + jitter[at] - p[0], dy = y + jitter[at + 1] - p[1], dz = z + jitter[at + 2] - p[2];
          least = Math.min(least, dx * dx + dy * dy + dz * dz);
        }
      }
    }
    return least;
  };
  const step = LOBES / size;
  for (let z = 0, i = 0; z < size; z++)
    for (let y = 0; y < size; y++)
      for (let x = 0; x < size; x++, i++) values[i] = 255 * Math.max(0, 1 - nearest([x * step, y * step, z * step]) / DOME ** 2);
  return values;
}

const FALL = 18; // of a vessel's darkness beside its wall: squared texels to where it ends, over a half
const TRUNKS = 4;
const STEP = 2.2; // texels
const RISE = 16; // steps
const THINNEST = 0.3;

interface Sprout {
  x: number;
  y: number;
  turn: number;
  /** texels */
  radius: number;
  /** whether it branches off from another vessel */
  branch: boolean;
}

/** size^2 bytes: above 127 inside a vessel, more the further from its wall. */
export function vesselValues(size: number): Uint8Array {
  const next = random(5);
  const values = new Uint8Array(size * size);
  const sprouts: Sprout[] = Array.from({ length: TRUNKS }, (_, i) => ({
    x: (size * (i + 0.6 * next())) / TRUNKS, y: size * next(), turn: 2 * Math.PI * next(), radius: 1.2 - 0.12 * i, branch: false,
  }));
  while (sprouts.length > 0) {
    const { radius, branch, ...at } = sprouts.pop()!;
    let { x, y, turn } = at;
    let left = radius;
    let sinceBranch = 0;
    let bend = 0;
    // A trunk rises from below, so it begins faint.
    for (let gone = branch ? RISE : 0; left > THINNEST; gone++) {
      bend = 0.75 * bend + 0.22 * (next() - 0.5);
      turn += bend;
      const [dx, dy] = [STEP * Math.cos(turn), STEP * Math.sin(turn)];
      mark(values, size, { x, y, dx, dy }, left * Math.min((gone + 1) / RISE, 1));
      x += dx;
      y += dy;
      left *= 0.989;
      sinceBranch++;
      if (sinceBranch < 5 || next() > 0.14) continue;
      sinceBranch = 0;
      const side = next() < 0.5 ? -1 : 1;
      sprouts.push({ x, y, turn: turn + side * (0.55 + 0.5 * next()), radius: left * (0.55 + 0.3 * next()), branch: true });
      turn -= side * 0.15;
      left *= 0.93;
    }
  }
  return values;
}

interface Piece {
  x: number;
  y: number;
  dx: number;
  dy: number;
}

function mark(values: Uint8Array, size: number, { x, y, dx, dy }: Piece, radius: number): void {
  const reach = Math.sqrt(FALL) + STEP + 2;
  for (let j = Math.floor(y - reach); j <= y + reach; j++) {
    for (let i = Math.floor(x - reach); i <= x + reach; i++) {
      const share = Math.min(Math.max(((i - x) * dx + (j - y) * dy) / (STEP * STEP), 0), 1);
      const [ax, ay] = [i - x - share * dx, j - y - share * dy];
      // Uses the squared distance: a ridge with a kink would be lost between texels, so the vessel would look dotted.
      const inside = 0.5 + (radius * radius - ax * ax - ay * ay) / FALL;
      const at = (((j % size) + size) % size) * size + (((i % size) + size) % size);
      values[at] = Math.max(values[at], Math.round(255 * Math.min(Math.max(inside, 0), 1)));
    }
  }
}
