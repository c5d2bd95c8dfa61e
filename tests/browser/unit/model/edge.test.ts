// SPDX-License-Identifier: GPL-3.0-or-later
import { Edge } from '../../../../clients/web/src/model/edge';
import { makeNeighbours, SURFACE_FLOATS } from '../../../../clients/web/src/model/surface';

/** Number of squares of a strip along x. Each square has two triangles; the strip's width is along y. */
const SQUARES = 4;
const VERTICES = 2 * (SQUARES + 1);
const SIDE_M = 0.002;
const faces = Int32Array.from(Array.from({ length: SQUARES }, (_, i) => [2 * i, 2 * i + 2, 2 * i + 3, 2 * i, 2 * i + 3, 2 * i + 1]).flat());

const THICK_M = 0.0004;

function strip(): { edge: Edge; hidden: Uint8Array; normal: Float32Array } {
  const position = new Float32Array(3 * VERTICES);
  const normal = new Float32Array(3 * VERTICES);
  for (let v = 0; v < VERTICES; v++) {
    position.set([SIDE_M * (v >> 1), SIDE_M * (v & 1), 0], 3 * v);
    normal[3 * v + 2] = 1;
  }
  const hidden = new Uint8Array(2 * SQUARES);
  const source = { faces, material: position.slice(), position, normal, burn: new Uint8Array(4 * VERTICES), hidden };
  const all = Int32Array.from({ length: 2 * SQUARES }, (_, i) => i);
  return { edge: new Edge(source, all, makeNeighbours(faces, all, VERTICES), THICK_M), hidden, normal };
}

const record = (records: Float32Array, i: number): Float32Array => records.subarray(SURFACE_FLOATS * i, SURFACE_FLOATS * (i + 1));

describe('neighbours', () => {
  it('are the faces beyond each side', () => {
    const neighbours = makeNeighbours(faces, Int32Array.from([0, 1, 2, 3]), VERTICES);
    expect([...neighbours.subarray(0, 6)]).toEqual([-1, 3, 1, 0, -1, -1]); // the strip's own borders have no neighbours
  });
});

describe('the edge of a sheet', () => {
  /** Returns the number of sides of faces along which the edge goes. */
  const sides = (edge: Edge): number => (edge.shape().index?.length ?? 0) / 6;

  it('goes once round a whole sheet, as deep as the sheet is thick', () => {
    const { edge } = strip();
    edge.rebuild();
    expect(edge.vertexCount).toBe(VERTICES);
    expect(sides(edge)).toBe(2 * SQUARES + 2);
    const { records } = edge.shape();
    for (let i = 0; i < records.length / SURFACE_FLOATS; i += 2) {
      const [top, under] = [record(records, i), record(records, i + 1)];
      expect(top[2] - under[2]).toBeCloseTo(THICK_M, 7);
      expect([...under.subarray(0, 2)]).toEqual([...top.subarray(0, 2)]);
      expect([top[13], under[13]]).toEqual([0, 1]);
    }
  });

  it('goes along what is left of the border, and leaves a gap to its lips', () => {
    const { edge, hidden } = strip();
    hidden.fill(1, 2, 6); // hides the two squares in the middle
    edge.rebuild();
    expect(edge.vertexCount).toBe(8);
    expect(sides(edge)).toBe(2 * 3); // for each of the two squares that are left, the three sides of the uncut border
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
