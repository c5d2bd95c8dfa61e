// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes of the operative field around the tissue, for drawing only: walls of fat up to a rim of skin and a cloth with a
// window, or a continuation of the same tissue. Shapes are rings around the rectangle of the tissue, with equal points.
import type { LayerDescription, Scene, Selection } from '../wire/messages.gen';

/** Corners of an upright box, m. */
export interface Extent {
  least: readonly [number, number, number];
  most: readonly [number, number, number];
}

/** Material coordinates as a plane over x and y: value at x = y = 0, and change for each metre along x and y (m). */
export interface Sheath {
  /** topmost tissue: a sheet, a membrane on fat, or fat alone */
  kind: 'fascia' | 'membrane' | 'fat';
  origin: readonly number[];
  alongX: readonly number[];
  alongY: readonly number[];
}

/** The tissue in the field. */
export interface Surroundings {
  all: Extent;
  /** extent of the layers with tetrahedra; null: only sheets */
  solid: Extent | null;
  /** height of the tissue at its edge, m */
  edgeZ: number;
  /** whether the tissue lies in a body; else it hangs freely */
  inBody: boolean;
  /** material coordinates of the continuation of the tissue */
  sheath: Sheath;
}

export interface FieldShape {
  /** m (vertices x 3) */
  position: Float32Array;
  /** kind of flesh at each vertex: see ZONES */
  zone: Float32Array;
  index: Uint32Array;
}

/** Kinds of flesh; numbers in between are transitions. */
export const ZONES = { muscle: 0, fat: 1, skin: 2, most: 3 } as const;

const EDGE_POINTS = 22; // on each side of the rectangle
const CORNER_POINTS = 7; // of a quarter turn
const EDGE_SHARE = 0.02; // width of the edge, as a share of the width of the tissue
const USUAL_M = 0.12; // width of the tissue for which the lengths below are chosen
export const OVERLAP_M = 0.0012; // overlap of the shelf with the tissue, so that no line is visible between them
export const HIDDEN_M = 0.0004; // distance below the tissue on it, so that only the tissue is visible
const SKIRT_M = 0.03; // depth of the surroundings beside the tissue, so that no gap is visible where the bed was lowered

/** Profile of the wall: metres outwards from the edge of the tissue, metres above it, kind of flesh. */
const WALL: readonly (readonly [number, number, number])[] = [
  [0, -0.0003, 1], [0.0012, 0.0004, 1], [0.003, 0.0013, 1], [0.006, 0.0031, 1], [0.0095, 0.0049, 1], [0.0122, 0.006, 1.15],
  [0.0132, 0.0069, 1.9], [0.0144, 0.0073, 2], [0.019, 0.0075, 2], [0.027, 0.0078, 2], [0.034, 0.0079, 2],
];
const SHEATH: readonly (readonly [number, number])[] = [
  [0.0002, -SKIRT_M], [0.0002, -0.0008], [-0.0009, 0.00012], [-0.0006, 0.00035], [0.0008, 0.00035], [0.002, 0.0002], [0.006, 0], [0.012, 0.0002], [0.019, 0.0008], [0.027, 0.0016],
  [0.036, 0.003], [0.047, 0.0055], [0.06, 0.009], [0.08, 0.016], [0.11, 0.028], [0.15, 0.05], [0.21, 0.095], [0.3, 0.2], [0.42, 0.5],
];
const FARTHEST_M = 0.8;
const BELOW_M = 0.012; // distance of the cloth below tissue that hangs freely
const CLOTH: readonly (readonly [number, number])[] = [
  [0.0235, 0.0082], [0.0238, 0.0094], [0.0247, 0.0101], [0.0262, 0.0101], [0.032, 0.0098], [0.042, 0.0092], [0.06, 0.007], [0.09, 0.001],
  [0.14, -0.012], [0.22, -0.035], [0.4, -0.085], [0.8, -0.17],
];

interface Ray {
  /** point of the rectangle, each coordinate from -1 to 1 */
  x: number;
  y: number;
  /** direction outwards */
  nx: number;
  ny: number;
}

/** Returns points around the rectangle, from one corner on, with several directions at each corner, so that it is round. */
function rays(): Ray[] {
  const all: Ray[] = [];
  const corners = [[1, -1], [1, 1], [-1, 1], [-1, -1]];
  corners.forEach(([x, y], i) => {
    const [tx, ty] = corners[(i + 1) % 4];
    for (let k = 0; k < CORNER_POINTS; k++) {
      const angle = (Math.PI / 2) * (i - 1 + k / (CORNER_POINTS - 1));
      all.push({ x, y, nx: Math.cos(angle), ny: Math.sin(angle) });
    }
    const side = (Math.PI / 2) * i;
    for (let k = 1; k <= EDGE_POINTS; k++) {
      const share = k / (EDGE_POINTS + 1);
      all.push({ x: x + share * (tx - x), y: y + share * (ty - y), nx: Math.cos(side), ny: Math.sin(side) });
    }
  });
  return all;
}
const RAYS = rays();

/** Returns the height of hills without a seam, about -1 to 1; x and y in waves. */
export function hills(x: number, y: number): number {
  return (Math.sin(x + 1.7 * Math.sin(0.6 * y)) + Math.sin(1.3 * y + 1.9 * Math.sin(0.7 * x) + 1) + 0.6 * Math.sin(2.1 * x - 1.6 * y)) / 2.6;
}

class Rings {
  private readonly position: number[] = [];
  private readonly zone: number[] = [];
  private rings = 0;

  add(zone: number, place: (ray: Ray) => [number, number, number]): void {
    for (const ray of RAYS) {
      this.position.push(...place(ray));
      this.zone.push(zone);
    }
    this.rings++;
  }

  shape(): FieldShape {
    const index: number[] = [];
    const n = RAYS.length;
    for (let ring = 0; ring + 1 < this.rings; ring++) {
      for (let i = 0; i < n; i++) {
        const [a, b] = [ring * n + i, ring * n + ((i + 1) % n)];
        index.push(a, a + n, b + n, a, b + n, b);
      }
    }
    return { position: Float32Array.from(this.position), zone: Float32Array.from(this.zone), index: Uint32Array.from(index) };
  }
}

const middle = ({ least, most }: Extent): [number, number] => [(least[0] + most[0]) / 2, (least[1] + most[1]) / 2];
const half = ({ least, most }: Extent): [number, number] => [(most[0] - least[0]) / 2, (most[1] - least[1]) / 2];

/** Returns a function for the points of a ring around the rectangle of a box, enlarged by `grown` metres. */
function around(box: Extent, grown: number): (ray: Ray) => [number, number] {
  const [mx, my] = middle(box);
  const [hx, hy] = half(box);
  return ({ x, y, nx, ny }) => [mx + hx * x + grown * nx, my + hy * y + grown * ny];
}

/** Returns whether the tissue lies in a body: it is pinned all around, or at its bottom. Tissue that hangs freely, or a
 * strip that is pinned at its ends, does not. */
function liesInBody({ pins = [] }: Scene, solid: Extent | null): boolean {
  const holdsMiddle = ({ least_m: least, most_m: most }: Selection): boolean =>
    solid !== null && least !== undefined && most !== undefined && middle(solid).every((at, c) => at >= least[c] && at <= most[c]);
  return pins.some((pin) => pin.kind === 'rim' || (pin.kind === 'box' && holdsMiddle(pin)));
}

/** Returns walls up to a rim of skin, as in an open operation. */
export function fleshAround(surroundings: Surroundings): FieldShape {
  const { all, edgeZ } = surroundings;
  const scale = scaleOf(all);
  const rings = new Rings();
  const edge = around(all, 0);
  rings.add(ZONES.fat, (ray) => [...edge(ray), edgeZ - scale * SKIRT_M]);
  for (const [out, up, zone] of WALL) {
    const place = around(all, scale * out);
    const rough = 0.0009 * scale * Math.min(out / 0.006, 1) * (zone > 1.5 ? 0.4 : 1);
    rings.add(zone, (ray) => {
      const [x, y] = place(ray);
      return [x, y, edgeZ + scale * up + rough * hills((420 * x) / scale, (420 * y) / scale)];
    });
  }
  return rings.shape();
}

/** Returns the continuation of the tissue beyond its border, as seen through a trocar: hills that rise to a wall. */
export function sheathAround({ all, edgeZ }: Surroundings): FieldShape {
  const scale = scaleOf(all);
  const rings = new Rings();
  for (const [out, up] of SHEATH) {
    const place = around(all, scale * out);
    const rough = 0.004 * scale * Math.min(Math.max(out - 0.002, 0) / 0.03, 1);
    rings.add(0, (ray) => {
      const [x, y] = place(ray);
      return [x, y, edgeZ + scale * up + rough * (1 + hills((110 * x) / scale, (110 * y) / scale))];
    });
  }
  return rings.shape();
}

/** Returns the cloth around a window. */
export function clothAround({ all, edgeZ }: Surroundings): FieldShape {
  const scale = scaleOf(all);
  const rings = new Rings();
  for (const [out, up] of CLOTH) {
    const folds = 0.006 * scale * Math.min(Math.max(out - 0.03, 0) / 0.07, 1.6);
    rings.add(out / FARTHEST_M, (ray) => {
      const wander = 1 + 0.02 * hills(60 * ray.x, 60 * ray.y) * Math.min(out / 0.03, 1);
      const [x, y] = around(all, scale * out * wander)(ray);
      const turn = Math.atan2(y, x);
      return [x, y, edgeZ + scale * up + folds * hills(9 * Math.cos(turn) + (7 * x) / scale, 9 * Math.sin(turn) + (7 * y) / scale)];
    });
  }
  return rings.shape();
}

/** Returns a cloth without a window, under tissue that hangs freely. */
export function clothUnder({ all }: Surroundings): FieldShape {
  const scale = scaleOf(all);
  const rings = new Rings();
  const z = all.least[2] - scale * BELOW_M;
  rings.add(0, () => [...middle(all), z]);
  for (const out of [0, 0.03, 0.1, 0.25, FARTHEST_M]) {
    const place = around(all, scale * out);
    rings.add(out / FARTHEST_M, (ray) => [...place(ray), z]);
  }
  return rings.shape();
}

export function scaleOf(all: Extent): number {
  return Math.max(...half(all)) / (USUAL_M / 2);
}

/** Returns the least and largest coordinates of vertices. */
function extentOf(position: Float32Array, corners: Iterable<number>): Extent | null {
  const least: [number, number, number] = [Infinity, Infinity, Infinity];
  const most: [number, number, number] = [-Infinity, -Infinity, -Infinity];
  for (const v of corners) {
    for (let c = 0; c < 3; c++) {
      least[c] = Math.min(least[c], position[3 * v + c]);
      most[c] = Math.max(most[c], position[3 * v + c]);
    }
  }
  return least[0] <= most[0] ? { least, most } : null;
}

/** Returns the height of the tissue at the edge of its rectangle. */
function edgeHeight(position: Float32Array, corners: Int32Array, { least, most }: Extent): number {
  const near = EDGE_SHARE * Math.max(most[0] - least[0], most[1] - least[1]);
  let height = -Infinity;
  for (const v of corners) {
    const [x, y, z] = position.subarray(3 * v, 3 * v + 3);
    if (Math.min(x - least[0], most[0] - x, y - least[1], most[1] - y) <= near) height = Math.max(height, z);
  }
  return height;
}

/** Fits a plane to material coordinates over rest positions, by least squares. */
function planeOver(rest: Float32Array, material: Float32Array, corners: Int32Array): Omit<Sheath, 'kind'> {
  const mean = (of: Float32Array, c: number): number => corners.reduce((sum, v) => sum + of[3 * v + c], 0) / corners.length;
  const [mx, my] = [mean(rest, 0), mean(rest, 1)];
  const moment = (value: (v: number) => number): number => corners.reduce((sum, v) => sum + value(v), 0);
  const [dx, dy] = [(v: number): number => rest[3 * v] - mx, (v: number): number => rest[3 * v + 1] - my];
  const [xx, xy, yy] = [moment((v) => dx(v) ** 2), moment((v) => dx(v) * dy(v)), moment((v) => dy(v) ** 2)];
  const size = xx * yy - xy * xy || 1;
  const axes = [0, 1, 2].map((c) => {
    const middle = mean(material, c);
    const [mxx, mxy] = [moment((v) => dx(v) * (material[3 * v + c] - middle)), moment((v) => dy(v) * (material[3 * v + c] - middle))];
    const [x, y] = [(yy * mxx - xy * mxy) / size, (xx * mxy - xy * mxx) / size];
    return { x, y, origin: middle - x * mx - y * my };
  });
  return { origin: axes.map(({ origin }) => origin), alongX: axes.map(({ x }) => x), alongY: axes.map(({ y }) => y) };
}

/** Computes the surroundings from rest positions, material coordinates, corners of faces and layers; null without faces. */
export function surroundingsOf(rest: Float32Array, material: Float32Array, faces: Int32Array, layers: readonly LayerDescription[], scene: Scene): Surroundings | null {
  const all = extentOf(rest, faces);
  if (!all) return null;
  const cornersOf = ({ first_face: first, face_count: count }: LayerDescription): Int32Array => faces.subarray(3 * first, 3 * (first + count));
  const corners = layers.filter(({ kind }) => kind === 'fat').map(cornersOf);
  const top: Sheath['kind'] = (['fascia', 'membrane'] as const).find((wanted) => layers.some(({ kind }) => kind === wanted)) ?? 'fat';
  const sheet = layers.find(({ kind }) => kind === 'fascia');
  const upper = faces.filter((v) => rest[3 * v + 2] >= (all.least[2] + all.most[2]) / 2);
  const sheath = { kind: top, ...planeOver(rest, material, sheet ? cornersOf(sheet) : upper) };
  const solid = corners.length > 0 ? extentOf(rest, Int32Array.from(corners.flatMap((of) => [...of]))) : null;
  return { all, solid, edgeZ: edgeHeight(rest, faces, all), inBody: liesInBody(scene, solid), sheath };
}
