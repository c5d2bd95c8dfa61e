// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces that are drawn besides the faces of the mesh, as records of vertices.

/** Number of floats of a record: position, material coordinates, normal, the four bytes of `burn`, 0 root or 1 tip. */
export const SURFACE_FLOATS = 14;

/** Arrays of the tissue that such surfaces read; only `position`, `normal`, `burn` and `hidden` change. */
export interface SurfaceSource {
  faces: Int32Array;
  material: Float32Array;
  position: Float32Array;
  normal: Float32Array;
  /** four bytes a vertex */
  burn: Uint8Array;
  hidden: Uint8Array;
}

export interface SurfaceShape {
  records: Float32Array;
  /** indices; null: unchanged */
  index: Uint32Array | null;
}

/** Writes the record of a vertex at a position beside it. */
export function writeRecord(records: Float32Array, record: number, source: SurfaceSource, vertex: number, tip: number, beside: (c: number) => number): void {
  const at = SURFACE_FLOATS * record;
  const { position, material, normal, burn } = source;
  for (let c = 0; c < 3; c++) {
    records[at + c] = position[3 * vertex + c] + beside(c);
    records[at + 3 + c] = material[3 * vertex + c];
    records[at + 6 + c] = normal[3 * vertex + c];
  }
  for (let b = 0; b < 4; b++) records[at + 9 + b] = burn[4 * vertex + b] / 255;
  records[at + 13] = tip;
}

/** Returns the face beyond each side of each face of a layer, or -1. Side c is from corner c to the next. */
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
