// SPDX-License-Identifier: GPL-3.0-or-later
import { Edge } from '../../../../clients/web/src/model/edge';
import { Fringe, FRINGE_FLOATS, makeNeighbours } from '../../../../clients/web/src/model/fringe';

const SINGLE = 1e-6;
/** A strip of four squares along x, each of two triangles; its width is along y. */
const SQUARES = 4;
const VERTICES = 2 * (SQUARES + 1);
const SIDE_M = 0.002;
const faces = Int32Array.from(Array.from({ length: SQUARES }, (_, i) => [2 * i, 2 * i + 2, 2 * i + 3, 2 * i, 2 * i + 3, 2 * i + 1]).flat());

const THICK_M = 0.0004;

function strip(): { fringe: Fringe; edge: Edge; hidden: Uint8Array; burn: Uint8Array; normal: Float32Array } {
  const position = new Float32Array(3 * VERTICES);
  const normal = new Float32Array(3 * VERTICES);
  for (let v = 0; v < VERTICES; v++) {
    position.set([SIDE_M * (v >> 1), SIDE_M * (v & 1), 0], 3 * v);
    normal[3 * v + 2] = 1;
  }
  const hidden = new Uint8Array(2 * SQUARES);
  const burn = new Uint8Array(4 * VERTICES);
  const source = { faces, material: position.slice(), position, normal, burn, burnBytes: 4, hidden };
  const all = Int32Array.from({ length: 2 * SQUARES }, (_, i) => i);
  const neighbours = makeNeighbours(faces, all, VERTICES);
  return { fringe: new Fringe(source, all, neighbours), edge: new Edge(source, all, neighbours, THICK_M), hidden, burn, normal };
}

const record = (records: Float32Array, i: number): Float32Array => records.subarray(FRINGE_FLOATS * i, FRINGE_FLOATS * (i + 1));

describe('the fringe of a cut', () => {
  it('knows the face beyond each side', () => {
    const neighbours = makeNeighbours(faces, Int32Array.from([0, 1, 2, 3]), VERTICES);
    expect([...neighbours.subarray(0, 6)]).toEqual([-1, 3, 1, 0, -1, -1]); // the strip's own borders have none
  });

  it('is nowhere on a whole sheet, whose borders are no rims', () => {
    const { fringe } = strip();
    fringe.rebuild();
    expect(fringe.rimVertexCount).toBe(0);
    expect(fringe.shape().index.length).toBe(0);
  });

  it('hangs off both lips of a gap, out of the sheet', () => {
    const { fringe, hidden, burn } = strip();
    hidden.fill(1, 2, 6); // the two squares in the middle
    burn.set([255, 0, 0, 51], 4 * 2);
    fringe.rebuild();
    const { records, index } = fringe.shape();
    expect(fringe.rimVertexCount).toBe(4); // two on each lip
    expect(index.length).toBe(2 * 6);
    for (let i = 0; i < records.length / FRINGE_FLOATS; i += 2) {
      const [root, tip] = [record(records, i), record(records, i + 1)];
      const left = Math.abs(root[0] - SIDE_M) < SINGLE;
      expect(Math.abs(root[0] - (left ? SIDE_M : 3 * SIDE_M))).toBeLessThan(SINGLE);
      expect((tip[0] - root[0]) * (left ? 1 : -1)).toBeGreaterThan(0);
      expect(Math.hypot(tip[0] - root[0], tip[1] - root[1])).toBeLessThan(1.5 * SIDE_M);
      expect([root[13], tip[13]]).toEqual([0, 1]);
      expect([...tip.subarray(3, 9)]).toEqual([...root.subarray(3, 9)]); // fibres run straight out
    }
    const exposed = Array.from({ length: 4 }, (_, i) => record(records, 2 * i)[9]);
    expect(exposed.filter((exposure) => exposure === 1)).toHaveLength(1);
    const scalars = Array.from({ length: 8 }, (_, i) => record(records, i)[12]); // of roots and tips
    expect(scalars.filter((scalar) => Math.abs(scalar - 0.2) < SINGLE)).toHaveLength(2);
  });

  it('goes when what was hidden comes back', () => {
    const { fringe, hidden } = strip();
    hidden.fill(1, 2, 6);
    fringe.rebuild();
    hidden.fill(0);
    fringe.rebuild();
    expect(fringe.rimVertexCount).toBe(0);
  });
});

describe('the edge of a sheet', () => {
  /** How many sides of faces it goes along. */
  const sides = (edge: Edge): number => edge.shape().index.length / 6;

  it('goes once round a whole sheet, as deep as the sheet is thick', () => {
    const { edge } = strip();
    edge.rebuild();
    expect(edge.vertexCount).toBe(VERTICES);
    expect(sides(edge)).toBe(2 * SQUARES + 2);
    const { records } = edge.shape();
    for (let i = 0; i < records.length / FRINGE_FLOATS; i += 2) {
      const [top, under] = [record(records, i), record(records, i + 1)];
      expect(top[2] - under[2]).toBeCloseTo(THICK_M, 7);
      expect([...under.subarray(0, 2)]).toEqual([...top.subarray(0, 2)]);
      expect([top[13], under[13]]).toEqual([0, 1]);
    }
  });

  it('goes along both lips of a gap, and not along what is gone', () => {
    const { edge, hidden } = strip();
    hidden.fill(1, 2, 6); // the two squares in the middle
    edge.rebuild();
    expect(edge.vertexCount).toBe(8);
    expect(sides(edge)).toBe(2 * 4); // round each of the two squares that are left
    hidden.fill(1);
    edge.rebuild();
    expect(edge.vertexCount).toBe(0);
  });

  it('goes down whichever side the mesh calls its front', () => {
    const { edge, normal } = strip();
    for (let v = 0; v < VERTICES; v++) normal[3 * v + 2] = -1;
    edge.rebuild();
    const { records } = edge.shape();
    expect(record(records, 1)[2]).toBeCloseTo(-THICK_M, 7);
  });
});
