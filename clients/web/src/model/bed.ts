// SPDX-License-Identifier: GPL-3.0-or-later
// The bed under the tissue, for drawing only: a hollow under a sheet, or a well for solid tissue with a shelf around it. The
// bed follows the tissue: it is lowered with the tissue, so that it is never visible above it.
import { hills, HIDDEN_M, OVERLAP_M, scaleOf, ZONES, type FieldShape, type Surroundings } from './field_shape';

const CELL_M = 0.005; // longer than a side of usual meshes; for tissue of USUAL_M
const STEP_M = 1e-4; // width of the wall between shelf and well
const BOWL_M = 0.009; // depth of the hollow under a sheet without tissue below
const UNDER_M = 0.001; // distance of the well below solid tissue
/** Cells around a place whose tissue it stays below: a triangle's corners are no farther than one cell, a wall and what lies over it. */
const REACH = 4;

/** Returns the positions of lines from one end to another. */
function lines(from: number, to: number, between: readonly number[], cell: number): Float32Array {
  const ends = [from, ...between.filter((at) => at > from && at < to), to];
  const all = [from];
  for (let i = 1; i < ends.length; i++) {
    const count = Math.max(1, Math.ceil((ends[i] - ends[i - 1]) / cell - 1e-6));
    for (let k = 1; k <= count; k++) all.push(ends[i - 1] + ((ends[i] - ends[i - 1]) * k) / count);
  }
  return Float32Array.from(all);
}

/** Returns the cell between two lines that contains a position; beyond the ends, the last cell. */
function cellAt(line: Float32Array, at: number): number {
  let [low, high] = [0, line.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (line[middle] <= at) low = middle;
    else high = middle;
  }
  return low;
}

export class Bed {
  readonly shape: FieldShape;
  private readonly x: Float32Array;
  private readonly y: Float32Array;
  /** height of each crossing of lines without tissue below it, m */
  private readonly base: Float32Array;
  /** largest height of each cell, m */
  private readonly limit: Float32Array;
  /** vertices that never push it: those beside the wall of a well, which are below its shelf at rest, and those of no face */
  private readonly exempt: Uint8Array;
  private following = false;

  /** rest: m (vertices x 3) */
  constructor(
    private readonly surroundings: Surroundings,
    rest: Float32Array,
  ) {
    const { all, solid } = surroundings;
    const cell = CELL_M * scaleOf(all);
    // A wall of the well is between two lines. A third one over the tissue's side keeps the shading of the wall's corner under it.
    const walls = (c: 0 | 1): number[] => {
      if (!solid) return [];
      const [low, high] = [solid.least[c], solid.most[c]];
      return [low, low + OVERLAP_M - STEP_M / 2, low + OVERLAP_M + STEP_M / 2, high - OVERLAP_M - STEP_M / 2, high - OVERLAP_M + STEP_M / 2, high];
    };
    this.x = lines(all.least[0], all.most[0], walls(0), cell);
    this.y = lines(all.least[1], all.most[1], walls(1), cell);
    this.base = new Float32Array(this.x.length * this.y.length);
    this.limit = new Float32Array((this.x.length - 1) * (this.y.length - 1));
    this.shape = this.build();
    this.exempt = this.exempted(rest);
  }

  /** Lowers the bed below the present tissue, m (vertices x 3). Returns whether the bed changed. */
  follow(position: Float32Array): boolean {
    const { x, y, limit, exempt } = this;
    limit.fill(Infinity);
    let pushed = false;
    for (let v = 0, at = 0; v < exempt.length; v++, at += 3) {
      if (exempt[v]) continue;
      const [i, j] = [cellAt(x, position[at]), cellAt(y, position[at + 1])];
      const below = position[at + 2] - HIDDEN_M;
      if (below >= this.highest(i, j)) continue;
      const cell = j * (x.length - 1) + i;
      limit[cell] = Math.min(limit[cell], below);
      pushed = true;
    }
    if (!pushed && !this.following) return false;
    this.following = pushed;
    this.settle();
    return true;
  }

  private build(): FieldShape {
    const [nx, ny] = [this.x.length, this.y.length];
    const position = new Float32Array(3 * nx * ny);
    const zone = new Float32Array(nx * ny);
    for (let j = 0, v = 0; j < ny; j++) {
      for (let i = 0; i < nx; i++, v++) {
        const { z, kind } = this.atRest(this.x[i], this.y[j]);
        this.base[v] = z;
        zone[v] = kind;
        position.set([this.x[i], this.y[j], z], 3 * v);
      }
    }
    const index: number[] = [];
    for (let j = 0; j + 1 < ny; j++)
      for (let i = 0; i + 1 < nx; i++) {
        const a = j * nx + i;
        index.push(a, a + 1, a + nx + 1, a, a + nx + 1, a + nx);
      }
    return { position, zone, index: Uint32Array.from(index) };
  }

  private atRest(x: number, y: number): { z: number; kind: number } {
    const { all, solid, edgeZ } = this.surroundings;
    const scale = scaleOf(all);
    if (!solid) {
      const share = Math.max(...[x, y].map((at, c) => Math.abs((2 * at - all.least[c] - all.most[c]) / (all.most[c] - all.least[c]))));
      const deep = 1 - share ** 6;
      return { z: edgeZ - HIDDEN_M - scale * deep * (BOWL_M - 0.0012 * hills((90 * x) / scale, (90 * y) / scale)), kind: ZONES.muscle };
    }
    const inWell = [x, y].every((at, c) => at > solid.least[c] + OVERLAP_M && at < solid.most[c] - OVERLAP_M);
    if (inWell) return { z: solid.least[2] - UNDER_M, kind: ZONES.muscle };
    return { z: Math.min(solid.most[2], edgeZ) - HIDDEN_M, kind: ZONES.fat };
  }

  /** Returns the largest height of the bed at rest in a cell. */
  private highest(i: number, j: number): number {
    const { base, x } = this;
    const at = j * x.length + i;
    return Math.max(base[at], base[at + 1], base[at + x.length], base[at + x.length + 1]);
  }

  private exempted(rest: Float32Array): Uint8Array {
    const { least, most } = this.surroundings.all;
    return Uint8Array.from({ length: rest.length / 3 }, (_, v) => {
      const at = rest.subarray(3 * v, 3 * v + 3);
      if (at.some((value, c) => value < least[c] || value > most[c])) return 1;
      return Number(at[2] - HIDDEN_M < this.highest(cellAt(this.x, at[0]), cellAt(this.y, at[1])) - 1e-6);
    });
  }

  /** Lowers each crossing below the limits of all cells around it. */
  private settle(): void {
    const [nx, ny] = [this.x.length, this.y.length];
    const { position } = this.shape;
    const along = new Float32Array(nx * (ny - 1));
    for (let j = 0; j + 1 < ny; j++)
      for (let i = 0; i < nx; i++) {
        let least = Infinity;
        for (let k = Math.max(i - REACH, 0); k < Math.min(i + REACH, nx - 1); k++) least = Math.min(least, this.limit[j * (nx - 1) + k]);
        along[j * nx + i] = least;
      }
    for (let j = 0; j < ny; j++)
      for (let i = 0; i < nx; i++) {
        let least = this.base[j * nx + i];
        for (let k = Math.max(j - REACH, 0); k < Math.min(j + REACH, ny - 1); k++) least = Math.min(least, along[k * nx + i]);
        position[3 * (j * nx + i) + 2] = least;
      }
  }
}
