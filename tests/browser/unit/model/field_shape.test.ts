// SPDX-License-Identifier: GPL-3.0-or-later
import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

import { clothAround, clothUnder, fleshAround, surroundingsOf, type FieldShape, type Surroundings } from '../../../../clients/web/src/model/field_shape';
import { lobeValues, vesselValues } from '../../../../clients/web/src/model/patterns';
import type { LayerDescription, Scene } from '../../../../clients/web/src/wire/messages.gen';

const scene = (name: string): Scene => JSON.parse(readFileSync(fileURLToPath(new URL(`../../../../deploy/scenes/${name}.json`, import.meta.url)), 'utf8')) as Scene;

/** A sheet of 120 x 100 mm at z = 2 mm, and under it fat of 100 x 50 mm down to -8 mm. */
const REST = Float32Array.from([-0.06, -0.05, 0.002, 0.06, -0.05, 0.002, 0, 0.05, 0.002, -0.05, -0.025, -0.008, 0.05, 0.025, 0, 0, 0, 0, 9, 9, 9]);
const FACES = Int32Array.from([0, 1, 2, 3, 4, 5]); // none has the last vertex
const layers = (kinds: LayerDescription['kind'][]): LayerDescription[] =>
  kinds.map((kind, i) => ({ name: kind, kind, first_face: i, face_count: 1, element_count: 1 }));

function surroundings(kinds: LayerDescription['kind'][], name: string): Surroundings {
  const found = surroundingsOf(REST, FACES, layers(kinds), scene(name));
  if (!found) throw new Error('there is tissue');
  return found;
}

/** Whether each triangle of a ring is closed with the next: every inner side belongs to two triangles. */
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
    expect(surroundingsOf(REST, Int32Array.from([]), [], scene('fascia'))).toBeNull();
  });

  it.each(['fascia', 'fat', 'fat-neohookean', 'layers'])('%s lies in a body', (name) => {
    expect(surroundings(['fascia', 'fat'], name).inBody).toBe(true);
  });

  it.each(['strain-none-off', 'strain-x-on', 'strain-xy-on'])('%s hangs freely', (name) => {
    expect(surroundings(['fascia', 'fascia'], name).inBody).toBe(false);
  });

  it('is nowhere above the tissue that lies in it, nor inside fat', () => {
    const layered = fleshAround(surroundings(['fascia', 'fat'], 'layers'));
    expect(heightInside(layered, 0.0595, 0.0495)).toBeLessThan(0.002);
    expect(heightInside(layered, 0.0484, 0.0234)).toBeLessThan(-0.008);
    expect(heightInside(fleshAround(surroundings(['fascia', 'fascia'], 'fascia')), 0.0595, 0.0495)).toBeLessThan(0.002);
    expect(heightInside(clothAround(surroundings(['fascia', 'fat'], 'layers')), 0.0595, 0.0495)).toBe(-Infinity);
    expect(heightInside(clothUnder(surroundings(['fascia', 'fat'], 'layers')), 1, 1)).toBeLessThan(-0.008);
  });

  it('has no hole between its rings', () => {
    for (const shape of [fleshAround(surroundings(['fascia', 'fat'], 'layers')), clothAround(surroundings(['fascia', 'fat'], 'layers'))]) {
      const counts = [...sides(shape.index).values()];
      const rim = shape.position.length / 3 / (Math.max(...shape.index) + 1);
      expect(rim).toBe(1);
      expect(counts.every((count) => count <= 2)).toBe(true);
      const perRing = counts.filter((count) => count === 1).length / 2; // the first ring and the last one
      expect((shape.position.length / 3) % perRing).toBe(0);
    }
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
