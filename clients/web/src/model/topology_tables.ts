// SPDX-License-Identifier: GPL-3.0-or-later
// Tables that depend on the faces only, computed once for each session: the faces at each vertex, and the faces inside of
// fat, which are visible only when the tissue in front of them was removed.

/** Faces at each vertex in rows: those of vertex v are items[start[v]] to items[start[v + 1] - 1]. */
export interface VertexFaces {
  start: Int32Array;
  items: Int32Array;
}

export function makeVertexFaces(faces: Int32Array, vertexCount: number): VertexFaces {
  const start = new Int32Array(vertexCount + 1);
  for (const vertex of faces) start[vertex + 1]++;
  for (let v = 0; v < vertexCount; v++) start[v + 1] += start[v];
  const items = new Int32Array(faces.length);
  const next = start.slice();
  for (let i = 0; i < faces.length; i++) items[next[faces[i]]++] = Math.trunc(i / 3);
  return { start, items };
}

function edgeKey(a: number, b: number, vertexCount: number): number {
  return a < b ? a * vertexCount + b : b * vertexCount + a;
}

/** Returns the third vertices of the faces on each edge. */
function oppositeVertices(faces: Int32Array, of: Int32Array, vertexCount: number): Map<number, number[]> {
  const opposite = new Map<number, number[]>();
  for (const face of of) {
    for (let c = 0; c < 3; c++) {
      const key = edgeKey(faces[3 * face + c], faces[3 * face + ((c + 1) % 3)], vertexCount);
      const list = opposite.get(key);
      const third = faces[3 * face + ((c + 2) % 3)];
      if (list) list.push(third);
      else opposite.set(key, [third]);
    }
  }
  return opposite;
}

/**
 * Marks the faces of one fat layer that lie between two tetrahedra, or under a face of `covers`: with
 * each apex whose three faces to the sides exist, a face bounds one tetrahedron.
 */
export function markInnerFaces(
  faces: Int32Array,
  fat: Int32Array,
  covers: Int32Array,
  vertexCount: number,
  inner: Uint8Array,
): void {
  const opposite = oppositeVertices(faces, fat, vertexCount);
  const covered = oppositeVertices(faces, covers, vertexCount);
  for (const face of fat) {
    const [a, b, c] = faces.subarray(3 * face, 3 * face + 3);
    const ab = opposite.get(edgeKey(a, b, vertexCount)) ?? [];
    const bc = opposite.get(edgeKey(b, c, vertexCount)) ?? [];
    const ca = opposite.get(edgeKey(c, a, vertexCount)) ?? [];
    let apices = 0;
    for (const apex of ab) if (apex !== c && bc.includes(apex) && ca.includes(apex)) apices++;
    const under = covered.get(edgeKey(a, b, vertexCount))?.includes(c) === true;
    inner[face] = apices > 1 || under ? 1 : 0;
  }
}
