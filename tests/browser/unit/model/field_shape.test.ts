// SPDX-License-Identifier: GPL-3.0-or-later
import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

import { Bed } from '../../../../clients/web/src/model/bed';
import { clothAround, clothUnder, fleshAround, sheathAround, surroundingsOf, type FieldShape, type Surroundings } from '../../../../clients/web/src/model/field_shape';
import { lobeValues, vesselValues } from '../../../../clients/web/src/model/patterns';
import type { LayerDescription, Scene } from '../../../../clients/web/src/wire/messages.gen';

const scene = (name: string): Scene => JSON.parse(readFileSync(fileURLToPath(new URL(`../../../../deploy/scenes/${name}.json`, import.meta.url)), 'utf8')) as Scene;

/** A sheet of 120 x 100 mm at z = 2 mm, and under it fat of 100 x 50 mm down to -8 mm. */
const REST = Float32Array.from([-0.06, -0.05, 0.002, 0.06, -0.05, 0.002, 0, 0.05, 0.002, -0.05, -0.025, -0.008, 0.05, 0.025, 0, 0, 0, 0, 9, 9, 9]);
/** The material coordinates: the rest coordinates turned by 90 degrees and moved. */
const MATERIAL = Float32Array.from({ length: REST.length }, (_, i) => [REST[i + 1] + 0.1, -REST[i - 1], 0][i % 3]);
const FACES = Int32Array.from([0, 1, 2, 3, 4, 5]); // no face has the last vertex
const layers = (kinds: LayerDescription['kind'][]): LayerDescription[] =>
  kinds.map((kind, i) => ({ name: kind, kind, first_face: i, face_count: 1, element_count: 1 }));

function surroundings(kinds: LayerDescription['kind'][], name: string): Surroundings {
  const found = surroundingsOf(REST, MATERIAL, FACES, layers(kinds), scene(name));
  if (!found) throw new Error('there is tissue');
  return found;
}

/** Counts the triangles of each side. In a closed ring every inner side belongs to two triangles. */
function sides(index: Uint32Array): Map<string, number> {
  const count = new Map<string, number>();
  for (let i = 0; i < index.length; i += 3) {
    for (let c = 0; c < 3; c++) {
      const [a, b] = [index[i + c], index[i + ((c + 1) % 3)]];
      const key = a < b ? `${a}-${b}` : `${b}-${a}`;
      count.set(key, (count.get(key) ?? 0) + 1);
    }
  }
  return count;
}

const heightInside = ({ position }: FieldShape, hx: number, hy: number): number => {
  let most = -Infinity;
  for (let i = 0; i < position.length; i += 3)
    if (Math.abs(position[i]) < hx && Math.abs(position[i + 1]) < hy) most = Math.max(most, position[i + 2]);
  return most;
};

describe('the field around tissue', () => {
  it('knows the tissue’s rectangle, what of it is solid, and how high its edge is', () => {
    const { all, solid, edgeZ } = surroundings(['fascia', 'fat'], 'layers');
    expect(all.least.map((value) => Number(value.toFixed(6)))).toEqual([-0.06, -0.05, -0.008]);
    expect(all.most[0]).toBeCloseTo(0.06, 6);
    expect(solid?.most[0]).toBeCloseTo(0.05, 6);
    expect(edgeZ).toBeCloseTo(0.002, 6);
    expect(surroundingsOf(REST, MATERIAL, Int32Array.from([]), [], scene('fascia'))).toBeNull();
  });

  it.each(['fascia', 'fat', 'fat-neohookean', 'layers'])('%s lies in a body', (name) => {
    expect(surroundings(['fascia', 'fat'], name).inBody).toBe(true);
  });

  it.each(['strain-none-off', 'strain-x-on', 'strain-xy-on'])('%s hangs freely', (name) => {
    expect(surroundings(['fascia', 'fascia'], name).inBody).toBe(false);
  });

  it('a strip of fat that is held at its ends hangs freely', () => {
    expect(surroundings(['fascia', 'fat'], 'pedicle').inBody).toBe(false);
  });

  it('is nowhere above the tissue that lies in it, nor inside fat', () => {
    const around = surroundings(['fascia', 'fat'], 'layers');
    expect(heightInside(fleshAround(around), 0.0595, 0.0495)).toBeLessThan(0.002);
    const bed = new Bed(around, REST).shape;
    expect(heightInside(bed, 1, 1)).toBeLessThan(0.002);
    expect(heightInside(bed, 0.0485, 0.0235)).toBeLessThan(-0.008);
    expect(heightInside(new Bed(surroundings(['fascia', 'fascia'], 'fascia'), REST).shape, 1, 1)).toBeLessThan(0.002);
    expect(heightInside(clothAround(surroundings(['fascia', 'fat'], 'layers')), 0.0595, 0.0495)).toBe(-Infinity);
    expect(heightInside(clothUnder(surroundings(['fascia', 'fat'], 'layers')), 1, 1)).toBeLessThan(-0.008);
  });

  it('has no hole between its rings', () => {
    for (const shape of [fleshAround(surroundings(['fascia', 'fat'], 'layers')), sheathAround(surroundings(['fascia', 'fat'], 'layers')), clothAround(surroundings(['fascia', 'fat'], 'layers'))]) {
      const counts = [...sides(shape.index).values()];
      const rim = shape.position.length / 3 / (Math.max(...shape.index) + 1);
      expect(rim).toBe(1);
      expect(counts.every((count) => count <= 2)).toBe(true);
      const perRing = counts.filter((count) => count === 1).length / 2; // the first and the last ring have open sides
      expect((shape.position.length / 3) % perRing).toBe(0);
    }
  });
});

describe('what continues tissue in a body', () => {
  const around = surroundings(['fascia', 'fat'], 'layers');
  const { position } = sheathAround(around);

  it('has the material coordinates of the sheet that it continues', () => {
    const { sheath } = around;
    expect(sheath.kind).toBe('fascia');
    const at = (x: number, y: number): number[] => [0, 1, 2].map((c) => sheath.origin[c] + sheath.alongX[c] * x + sheath.alongY[c] * y);
    for (const [x, y] of [[0, 0], [0.06, -0.05], [-0.2, 0.3]]) {
      const [u, v, w] = at(x, y);
      expect(u).toBeCloseTo(y + 0.1, 5);
      expect(v).toBeCloseTo(-x, 5);
      expect(w).toBeCloseTo(0, 5);
    }
    expect(surroundings(['fat', 'fat'], 'fat').sheath.kind).toBe('fat');
    expect(surroundings(['fat', 'membrane'], 'fat').sheath.kind).toBe('membrane');
  });

  it('covers the border of the tissue and no more of it, and goes on farther than a camera at home sees', () => {
    const inside = heightInside(sheathAround(around), 0.059, 0.049);
    expect(inside).toBe(-Infinity);
    const border = [...position].filter((_, i) => i % 3 === 2 && Math.abs(position[i - 2]) <= 0.06 && Math.abs(position[i - 1]) <= 0.05);
    expect(border.length).toBeGreaterThan(50);
    expect(Math.min(...border)).toBeGreaterThan(0.002);
    expect(Math.max(...position)).toBeGreaterThan(0.4);
  });
});

describe('the bed under a sheet', () => {
  const CELLS = 40;
  const corner = (i: number, j: number): [number, number] => [-0.06 + (0.12 * i) / CELLS, -0.05 + (0.1 * j) / CELLS];
  /** Returns a sheet of squares of 3 mm whose height is a function of x and y; its border stays. */
  const sheet = (height: (x: number, y: number) => number): Float32Array => {
    const position = new Float32Array(3 * (CELLS + 1) ** 2);
    for (let j = 0, v = 0; j <= CELLS; j++)
      for (let i = 0; i <= CELLS; i++, v++) {
        const [x, y] = corner(i, j);
        const inner = i > 0 && j > 0 && i < CELLS && j < CELLS;
        position.set([x, y, 0.002 + (inner ? height(x, y) : 0)], 3 * v);
      }
    return position;
  };
  /** Returns the height of the shape at x and y. */
  const heightAt = ({ position, index }: FieldShape, x: number, y: number): number => {
    // The loop makes no arrays, which would take most of the time.
    for (let f = 0; f < index.length; f += 3) {
      const a = 3 * index[f], b = 3 * index[f + 1], c = 3 * index[f + 2];
      const ax = position[a], ay = position[a + 1], bx = position[b] - ax, by = position[b + 1] - ay, cx = position[c] - ax, cy = position[c + 1] - ay;
      const area = bx * cy - cx * by;
      const u = ((x - ax) * cy - cx * (y - ay)) / area;
      const v = (bx * (y - ay) - (x - ax) * by) / area;
      if (u < -1e-6 || v < -1e-6 || u + v > 1 + 1e-6) continue;
      return position[a + 2] + u * (position[b + 2] - position[a + 2]) + v * (position[c + 2] - position[a + 2]);
    }
    throw new Error('there is bed everywhere');
  };
  /** Returns how far the bed rises above the sheet, at most, at the sheet's corners and in the middles of its
   * squares. */
  const pierces = (bed: Bed, at: Float32Array): number => {
    let most = -Infinity;
    for (let j = 0; j < CELLS; j++)
      for (let i = 0; i < CELLS; i++) {
        const z = (di: number, dj: number): number => at[3 * ((j + dj) * (CELLS + 1) + i + di) + 2];
        const [x, y] = corner(i, j);
        const [mx, my] = corner(i + 0.5, j + 0.5);
        if (i > 0 && j > 0) most = Math.max(most, heightAt(bed.shape, x, y) - z(0, 0));
        most = Math.max(most, heightAt(bed.shape, mx, my) - Math.min((z(0, 0) + z(1, 1)) / 2, (z(1, 0) + z(0, 1)) / 2));
      }
    return most;
  };
  const waves = (x: number, y: number): number => 0.012 * Math.sin(260 * x + 1) * Math.sin(310 * y);

  it.each([['layers', ['fascia', 'fat']], ['fascia', ['fascia', 'fascia']]] as const)('is never above it, however wavy, in %s', (name, kinds) => {
    const flat = sheet(() => 0);
    const around = surroundings([...kinds], name);
    const bed = new Bed(around, flat);
    const wavy = sheet(waves);
    expect(pierces(bed, flat)).toBeLessThan(0);
    expect(pierces(bed, wavy)).toBeGreaterThan(0.002); // the bed would be above the sheet if it did not follow
    expect(bed.follow(wavy)).toBe(true);
    expect(pierces(bed, wavy)).toBeLessThan(0);
  });

  it('is at rest again when the sheet is, and says when nothing changes', () => {
    const flat = sheet(() => 0);
    const bed = new Bed(surroundings(['fascia', 'fascia'], 'fascia'), flat);
    const before = bed.shape.position.slice();
    expect(bed.follow(flat)).toBe(false);
    bed.follow(sheet(waves));
    expect(bed.follow(flat)).toBe(true);
    expect(bed.shape.position).toEqual(before);
    expect(bed.follow(flat)).toBe(false);
  });
});

describe('patterns of flesh', () => {
  it('lobes are domes: from dark between them to bright in them, without a seam', () => {
    const size = 24;
    const values = lobeValues(size);
    expect(Math.max(...values)).toBeGreaterThan(200);
    expect(Math.min(...values)).toBeLessThan(60);
    const at = (x: number, y: number, z: number): number => values[(z * size + y) * size + x];
    const step = (a: number, b: number): number => Math.abs(a - b);
    let across = 0;
    let inside = 0;
    for (let i = 0; i < size; i++) {
      for (let j = 0; j < size; j++) {
        across = Math.max(across, step(at(0, i, j), at(size - 1, i, j)));
        inside = Math.max(inside, step(at(size / 2, i, j), at(size / 2 + 1, i, j)));
      }
    }
    expect(across).toBeLessThan(1.5 * inside);
  });

  it('vessels are few, connected, and the same ones every time', () => {
    const size = 192;
    const values = vesselValues(size);
    expect(vesselValues(size)).toEqual(values);
    const inside = values.reduce((sum, value) => sum + Number(value > 127), 0) / values.length;
    expect(inside).toBeGreaterThan(0.005);
    expect(inside).toBeLessThan(0.15);
    let alone = 0;
    let vessels = 0;
    for (let y = 0; y < size; y++) {
      for (let x = 0; x < size; x++) {
        if (values[y * size + x] <= 133) continue;
        vessels++;
        const around = [-1, 0, 1].flatMap((j) => [-1, 0, 1].map((i) => values[((y + j + size) % size) * size + ((x + i + size) % size)]));
        if (around.filter((value) => value > 120).length < 2) alone++;
      }
    }
    expect(vessels).toBeGreaterThan(100);
    expect(alone).toBe(0);
  });
});
