// SPDX-License-Identifier: GPL-3.0-or-later
// A patch of triangles as a smooth surface, finer than the mesh: Loop's subdivision (1987). Inside it tends to a
// surface of smooth curvature. Rims tend to the cubic B-spline of the rim's vertices, which depends on nothing
// beside the rim. Joined triangles stay joined, and separate ones stay separate. It changes the picture alone.

/** Kinds of edges and vertices. */
export const SMOOTH = 0;
export const RIM = 1; // the surface ends here
export const STILL = 2; // stays on the mesh, where the surface continues unrefined

/** One step. The new value of a vertex is `own` times its value plus `share` times the value of each neighbour, at a rim of
 * the neighbours along the rim. A step that divides adds one vertex on each edge. */
interface Step {
  divides: boolean;
  own: Float32Array;
  share: Float32Array;
  vertexKind: Uint8Array;
  edges: Uint32Array;
  edgeKind: Uint8Array;
  /** third vertices of the two faces at each edge; not used at a rim */
  thirds: Uint32Array;
}

export interface Refinement {
  /** vertex of the mesh for each vertex of the patch; a vertex at which the patch is pinched appears once for each side */
  roots: Int32Array;
  steps: Step[];
  vertexCount: number;
  /** fine triangles (x 3) */
  faces: Uint32Array;
  /** fine edges (x 2) at which the surface ends; the surface is on their left, seen from the front of its faces */
  rims: Uint32Array;
  /** SMOOTH, RIM or STILL for each fine vertex */
  kinds: Uint8Array;
  /** fine vertices on edges that stay on the mesh: the two vertices of the patch beside each, and the position between */
  still: { vertex: Int32Array; between: Int32Array; share: Float32Array };
}

/** A mesh during refinement: edges with the third vertices of their faces, faces with their edges. */
interface Net {
  vertexCount: number;
  vertexKind: Uint8Array;
  faces: Uint32Array;
  /** edge from corner c to the next, by face */
  faceEdges: Uint32Array;
  edges: Uint32Array;
  edgeKind: Uint8Array;
}

/** Returns the weight of each neighbour for a vertex with `count` neighbours (Loop). */
function ringWeight(count: number): number {
  const turn = 3 / 8 + Math.cos((2 * Math.PI) / count) / 4;
  return (5 / 8 - turn * turn) / count;
}

/** Whether a vertex uses the value at the other end of an edge. */
const takes = (vertexKind: number, edgeKind: number): boolean => vertexKind === SMOOTH || (vertexKind === RIM && edgeKind === RIM);

/** Returns the number of neighbours that each vertex uses. */
function takenOf({ vertexCount, vertexKind, edges, edgeKind }: Net): Uint16Array {
  const count = new Uint16Array(vertexCount);
  for (let i = 0; i < edges.length; i++) if (takes(vertexKind[edges[i]], edgeKind[i >> 1])) count[edges[i]]++;
  return count;
}

function stepOf(net: Net, divides: boolean, shareOf: (kind: number, count: number) => number): Step {
  const { vertexCount, vertexKind, edges, edgeKind, faces, faceEdges } = net;
  const count = takenOf(net);
  const own = new Float32Array(vertexCount);
  const share = new Float32Array(vertexCount);
  for (let v = 0; v < vertexCount; v++) {
    share[v] = count[v] > 0 ? shareOf(vertexKind[v], count[v]) : 0;
    own[v] = 1 - count[v] * share[v];
  }
  const thirds = new Uint32Array(edges.length);
  const known = new Uint8Array(edgeKind.length);
  for (let i = 0; divides && i < faceEdges.length; i++) {
    const edge = faceEdges[i];
    thirds[2 * edge + Math.min(known[edge]++, 1)] = faces[i - (i % 3) + ((i + 2) % 3)];
  }
  return { divides, own, share, vertexKind, edges, edgeKind, thirds };
}

/** Loop's subdivision step: the vertices of the next net. */
const divided = (net: Net): Step => stepOf(net, true, (kind, count) => (kind === RIM ? 1 / 8 : ringWeight(count)));

/** Smoothing step for the teeth of the border. Each vertex moves half way to the mean of its neighbours, at a rim of the
 * neighbours along the rim. */
const evened = (net: Net): Step => stepOf(net, false, (_kind, count) => 1 / (2 * count));

/** Divides each face into four: one at each corner, one between the middles of its edges. */
function split(net: Net): Net {
  const { vertexCount: base, faces, faceEdges, edges, edgeKind } = net;
  const edgeCount = edgeKind.length;
  const faceCount = faces.length / 3;
  const half = (edge: number, vertex: number): number => 2 * edge + (edges[2 * edge] === vertex ? 0 : 1);
  const next: Net = {
    vertexCount: base + edgeCount,
    vertexKind: new Uint8Array(base + edgeCount),
    faces: new Uint32Array(12 * faceCount),
    faceEdges: new Uint32Array(12 * faceCount),
    edges: new Uint32Array(2 * (2 * edgeCount + 3 * faceCount)),
    edgeKind: new Uint8Array(2 * edgeCount + 3 * faceCount),
  };
  next.vertexKind.set(net.vertexKind);
  next.vertexKind.set(edgeKind, base);
  for (let e = 0; e < edgeCount; e++) {
    const i = 4 * e;
    next.edges[i] = edges[2 * e];
    next.edges[i + 1] = next.edges[i + 2] = base + e;
    next.edges[i + 3] = edges[2 * e + 1];
    next.edgeKind[2 * e] = next.edgeKind[2 * e + 1] = edgeKind[e];
  }
  for (let f = 0; f < faceCount; f++) {
    const inner = 2 * edgeCount + 3 * f;
    const middle = 12 * f + 9;
    for (let c = 0; c < 3; c++) {
      const vertex = faces[3 * f + c], after = faceEdges[3 * f + c], before = faceEdges[3 * f + ((c + 2) % 3)];
      const i = 12 * f + 3 * c;
      next.edges[2 * (inner + c)] = base + after;
      next.edges[2 * (inner + c) + 1] = base + before;
      next.faces[i] = vertex;
      next.faces[i + 1] = next.faces[middle + c] = base + after;
      next.faces[i + 2] = base + before;
      next.faceEdges[i] = half(after, vertex);
      next.faceEdges[i + 1] = inner + c;
      next.faceEdges[i + 2] = half(before, vertex);
      next.faceEdges[middle + c] = inner + ((c + 1) % 3);
    }
  }
  return next;
}

/** Returns the sides of faces (3 face + corner) by edge. */
function sidesByEdge(faces: ArrayLike<number>, vertexCount: number): Map<number, number[]> {
  const sides = new Map<number, number[]>();
  for (let i = 0; i < faces.length; i++) {
    const [a, b] = [faces[i], faces[i - (i % 3) + ((i + 1) % 3)]];
    const key = a < b ? a * vertexCount + b : b * vertexCount + a;
    const known = sides.get(key);
    if (known) known.push(i);
    else sides.set(key, [i]);
  }
  return sides;
}

/** Returns the faces with equal orientation, because faces between tetrahedra have arbitrary orientation. */
function turnedAlike(given: ArrayLike<number>, vertexCount: number): Int32Array {
  const faces = Int32Array.from(given);
  const beside = new Map<number, number[]>();
  for (const sides of sidesByEdge(given, vertexCount).values()) {
    if (sides.length !== 2) continue;
    for (const end of [0, 1]) beside.set(sides[end], [sides[1 - end]]);
  }
  const seen = new Uint8Array(faces.length / 3);
  const turned = new Uint8Array(faces.length / 3);
  for (let first = 0; first < seen.length; first++) {
    const queue = seen[first] ? [] : [first];
    seen[first] = 1;
    for (let face = queue.pop(); face !== undefined; face = queue.pop()) {
      for (let c = 0; c < 3; c++) {
        const [side] = beside.get(3 * face + c) ?? [-1];
        const other = Math.trunc(side / 3);
        if (side < 0 || seen[other]) continue;
        seen[other] = 1;
        turned[other] = turned[face] ^ Number(given[3 * face + c] === given[side]);
        queue.push(other);
      }
    }
  }
  turned.forEach((turn, face) => {
    if (turn) faces.set([given[3 * face], given[3 * face + 2], given[3 * face + 1]], 3 * face);
  });
  return faces;
}

/** Joins the corners of connected faces around a vertex to one vertex of the patch. */
function weld(faces: Int32Array, sides: Map<number, number[]>): { roots: Int32Array; corners: Uint32Array } {
  const parent = Int32Array.from(faces, (_, i) => i);
  const find = (corner: number): number => {
    while (parent[corner] !== corner) corner = parent[corner] = parent[parent[corner]];
    return corner;
  };
  const after = (side: number): number => side - (side % 3) + ((side + 1) % 3);
  for (const pair of sides.values()) {
    if (pair.length !== 2) continue;
    const [mine, other] = [[pair[0], after(pair[0])], [pair[1], after(pair[1])]];
    const crossed = faces[mine[0]] === faces[other[0]] ? 0 : 1;
    for (const end of [0, 1]) parent[find(mine[end])] = find(other[end ^ crossed]);
  }
  const number = new Int32Array(faces.length).fill(-1);
  const roots: number[] = [];
  const corners = Uint32Array.from(faces, (vertex, corner) => {
    const found = find(corner);
    if (number[found] < 0) number[found] = roots.push(vertex) - 1;
    return number[found];
  });
  return { roots: Int32Array.from(roots), corners };
}

function netOf(given: ArrayLike<number>, vertexCount: number, goesOn: (a: number, b: number) => boolean): { net: Net; roots: Int32Array } {
  const turned = turnedAlike(given, vertexCount);
  const sides = sidesByEdge(turned, vertexCount);
  const { roots, corners } = weld(turned, sides);
  const faceEdges = new Uint32Array(turned.length);
  const edges: number[] = [];
  const edgeKind: number[] = [];
  for (const of of sides.values()) {
    const [a, b] = [turned[of[0]], turned[of[0] - (of[0] % 3) + ((of[0] + 1) % 3)]];
    const kind = of.length === 2 ? SMOOTH : goesOn(a, b) ? STILL : RIM;
    // Where more than two faces meet at an edge, each face has a rim.
    for (const side of of.length === 2 ? of.slice(0, 1) : of) {
      for (const same of of.length === 2 ? of : [side]) faceEdges[same] = edgeKind.length;
      edges.push(corners[side], corners[side - (side % 3) + ((side + 1) % 3)]);
      edgeKind.push(kind);
    }
  }
  const net: Net = { vertexCount: roots.length, vertexKind: new Uint8Array(roots.length), faces: corners, faceEdges, edges: Uint32Array.from(edges), edgeKind: Uint8Array.from(edgeKind) };
  markVertices(net);
  return { net, roots };
}

/** Marks vertices: a vertex stays on the mesh where a rim begins, or where the surface continues unrefined. */
function markVertices(net: Net): void {
  const rims = new Uint8Array(net.vertexCount);
  net.edgeKind.forEach((kind, e) => {
    if (kind === SMOOTH) return;
    for (const end of [0, 1]) {
      const vertex = net.edges[2 * e + end];
      if (kind === STILL) net.vertexKind[vertex] = STILL;
      else rims[vertex]++;
    }
  });
  rims.forEach((count, vertex) => {
    if (count > 0 && net.vertexKind[vertex] !== STILL) net.vertexKind[vertex] = count === 2 ? RIM : STILL;
  });
}

/** Returns the fine vertices on edges that stay on the mesh, from the first step on. */
function stillOf(first: Net, last: Net, levels: number): Refinement['still'] {
  const vertex: number[] = [];
  const between: number[] = [];
  const share: number[] = [];
  first.edgeKind.forEach((kind, e) => {
    if (kind !== STILL) return;
    const parts = 1 << levels;
    // Edge e of a net is edges 2 e and 2 e + 1 of the next, in order.
    for (let part = 0; part < parts; part++) {
      const fine = parts * e + part;
      vertex.push(last.edges[2 * fine]);
      between.push(first.edges[2 * e], first.edges[2 * e + 1]);
      share.push(part / parts);
    }
    vertex.push(first.edges[2 * e + 1]);
    between.push(first.edges[2 * e], first.edges[2 * e + 1]);
    share.push(1);
  });
  return { vertex: Int32Array.from(vertex), between: Int32Array.from(between), share: Float32Array.from(share) };
}

/** Triangles (x 3) after so many steps, each of which divides sides in two, and before them so many that even the
 * patch's vertices out; `goesOn`: whether the surface goes on beyond an edge at which the patch ends. */
export function refine(faces: ArrayLike<number>, vertexCount: number, levels: number, evenings: number, goesOn: (a: number, b: number) => boolean): Refinement {
  const { net: first, roots } = netOf(faces, vertexCount, goesOn);
  let net = first;
  const steps: Step[] = Array.from({ length: evenings }, () => evened(net));
  for (let level = 0; level < levels; level++) {
    steps.push(divided(net));
    net = split(net);
  }
  const rims: number[] = [];
  net.edgeKind.forEach((kind, e) => {
    if (kind === RIM) rims.push(net.edges[2 * e], net.edges[2 * e + 1]);
  });
  return { roots, steps, vertexCount: net.vertexCount, faces: net.faces, rims: Uint32Array.from(rims), kinds: net.vertexKind, still: stillOf(first, net, levels) };
}

function advance(step: Step, values: Float32Array, width: number): Float32Array<ArrayBuffer> {
  const { divides, own, share, vertexKind, edges, edgeKind, thirds } = step;
  const next = new Float32Array(width * (own.length + (divides ? edgeKind.length : 0)));
  for (let v = 0, i = 0; v < own.length; v++) for (let c = 0; c < width; c++, i++) next[i] = own[v] * values[i];
  for (let e = 0; e < edgeKind.length; e++) {
    const kind = edgeKind[e];
    const v = edges[2 * e], w = edges[2 * e + 1];
    const a = width * v, b = width * w;
    const ofB = takes(vertexKind[v], kind) ? share[v] : 0;
    const ofA = takes(vertexKind[w], kind) ? share[w] : 0;
    for (let c = 0; c < width; c++) {
      next[a + c] += ofB * values[b + c];
      next[b + c] += ofA * values[a + c];
    }
    if (!divides) continue;
    const at = width * (own.length + e);
    const l = width * thirds[2 * e], r = width * thirds[2 * e + 1];
    const near = kind === SMOOTH ? 3 / 8 : 1 / 2, far = kind === SMOOTH ? 1 / 8 : 0;
    for (let c = 0; c < width; c++) next[at + c] = near * (values[a + c] + values[b + c]) + far * (values[l + c] + values[r + c]);
  }
  return next;
}

/** Returns the values of the fine vertices (x width) from the values of the vertices of the patch (x width). */
export function refined({ steps }: Refinement, coarse: Float32Array<ArrayBuffer>, width: number): Float32Array<ArrayBuffer> {
  return steps.reduce((values, step) => advance(step, values, width), coarse);
}
