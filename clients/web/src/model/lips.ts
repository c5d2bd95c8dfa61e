// SPDX-License-Identifier: GPL-3.0-or-later
// The surfaces that a cut exposes in one layer, drawn finer than the mesh. For a sheet: its faces beside the cut, a lip as
// thick as the sheet, and frayed fibres. For fat: its inside. The border is the cubic B-spline of the border in the mask of
// the daemon (refine.ts). This is decoration: the daemon does not have these surfaces.
import { SURFACE_FLOATS, type SurfaceShape, type SurfaceSource } from './surface';
import { refine, refined, RIM, type Refinement } from './refine';

/** How often sides of the mesh are divided in two: for sheets, where 2 mm become a quarter of a millimetre along the lip,
 * and for the inside of fat. */
const SHEET_LEVELS = 3;
const INSIDE_LEVELS = 2;
/** Number of smoothing steps of borders and of the inside of fat, so that the teeth of the mesh are not visible. */
export const EVENINGS = 2;
const FRAY_M = 0.0011; // length of the longest frayed fibres
/** length of fibres along the cut, over the length of fibres across the cut */
const SHORTEST = 0.35;
const ALONG_FIBRE = 0.8; // share by which frayed fibres turn from straight out to the fibre direction of the layer
const SAG = 0.3; // sag of the ends of fibres, over their length
const GRAIN_M = 0.0002; // points of the material nearer than this fray alike
/** Profile of a lip, over its thickness: distance outwards, distance down, and share by which the normal turns outwards. */
const PROFILE = [[0, 0, 0.5], [0.28, 0.3, 1], [0.28, 0.65, 1], [0, 1, 0.7]] as const;

export interface LipShape {
  /** the surface itself, refined */
  band: SurfaceShape;
  /** the sheet's cut edge */
  wall: SurfaceShape;
  fringe: SurfaceShape;
}

/** Weights of two sides of a face beside the rim, whose sum is one metre along the fibre. */
interface Fibre {
  corner: readonly [number, number, number];
  shares: readonly [number, number];
}

const POSITION = 0, MATERIAL = 3, NORMAL = 6, BURN = 9, TIP = 13; // floats of a record

/** Returns a number from 0 to 1 for a point of the material, independent of the mesh. */
function grain(material: Float32Array, vertex: number): number {
  let mixed = 0x2545f491;
  for (let c = 0; c < 3; c++) mixed = Math.imul(mixed ^ Math.round(material[3 * vertex + c] / GRAIN_M), 0x9e3779b1);
  return ((mixed ^ (mixed >>> 15)) >>> 0) / 2 ** 32;
}

/** Ends of bands that lie side by side, `rows` records for each of the vertices. */
function bandIndex(edges: Uint32Array, row: Int32Array, rows: number): Uint32Array {
  const index: number[] = [];
  for (let i = 0; i < edges.length; i += 2) {
    const [a, b] = [rows * row[edges[i]], rows * row[edges[i + 1]]];
    for (let r = 0; r + 1 < rows; r++) index.push(a + r, b + r, b + r + 1, a + r, b + r + 1, a + r + 1);
  }
  return Uint32Array.from(index);
}

/** `goesOn`: whether the layer goes on beyond an edge at which the patch of faces ends. */
export type GoesOn = (a: number, b: number) => boolean;

export class Lips {
  private patch: Refinement = refine([], 0, 0, 0, () => false);
  private material = new Float32Array(0);
  /** fine vertices at the rim, their neighbours before and after along the rim, and the index of each vertex among them */
  private rim = new Int32Array(0);
  private before = new Int32Array(0);
  private after = new Int32Array(0);
  private fibres: Fibre[] = [];
  private length: number[] = [];
  private index: { band: Uint32Array; wall: Uint32Array; fringe: Uint32Array } | null = null;
  private asked: { faces: ArrayLike<number>; goesOn: GoesOn } = { faces: [], goesOn: () => false };
  private shown = true;

  constructor(
    private readonly source: SurfaceSource,
    /** thickness of the sheet; 0: the layer is not a sheet and has no lips */
    private readonly thicknessM: number,
  ) {}

  get empty(): boolean {
    return this.asked.faces.length === 0;
  }

  /** Sets the faces that are drawn finer, vertex indices (x 3), after faces of the layer were removed or restored. They are
   * refined only when shape() is called, because the page draws fewer frames than the daemon sends. */
  rebuild(faces: ArrayLike<number>, goesOn: GoesOn): void {
    this.asked = { faces, goesOn };
    this.shown = false;
  }

  private refine(): void {
    const { faces, goesOn } = this.asked;
    this.patch = refine(faces, this.source.position.length / 3, this.thicknessM > 0 ? SHEET_LEVELS : INSIDE_LEVELS, EVENINGS, goesOn);
    const { patch } = this;
    this.material = refined(patch, this.gather(this.source.material, 3), 3);
    const row = new Int32Array(patch.vertexCount).fill(-1);
    const sheet = this.thicknessM > 0;
    this.rim = sheet ? Int32Array.from(new Set(patch.rims)) : new Int32Array(0);
    this.rim.forEach((vertex, i) => (row[vertex] = i));
    this.before = this.rim.slice();
    this.after = this.rim.slice();
    for (let i = 0; sheet && i < patch.rims.length; i += 2) {
      this.after[row[patch.rims[i]]] = patch.rims[i + 1];
      this.before[row[patch.rims[i + 1]]] = patch.rims[i];
    }
    this.fibres = this.fibresAt(row);
    this.length = Array.from(this.rim, (vertex) => FRAY_M * (0.15 + 0.85 * grain(this.material, vertex)));
    const rims = sheet ? patch.rims : new Uint32Array(0);
    this.index = { band: patch.faces, wall: bandIndex(rims, row, PROFILE.length), fringe: bandIndex(rims, row, 2) };
  }

  /** Returns the shape at the present positions. Indices are returned once after faces have changed, else null. */
  shape(): LipShape {
    if (!this.shown) this.refine();
    const band = this.bandRecords();
    const index = this.shown ? null : this.index;
    this.shown = true;
    const { wall, fringe } = this.rimRecords(band);
    return {
      band: { records: band, index: index?.band ?? null },
      wall: { records: wall, index: index?.wall ?? null },
      fringe: { records: fringe, index: index?.fringe ?? null },
    };
  }

  private gather(values: Float32Array | Uint8Array, width: number, scale = 1): Float32Array<ArrayBuffer> {
    const gathered = new Float32Array(width * this.patch.roots.length);
    this.patch.roots.forEach((root, i) => {
      for (let c = 0; c < width; c++) gathered[width * i + c] = scale * values[width * root + c];
    });
    return gathered;
  }

  private bandRecords(): Float32Array {
    const { patch, material } = this;
    const position = refined(patch, this.gather(this.source.position, 3), 3);
    const burn = refined(patch, this.gather(this.source.burn, 4, 1 / 255), 4);
    const normal = this.normals(position);
    const records = new Float32Array(SURFACE_FLOATS * patch.vertexCount);
    for (let v = 0; v < patch.vertexCount; v++) {
      const at = SURFACE_FLOATS * v;
      for (let c = 0; c < 3; c++) {
        records[at + POSITION + c] = position[3 * v + c];
        records[at + MATERIAL + c] = material[3 * v + c];
        records[at + NORMAL + c] = normal[3 * v + c];
      }
      for (let c = 0; c < 4; c++) records[at + BURN + c] = burn[4 * v + c];
    }
    return records;
  }

  /** Area-weighted sums over fine faces; where the surface goes on unrefined, those that are shown there. */
  private normals(p: Float32Array): Float32Array {
    const { faces, still, roots } = this.patch;
    const normal = new Float32Array(p.length);
    for (let i = 0; i < faces.length; i += 3) {
      const a = 3 * faces[i], b = 3 * faces[i + 1], c = 3 * faces[i + 2];
      const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
      const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
      const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
      normal[a] += nx; normal[a + 1] += ny; normal[a + 2] += nz;
      normal[b] += nx; normal[b + 1] += ny; normal[b + 2] += nz;
      normal[c] += nx; normal[c + 1] += ny; normal[c + 2] += nz;
    }
    still.vertex.forEach((vertex, i) => {
      const [a, b] = [roots[still.between[2 * i]], roots[still.between[2 * i + 1]]];
      for (let c = 0; c < 3; c++) normal[3 * vertex + c] = (1 - still.share[i]) * this.source.normal[3 * a + c] + still.share[i] * this.source.normal[3 * b + c];
    });
    for (let i = 0; i < normal.length; i += 3) {
      const long = 1 / (Math.sqrt(normal[i] * normal[i] + normal[i + 1] * normal[i + 1] + normal[i + 2] * normal[i + 2]) || 1);
      normal[i] *= long; normal[i + 1] *= long; normal[i + 2] *= long;
    }
    return normal;
  }

  private fibresAt(row: Int32Array): Fibre[] {
    const { faces, kinds } = this.patch;
    const { material: m } = this;
    const fibres: Fibre[] = Array.from(this.rim, () => ({ corner: [0, 0, 0], shares: [0, 0] }));
    for (let i = 0; i < faces.length; i++) {
      if (kinds[faces[i]] !== RIM || row[faces[i]] < 0) continue;
      const first = i - (i % 3);
      const corner = [faces[i], faces[first + ((i + 1) % 3)], faces[first + ((i + 2) % 3)]] as const;
      const side = (end: number): number[] => [0, 1, 2].map((c) => m[3 * corner[end] + c] - m[3 * corner[0] + c]);
      const [u, v] = [side(1), side(2)];
      const dot = (a: number[], b: number[]): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
      const [uu, uv, vv] = [dot(u, u), dot(u, v), dot(v, v)];
      const area = uu * vv - uv * uv;
      if (area > 0) fibres[row[faces[i]]] = { corner, shares: [(u[0] * vv - v[0] * uv) / area, (v[0] * uu - u[0] * uv) / area] };
    }
    return fibres;
  }

  private rimRecords(band: Float32Array): { wall: Float32Array; fringe: Float32Array } {
    const rows = PROFILE.length;
    const wall = new Float32Array(rows * SURFACE_FLOATS * this.rim.length);
    const fringe = new Float32Array(2 * SURFACE_FLOATS * this.rim.length);
    for (let i = 0; i < this.rim.length; i++) {
      const at = SURFACE_FLOATS * this.rim[i];
      const own = band.subarray(at, at + SURFACE_FLOATS);
      const normal = own.subarray(NORMAL, NORMAL + 3);
      const out = this.outwards(band, i, normal);
      // Down is towards the ground, on whichever side the front of the mesh is.
      const down = normal[2] < 0 ? this.thicknessM : -this.thicknessM;
      PROFILE.forEach(([outward, below, turn], r) => {
        const record = wall.subarray(SURFACE_FLOATS * (rows * i + r), SURFACE_FLOATS * (rows * i + r + 1));
        record.set(own);
        record[TIP] = r / (rows - 1);
        for (let c = 0; c < 3; c++) {
          record[POSITION + c] += this.thicknessM * outward * out[c] + down * below * normal[c];
          record[NORMAL + c] = (1 - turn) * normal[c] + turn * out[c];
        }
      });
      this.fray(fringe.subarray(2 * SURFACE_FLOATS * i, 2 * SURFACE_FLOATS * (i + 1)), band, i, out);
    }
    return { wall, fringe };
  }

  /** Returns the direction out of the surface at a rim, tangential to the surface and across the rim. */
  private outwards(band: Float32Array, i: number, n: Float32Array): [number, number, number] {
    const a = SURFACE_FLOATS * this.before[i], b = SURFACE_FLOATS * this.after[i];
    const x = band[b] - band[a], y = band[b + 1] - band[a + 1], z = band[b + 2] - band[a + 2];
    const out: [number, number, number] = [y * n[2] - z * n[1], z * n[0] - x * n[2], x * n[1] - y * n[0]];
    const length = Math.hypot(...out) || 1;
    return [out[0] / length, out[1] / length, out[2] / length];
  }

  /** Writes frayed fibres. Fibres across the cut are longer than fibres along the cut. */
  private fray(records: Float32Array, band: Float32Array, i: number, out: readonly number[]): void {
    const at = SURFACE_FLOATS * this.rim[i];
    const { corner, shares } = this.fibres[i];
    const along = [0, 1, 2].map((c) => {
      const from = band[SURFACE_FLOATS * corner[0] + c];
      return shares[0] * (band[SURFACE_FLOATS * corner[1] + c] - from) + shares[1] * (band[SURFACE_FLOATS * corner[2] + c] - from);
    });
    const long = Math.hypot(...along) || 1;
    const crossed = (along[0] * out[0] + along[1] * out[1] + along[2] * out[2]) / long;
    const turn = (ALONG_FIBRE * Math.sign(crossed)) / long;
    const direction = [0, 1, 2].map((c) => turn * along[c] + (1 - ALONG_FIBRE) * out[c]);
    const reach = (this.length[i] * (SHORTEST + (1 - SHORTEST) * Math.abs(crossed))) / (Math.hypot(...direction) || 1);
    for (let end = 0; end < 2; end++) {
      const record = records.subarray(SURFACE_FLOATS * end, SURFACE_FLOATS * (end + 1));
      record.set(band.subarray(at, at + SURFACE_FLOATS));
      record[TIP] = end;
      for (let c = 0; c < 3; c++) record[POSITION + c] += end * reach * direction[c];
      // Fibres begin in the middle of the lip, not at its upper side.
      record[POSITION + 2] -= 0.4 * this.thicknessM + end * SAG * this.length[i];
    }
  }
}
