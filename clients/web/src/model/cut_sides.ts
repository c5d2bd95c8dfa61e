// SPDX-License-Identifier: GPL-3.0-or-later
// Finds where a sheet was cut: sides between a drawn face and a removed face. The border of the sheet does not count.

/** Returns the vertices of faces (x 3). */
export function cornersOf(faces: Int32Array, of: Int32Array): Int32Array {
  const corners = new Int32Array(3 * of.length);
  of.forEach((face, i) => corners.set(faces.subarray(3 * face, 3 * face + 3), 3 * i));
  return corners;
}

export class CutSides {
  private readonly sides = new Set<string>();
  private readonly vertices = new Set<number>();

  constructor(
    private readonly faces: Int32Array,
    layerFaces: Int32Array,
    /** see makeNeighbours in surface.ts */
    neighbours: Int32Array,
    hidden: Uint8Array,
  ) {
    layerFaces.forEach((face, i) => {
      for (let c = 0; !hidden[face] && c < 3; c++) {
        const beyond = neighbours[3 * i + c];
        if (beyond < 0 || !hidden[beyond]) continue;
        const [a, b] = [faces[3 * face + c], faces[3 * face + ((c + 1) % 3)]];
        this.sides.add(sideKey(a, b));
        this.vertices.add(a).add(b);
      }
    });
  }

  has(a: number, b: number): boolean {
    return this.sides.has(sideKey(a, b));
  }

  /** Returns whether a face has a vertex on a cut. */
  touches(face: number): boolean {
    const { faces, vertices } = this;
    return vertices.size > 0 && (vertices.has(faces[3 * face]) || vertices.has(faces[3 * face + 1]) || vertices.has(faces[3 * face + 2]));
  }
}

function sideKey(a: number, b: number): string {
  return a < b ? `${a} ${b}` : `${b} ${a}`;
}
