// SPDX-License-Identifier: GPL-3.0-or-later
// The edge of a sheet, which has no thickness in the daemon's mesh: a wall as high as the sheet is thick, down
// from every side at its border. Cuts have lips of their own (lips.ts). Only sight.
import { SURFACE_FLOATS, writeRecord, type SurfaceShape, type SurfaceSource } from './surface';

/** Of two triangles for each pair of rows, between their upper (2 row) and lower (2 row + 1) records. */
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

  /** After faces of the layer went or came back. */
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

  /** The wall where the tissue is now; index is shared with later shapes until faces change. */
  shape(): SurfaceShape {
    const records = new Float32Array(2 * SURFACE_FLOATS * this.vertices.length);
    const { normal } = this.source;
    this.vertices.forEach((vertex, i) => {
      // Down is where the ground is, whichever side the mesh calls its front.
      const sunk = this.thicknessM * (normal[3 * vertex + 2] < 0 ? 1 : -1);
      for (let under = 0; under < 2; under++)
        writeRecord(records, 2 * i + under, this.source, vertex, under, (c) => under * sunk * normal[3 * vertex + c]);
    });
    return { records, index: this.index };
  }
}
