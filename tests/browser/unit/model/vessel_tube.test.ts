// SPDX-License-Identifier: GPL-3.0-or-later
import { makeTube, type Tube } from '../../../../clients/web/src/model/vessel_tube';

const RADIUS_M = 0.001;
const SINGLE = 1e-9; // tolerance, m: single precision in a vessel of some centimetres

/** Returns a line along x, with a millimetre from point to point, and with these open shares. */
function line(open: readonly number[], bend = 0): Float32Array {
  return Float32Array.from(open.flatMap((share, i) => [0.001 * i, bend * i * i, -0.002, share]));
}

type Vector = [number, number, number];
const vertex = (array: Float32Array, v: number): Vector => [array[3 * v], array[3 * v + 1], array[3 * v + 2]];
const minus = (a: Vector, b: Vector): Vector => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const dot = (a: Vector, b: Vector): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a: Vector, b: Vector): Vector => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/** Returns the distances of the wall's vertices from the line, by x in millimetres. */
function radii({ position, normal }: Tube): Map<number, number> {
  const found = new Map<number, number>();
  for (let v = 0; v < position.length / 3; v++) {
    const [x, y, z] = vertex(position, v);
    if (Math.abs(normal[3 * v]) < 0.5) found.set(Math.round(1000 * x), Math.hypot(y, z + 0.002));
  }
  return found;
}

describe('the tube of a vessel', () => {
  it('is as wide as the vessel, and slimmer where it is pressed shut', () => {
    const found = radii(makeTube(line([1, 1, 0, 1]), RADIUS_M));
    expect([...found.keys()]).toEqual([0, 1, 2, 3]);
    for (const at of [0, 1, 3]) expect(Math.abs(found.get(at)! - RADIUS_M)).toBeLessThan(SINGLE);
    expect(found.get(2)).toBeLessThan(0.7 * RADIUS_M);
  });

  it('has a gap where it is parted, with ends that show the lumen', () => {
    const { position, look, index } = makeTube(line([1, 1, -1, 1, 1]), RADIUS_M);
    const xs = [...index].map((v) => Math.round(1000 * position[3 * v]));
    // No face may bridge the gap.
    for (let i = 0; i < xs.length; i += 3) expect(new Set(xs.slice(i, i + 3).map((x) => x < 2)).size).toBe(1);
    const ends = new Set<number>();
    for (let v = 0; v < position.length / 3; v++) if (look[2 * v + 1] === 1) ends.add(Math.round(1000 * position[3 * v]));
    expect([...ends]).toEqual([0, 1, 3, 4]);
  });

  it.each([['straight', 0], ['bent', 40]])('turns its faces outwards, %s', (_what, bend) => {
    const { position, normal, index } = makeTube(line([1, 1, 1, 1, 1], bend), RADIUS_M);
    let faces = 0;
    for (let i = 0; i < index.length; i += 3) {
      const [a, b, c] = [0, 1, 2].map((k) => vertex(position, index[i + k]));
      const faceNormal = cross(minus(b, a), minus(c, a));
      if (Math.hypot(...faceNormal) < 1e-12) continue; // leaves out triangles at the middle of an end
      expect(dot(faceNormal, vertex(normal, index[i]))).toBeGreaterThan(0);
      faces++;
    }
    expect(faces).toBeGreaterThan(100);
  });

  it('is nothing of what is parted everywhere, or has no length', () => {
    for (const open of [[], [1], [-1, -1], [-1, 1, -1]]) expect(makeTube(line(open), RADIUS_M).index).toHaveLength(0);
  });
});
