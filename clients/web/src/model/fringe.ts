// SPDX-License-Identifier: GPL-3.0-or-later
// What hangs off the rims of a cut sheet: a band of torn fibres, as long as the sheet's faces are wide,
// from each rim outwards. The shader leaves single fibres of it. Only sight: nothing of it is in the daemon.

/** Floats of a record: position, material coordinates, normal, the four of `burn`, 0 root or 1 tip. */
export const FRINGE_FLOATS = 14;
const LONGEST_M = 0.003;
/** of fibres beside which the cut ran, over those that it crossed */
const SHORTEST = 0.55;
const SAG = 0.35; // of tips, over their length

/** Arrays of the tissue that a fringe reads; only `position`, `normal`, `burn` and `hidden` change. */
export interface FringeSource {
  faces: Int32Array;
  material: Float32Array;
  position: Float32Array;
  normal: Float32Array;
  burn: Uint8Array;
  burnBytes: number;
  hidden: Uint8Array;
}

export interface FringeShape {
  /** two records, root and tip, for each vertex on a rim */
  records: Float32Array;
  index: Uint32Array;
}

/** Of two triangles for each pair of rows, between their roots (2 row) and tips (2 row + 1). */
export function bandIndex(pairs: readonly (readonly [number, number])[]): Uint32Array<ArrayBuffer> {
  return Uint32Array.from(pairs.flatMap(([a, b]) => [2 * a, 2 * b, 2 * b + 1, 2 * a, 2 * b + 1, 2 * a + 1]));
}

/** What a vertex is, at a place beside it. */
export function writeRecord(records: Float32Array, record: number, source: FringeSource, vertex: number, tip: number, beside: (c: number) => number): void {
  const at = FRINGE_FLOATS * record;
  const { position, material, normal, burn, burnBytes } = source;
  for (let c = 0; c < 3; c++) {
    records[at + c] = position[3 * vertex + c] + beside(c);
    records[at + 3 + c] = material[3 * vertex + c];
    records[at + 6 + c] = normal[3 * vertex + c];
  }
  for (let b = 0; b < 4; b++) records[at + 9 + b] = burn[burnBytes * vertex + b] / 255;
  records[at + 13] = tip;
}

function hash(vertex: number): number {
  const mixed = Math.imul(vertex ^ (vertex >>> 7), 0x9e3779b1) >>> 0;
  return mixed / 2 ** 32;
}

/** The face beyond each side of each face of a layer, or -1; side c runs from corner c to the next. */
export function makeNeighbours(faces: Int32Array, of: Int32Array, vertexCount: number): Int32Array {
  const neighbours = new Int32Array(3 * of.length).fill(-1);
  const first = new Map<number, number>();
  of.forEach((face, i) => {
    for (let c = 0; c < 3; c++) {
      const a = faces[3 * face + c];
      const b = faces[3 * face + ((c + 1) % 3)];
      const key = a < b ? a * vertexCount + b : b * vertexCount + a;
      const other = first.get(key);
      if (other === undefined) {
        first.set(key, 3 * i + c);
      } else {
        neighbours[3 * i + c] = of[Math.trunc(other / 3)];
        neighbours[other] = face;
      }
    }
  });
  return neighbours;
}

export class Fringe {
  private readonly length: number;
  private vertices: number[] = [];
  /** drawn faces at each vertex of a rim */
  private sides: number[][] = [];
  /** over the length, for each vertex of a rim */
  private reach: number[] = [];
  private index = new Uint32Array(0);

  constructor(
    private readonly source: FringeSource,
    private readonly layerFaces: Int32Array,
    /** see makeNeighbours */
    private readonly neighbours: Int32Array,
  ) {
    this.length = Math.min(1.3 * this.meanSide(), LONGEST_M);
  }

  get rimVertexCount(): number {
    return this.vertices.length;
  }

  /** After faces of the layer went or came back. */
  rebuild(): void {
    const { faces, hidden } = this.source;
    const rows = new Map<number, number>();
    const pairs: [number, number][] = [];
    this.vertices = [];
    this.sides = [];
    const row = (vertex: number, face: number): number => {
      let at = rows.get(vertex);
      if (at === undefined) {
        at = this.vertices.push(vertex) - 1;
        rows.set(vertex, at);
        this.sides.push([]);
      }
      if (!this.sides[at].includes(face)) this.sides[at].push(face);
      return at;
    };
    this.layerFaces.forEach((face, i) => {
      if (!hidden[face]) return;
      for (let c = 0; c < 3; c++) {
        const drawn = this.neighbours[3 * i + c];
        if (drawn < 0 || hidden[drawn]) continue;
        pairs.push([row(faces[3 * face + c], drawn), row(faces[3 * face + ((c + 1) % 3)], drawn)]);
      }
    });
    this.index = bandIndex(pairs);
    this.reach = this.vertices.map((vertex, i) => this.reachOf(vertex, this.sides[i]));
  }

  /** The band where the tissue is now; index is shared with later shapes until faces change. */
  shape(): FringeShape {
    const records = new Float32Array(2 * FRINGE_FLOATS * this.vertices.length);
    this.vertices.forEach((vertex, i) => {
      const out = this.outwards(this.source.position, vertex, this.sides[i]);
      const reach = this.reach[i];
      for (let tip = 0; tip < 2; tip++)
        writeRecord(records, 2 * i + tip, this.source, vertex, tip, (c) => tip * reach * (out[c] - (c === 2 ? SAG : 0)));
    });
    return { records, index: this.index };
  }

  private meanSide(): number {
    const { faces, material } = this.source;
    let sum = 0;
    for (const face of this.layerFaces) {
      const a = 3 * faces[3 * face];
      const b = 3 * faces[3 * face + 1];
      sum += Math.hypot(material[b] - material[a], material[b + 1] - material[a + 1], material[b + 2] - material[a + 2]);
    }
    return sum / Math.max(this.layerFaces.length, 1);
  }

  /** From the drawn faces at a vertex away, a unit vector in the space of `at`. */
  private outwards(at: Float32Array, vertex: number, sides: readonly number[]): [number, number, number] {
    const { faces } = this.source;
    const out: [number, number, number] = [0, 0, 0];
    for (const face of sides)
      for (let corner = 3 * face; corner < 3 * face + 3; corner++)
        for (let c = 0; c < 3; c++) out[c] += at[3 * vertex + c] - at[3 * faces[corner] + c];
    const length = Math.hypot(...out) || 1;
    return [out[0] / length, out[1] / length, out[2] / length];
  }

  /** Fibres that the cut crossed stand out further than those that it ran along. */
  private reachOf(vertex: number, sides: readonly number[]): number {
    const [along] = this.outwards(this.source.material, vertex, sides);
    return this.length * (SHORTEST + (1 - SHORTEST) * Math.abs(along)) * (0.5 + 0.8 * hash(vertex));
  }
}
