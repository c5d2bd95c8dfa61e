// SPDX-License-Identifier: GPL-3.0-or-later
// Tests lips of generated cuts. A sheet's faces part if the dose at their middle is above 1, as in
// core/dissect/doses.c. The dose is smooth, and its line of 1 is known.
import { EVENINGS, type LipShape } from '../../../../clients/web/src/model/lips';
import { SURFACE_FLOATS } from '../../../../clients/web/src/model/surface';
import { Tissue } from '../../../../clients/web/src/model/tissue';
import type { StreamState } from '../../../../clients/web/src/wire/decoder';

const CELL_M = 0.002; // edge length of the cells of deploy/scenes/layers.json
const STEP_M = 1e-6;
const THICK_M = 0.0005;
const SIZE_M = [0.056, 0.032] as const;
/** What is asked of the drawn lip. */
const NEAR_M = 1e-4; // largest distance of the drawn lip to the exact curve, at the 95th percentile
const CORNER_DEGREES = 15;
const SEGMENT_M = 5e-4;
const SINGLE_M = 1e-7;

type Point = readonly [number, number];
type Dose = (x: number, y: number) => number;

/** Returns the dose of a cut along x. `ragged` makes its lips wavy; a strand of width `strandM` stays across the
 * cut. */
const cut = (ragged: number, strandM = 0): Dose => (x, y) => {
  const half = 0.0038 + ragged * (Math.sin(900 * x + 1) + 0.6 * Math.sin(2100 * x + (y > 0 ? 2 : 0)));
  const along = Math.max(Math.abs(x) - 0.017, 0);
  if (Math.abs(x - 0.003) < strandM / 2) return 0;
  return half / Math.max(Math.hypot(along, y), 1e-9);
};

interface Cut {
  tissue: Tissue;
  state: StreamState;
  faces: Int32Array;
  lip: LipShape;
}

const WHOLE = { whole: true, moved: [], maskWords: [], scalars: true };

function sheet(cellM: number, dose: Dose, lift: (x: number, y: number) => number = () => 0): Cut {
  const [columns, rows] = SIZE_M.map((size) => Math.round(size / cellM));
  const points: number[] = [];
  const corners: number[] = [];
  for (let j = 0; j <= rows; j++) {
    for (let i = 0; i <= columns; i++) {
      const [x, y] = [i * cellM - SIZE_M[0] / 2, j * cellM - SIZE_M[1] / 2];
      points.push(x, y, lift(x, y));
      const a = j * (columns + 1) + i;
      if (i < columns && j < rows) corners.push(a, a + 1, a + columns + 2, a, a + columns + 2, a + columns + 1);
    }
  }
  const faces = Int32Array.from(corners);
  const [vertexCount, faceCount] = [points.length / 3, faces.length / 3];
  const topology = { faces, faceLayers: new Int32Array(faceCount), texture: null, rest: new Int32Array(points.length) };
  const layers = [{ name: 'sheet', kind: 'fascia' as const, first_face: 0, face_count: faceCount, element_count: faceCount }];
  const tissue = new Tissue({ vertexCount, faceCount, originM: [0, 0, 0], stepM: STEP_M, layers, topology, scalar: 'stress', thicknessM: { sheet: THICK_M }, material: Float32Array.from(points) });
  const none = (): Int32Array => new Int32Array(vertexCount);
  const state = { quantised: Int32Array.from(points, (value) => Math.round(value / STEP_M)), mask: new Int32Array(Math.ceil(faceCount / 32)), exposure: none(), charring: none(), stress: none(), temperature: none() };
  for (let v = 0; v < vertexCount; v++) state.exposure[v] = Math.min(255, Math.round(255 * dose(points[3 * v], points[3 * v + 1])));
  for (let face = 0; face < faceCount; face++) {
    const middle = [0, 1].map((c) => [0, 1, 2].reduce((sum, k) => sum + points[3 * faces[3 * face + k] + c] / 3, 0));
    if (dose(middle[0], middle[1]) > 1) state.mask[face >>> 5] |= 1 << (face & 31);
  }
  tissue.update(state as unknown as StreamState, WHOLE);
  return { tissue, state: state as unknown as StreamState, faces, lip: tissue.lips[0]!.shape() };
}

const hiddenIn = ({ state }: Cut, face: number): boolean => ((state.mask[face >>> 5] >>> (face & 31)) & 1) === 1;

/** Returns closed or open chains of points from directed pairs of vertices. */
function chains(pairs: readonly (readonly [number, number])[], at: (vertex: number) => Point): Point[][] {
  const next = new Map(pairs);
  const starts = new Set(next.keys());
  const found: Point[][] = [];
  while (starts.size > 0) {
    const [first] = starts;
    const chain: Point[] = [];
    for (let v: number | undefined = first; v !== undefined && starts.has(v); v = next.get(v)) {
      starts.delete(v);
      chain.push(at(v));
    }
    found.push(chain);
  }
  return found;
}

/** Returns the drawn lips, from the upper row of the lip's wall. */
function drawnLips({ lip }: Cut): Point[][] {
  const { records, index } = lip.wall;
  const rows = 4; // rows of a lip's profile
  const pairs: [number, number][] = [];
  for (let i = 0; i < index!.length; i += 6 * (rows - 1)) pairs.push([index![i], index![i + 1]]);
  return chains(pairs, (row) => [records[SURFACE_FLOATS * row], records[SURFACE_FLOATS * row + 1]]);
}

/** Returns the border of the masked mesh, as closed chains of vertices. In these cuts no vertex is on it twice. */
function maskBorders(of: Cut): Point[][] {
  const { faces, tissue } = of;
  const count = tissue.position.length / 3;
  const ends = new Map<number, number[]>();
  for (let i = 0; i < faces.length; i++) {
    const [a, b] = [faces[i], faces[i - (i % 3) + ((i + 1) % 3)]];
    const key = Math.min(a, b) * count + Math.max(a, b);
    ends.set(key, [...(ends.get(key) ?? []), i]);
  }
  const pairs: [number, number][] = [];
  for (const sides of ends.values()) {
    const drawn = sides.filter((side) => !hiddenIn(of, Math.trunc(side / 3)));
    if (sides.length === 2 && drawn.length === 1) pairs.push([faces[drawn[0]], faces[drawn[0] - (drawn[0] % 3) + ((drawn[0] + 1) % 3)]]);
  }
  expect(new Set(pairs.map(([a]) => a)).size).toBe(pairs.length);
  return chains(pairs, (v) => [tissue.position[3 * v], tissue.position[3 * v + 1]]);
}

const mix = (points: readonly Point[], weights: readonly number[]): Point => [0, 1].map((c) => points.reduce((sum, p, i) => sum + weights[i] * p[c], 0)) as unknown as Point;

/** Returns the exact curve: cubic B-spline segments, in closed form, of a closed border whose teeth were smoothed. */
function exactCurve(border: readonly Point[], perSpan = 64): Point[] {
  let points = [...border];
  const near = (i: number, by: number): Point => points[(i + by + points.length) % points.length];
  for (let k = 0; k < EVENINGS; k++) points = points.map((p, i) => mix([near(i, -1), p, near(i, 1)], [1 / 4, 1 / 2, 1 / 4]));
  return points.flatMap((_, i) =>
    Array.from({ length: perSpan }, (_unused, k) => {
      const t = k / perSpan;
      const weights = [(1 - t) ** 3, 3 * t ** 3 - 6 * t ** 2 + 4, -3 * t ** 3 + 3 * t ** 2 + 3 * t + 1, t ** 3].map((w) => w / 6);
      return mix([near(i, -1), near(i, 0), near(i, 1), near(i, 2)], weights);
    }),
  );
}

function toSegment([x, y]: Point, [ax, ay]: Point, [bx, by]: Point): number {
  const [dx, dy] = [bx - ax, by - ay];
  const t = Math.min(Math.max(((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1), 0), 1);
  return Math.hypot(x - ax - t * dx, y - ay - t * dy);
}

const toCurve = (p: Point, curve: readonly Point[]): number => Math.min(...curve.map((a, i) => toSegment(p, a, curve[(i + 1) % curve.length])));
const percentile = (values: readonly number[], share: number): number => [...values].sort((a, b) => a - b)[Math.floor(share * (values.length - 1))];

function corners(chain: readonly Point[]): { degrees: number[]; lengths: number[] } {
  const side = (i: number): Point => {
    const [a, b] = [chain[i % chain.length], chain[(i + 1) % chain.length]];
    return [b[0] - a[0], b[1] - a[1]];
  };
  const degrees = chain.map((_, i) => {
    const [a, b] = [side(i), side(i + 1)];
    return (180 / Math.PI) * Math.abs(Math.atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]));
  });
  return { degrees, lengths: chain.map((_, i) => Math.hypot(...side(i))) };
}

/** Returns the mean distance from the cut's middle at which a lip crosses lines x = const on one side of the cut. */
function meanHalfWidth(lips: readonly Point[][]): number {
  const crossings: number[] = [];
  for (let x = -0.012; x <= 0.012; x += 0.0005) {
    for (const chain of lips)
      chain.forEach((a, i) => {
        const b = chain[(i + 1) % chain.length];
        if ((a[0] <= x) !== (b[0] <= x)) crossings.push(Math.abs(a[1] + ((x - a[0]) / (b[0] - a[0])) * (b[1] - a[1])));
      });
  }
  return crossings.reduce((sum, value) => sum + value, 0) / crossings.length;
}

const CUTS: readonly (readonly [string, Dose])[] = [
  ['smooth', cut(0)],
  ['wavy', cut(0.0003)],
  ['ragged', cut(0.0005)],
  ['with a strand', cut(0.0003, 0.0045)],
];

describe('the drawn lip', () => {
  it.each(CUTS)('is the exact curve within a tenth of a millimetre, %s', (_name, dose) => {
    const of = sheet(CELL_M, dose);
    const [drawn, exact] = [drawnLips(of), maskBorders(of).map((border) => exactCurve(border))];
    expect(drawn).toHaveLength(exact.length);
    const away = (points: Point[][], curves: Point[][]): number[] => points.flat().map((p) => Math.min(...curves.map((curve) => toCurve(p, curve))));
    expect(percentile(away(drawn, exact), 0.95)).toBeLessThan(NEAR_M);
    expect(percentile(away(exact.map((curve) => curve.filter((_p, i) => i % 16 === 0)), drawn), 0.95)).toBeLessThan(NEAR_M);
  });

  it.each(CUTS)('has no corner and no straight side that an eye finds, %s', (_name, dose) => {
    for (const chain of drawnLips(sheet(CELL_M, dose))) {
      const { degrees, lengths } = corners(chain);
      expect(Math.max(...degrees)).toBeLessThan(CORNER_DEGREES);
      expect(Math.max(...lengths)).toBeLessThan(SEGMENT_M);
    }
  });

  // The daemon parts whole elements, by the dose at their middle.
  it.each(CUTS)('is where the dose is 1 within half a cell on average, and on half the cells too, %s', (name, dose) => {
    const ideal: Point[][] = [[], []];
    for (let x = -0.013; x <= 0.013; x += 0.0001)
      [1, -1].forEach((side, i) => {
        let [low, high] = [0, 0.02];
        for (let k = 0; k < 40; k++) [low, high] = dose(x, (side * (low + high)) / 2) > 1 ? [(low + high) / 2, high] : [low, (low + high) / 2];
        ideal[i].push([x, side * low]);
      });
    const [coarse, fine] = [CELL_M, CELL_M / 2].map((cell) => meanHalfWidth(drawnLips(sheet(cell, dose))));
    if (name !== 'with a strand') expect(Math.abs(coarse - meanHalfWidth(ideal))).toBeLessThan(CELL_M / 2);
    expect(Math.abs(coarse - fine)).toBeLessThan(CELL_M / 2);
  });

  it('leaves a strand of single faces in one piece', () => {
    const of = sheet(CELL_M, cut(0, 0.0025));
    expect(drawnLips(of)).toHaveLength(2); // a hole on each side of the strand
    expect(drawnLips(sheet(CELL_M, cut(0)))).toHaveLength(1);
  });

  it('has two lips where two holes meet at a vertex', () => {
    const touching: Dose = (x, y) => (x > 0) === (y > 0) && Math.max(Math.abs(x), Math.abs(y)) < 0.006 ? 2 : 0;
    const of = sheet(CELL_M, touching);
    const drawn = drawnLips(of);
    expect(drawn.length).toBeGreaterThan(0);
    for (const chain of drawn) expect(Math.max(...corners(chain).lengths)).toBeLessThan(SEGMENT_M);
    const { records } = of.lip.band;
    expect(records.every(Number.isFinite)).toBe(true);
  });

  it('is as thick as the sheet, rounded outwards', () => {
    const { lip } = sheet(CELL_M, cut(0.0003));
    const row = (i: number): Float32Array => lip.wall.records.subarray(SURFACE_FLOATS * i, SURFACE_FLOATS * (i + 1));
    for (let i = 0; i < lip.wall.records.length / SURFACE_FLOATS; i += 4) {
      expect(row(i)[2] - row(i + 3)[2]).toBeCloseTo(THICK_M, 6);
      const out = Math.hypot(row(i + 1)[0] - row(i)[0], row(i + 1)[1] - row(i)[1]);
      expect(out).toBeGreaterThan(0.1 * THICK_M);
      expect(out).toBeLessThan(0.5 * THICK_M);
    }
  });

  it('frays along the fibres, further where it crosses them', () => {
    const { lip } = sheet(CELL_M, cut(0)); // the fibres are along x, like the cut
    const { records } = lip.fringe;
    let [crossed, beside] = [0, 0];
    for (let i = 0; i < records.length; i += 2 * SURFACE_FLOATS) {
      const [dx, dy] = [0, 1].map((c) => records[i + SURFACE_FLOATS + c] - records[i + c]);
      expect(Math.hypot(dx, dy)).toBeLessThan(0.0015);
      if (Math.abs(records[i + 1]) < 0.001) crossed = Math.max(crossed, Math.abs(dx));
      if (Math.abs(records[i]) < 0.01) beside = Math.max(beside, Math.hypot(dx, dy));
    }
    expect(crossed).toBeGreaterThan(beside);
  });
});

describe('the surface beside a cut', () => {
  const bent = sheet(CELL_M, cut(0.0003), (x, y) => 0.1 * (x * x - y * y));

  it('meets the faces that are drawn as they are without a crack', () => {
    const { tissue, lip } = bent;
    const plain = tissue.drawnIndex[0].subarray(0, 3 * tissue.plainFaces[0]);
    const finer = tissue.drawnIndex[0].subarray(3 * tissue.plainFaces[0]);
    const key = (a: number, b: number): string => `${Math.min(a, b)} ${Math.max(a, b)}`;
    const sides = (index: Uint32Array): [number, number][] => [...index].map((a, i) => [a, index[i - (i % 3) + ((i + 1) % 3)]]);
    const known = new Set(sides(plain).map(([a, b]) => key(a, b)));
    const { records } = lip.band;
    let met = 0;
    for (const [a, b] of sides(finer).filter(([p, q]) => known.has(key(p, q)))) {
      for (let part = 0; part <= 8; part++) {
        const at = [0, 1, 2].map((c) => tissue.position[3 * a + c] + (part / 8) * (tissue.position[3 * b + c] - tissue.position[3 * a + c]));
        let near = Infinity;
        for (let i = 0; i < records.length; i += SURFACE_FLOATS) near = Math.min(near, Math.hypot(records[i] - at[0], records[i + 1] - at[1], records[i + 2] - at[2]));
        expect(near).toBeLessThan(SINGLE_M);
        met++;
      }
    }
    expect(met).toBeGreaterThan(100);
  });

  it('takes the field over: burn goes from a rim to the mesh without a step', () => {
    const { records, index } = bent.lip.band;
    let most = 0;
    for (let i = 0; i < index!.length; i += 3)
      for (let c = 0; c < 3; c++) most = Math.max(most, Math.abs(records[SURFACE_FLOATS * index![i + c] + 11] - records[SURFACE_FLOATS * index![i + ((c + 1) % 3)] + 11]));
    expect(most).toBeGreaterThan(0);
    expect(most).toBeLessThan(0.25); // largest step of `rim`, which goes from 0 to 1 over a cell in eight parts
  });

  it('is gone when what was hidden comes back, and sends its faces only when they change', () => {
    const { tissue, state } = sheet(CELL_M, cut(0));
    const lips = tissue.lips[0]!;
    expect(lips.shape().band.index).toBeNull();
    state.mask.fill(0);
    tissue.update(state, WHOLE);
    expect(lips.empty).toBe(true);
    const { band, wall } = lips.shape();
    expect([band.index, wall.index, wall.records].map((array) => array?.length)).toEqual([0, 0, 0]);
    expect(tissue.plainFaces[0]).toBe(tissue.drawnIndex[0].length / 3);
  });
});
