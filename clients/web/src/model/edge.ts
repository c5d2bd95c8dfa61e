// SPDX-License-Identifier: GPL-3.0-or-later
// The edge of a sheet, which has no thickness in the mesh of the daemon: a wall down from every side at its border, as high
// as the sheet is thick. Cuts have lips instead (lips.ts). This is for drawing only.
import { SURFACE_FLOATS, writeRecord, type SurfaceShape, type SurfaceSource } from './surface';

/** Returns the indices of two triangles for each pair, between the upper (2 i) and lower (2 i + 1) records of both. */
function bandIndex(pairs: readonly (readonly [number, number])[]): Uint32Array<ArrayBuffer> {
  return Uint32Array.from(pairs.flatMap(([a, b]) => [2 * a, 2 * b, 2 * b + 1, 2 * a, 2 * b + 1, 2 * a + 1]));
}

export class Edge {
  private vertices: number[] = [];
  private index = new Uint32Array(0);

  constructor(
    private readonly source: SurfaceSource,
    private readonly layerFaces: Int32Array,
    /** see makeNeighbours in surface.ts */
    private readonly neighbours: Int32Array,
    private readonly thicknessM: number,
  ) {}

  get vertexCount(): number {
    return this.vertices.length;
  }

  /** Finds the sides at the border again, after faces of the layer were removed or restored. */
  rebuild(): void {
    const { faces, hidden } = this.source;
    const rows = new Map<number, number>();
    const pairs: [number, number][] = [];
    this.vertices = [];
    const row = (vertex: number): number => {
      const known = rows.get(vertex);
      if (known !== undefined) return known;
      rows.set(vertex, this.vertices.length);
      return this.vertices.push(vertex) - 1;
    };
    this.layerFaces.forEach((face, i) => {
      if (hidden[face]) return;
      for (let c = 0; c < 3; c++) {
        if (this.neighbours[3 * i + c] < 0) pairs.push([row(faces[3 * face + c]), row(faces[3 * face + ((c + 1) % 3)])]);
      }
    });
    this.index = bandIndex(pairs);
  }

  /** Returns the wall at the present positions. The index is shared with later shapes until faces change. */
  shape(): SurfaceShape {
    const records = new Float32Array(2 * SURFACE_FLOATS * this.vertices.length);
    const { normal } = this.source;
    this.vertices.forEach((vertex, i) => {
      // Down is towards the ground, on whichever side the front of the mesh is.
      const sunk = this.thicknessM * (normal[3 * vertex + 2] < 0 ? 1 : -1);
      for (let under = 0; under < 2; under++)
        writeRecord(records, 2 * i + under, this.source, vertex, under, (c) => under * sunk * normal[3 * vertex + c]);
    });
    return { records, index: this.index };
  }
}
