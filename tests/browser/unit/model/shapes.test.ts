// SPDX-License-Identifier: GPL-3.0-or-later
import { fibreFrame, materialCoordinates } from '../../../../clients/web/src/model/fibres';
import { acrossGap } from '../../../../clients/web/src/model/gap';
import { pick } from '../../../../clients/web/src/model/pick';
import { samplesCsv } from '../../../../clients/web/src/model/samples';
import { hasHeat, hasJaws, toolParts } from '../../../../clients/web/src/model/tool_parts';
import { TOOL_SHAPES, type LayerDescription } from '../../../../clients/web/src/wire/messages.gen';

const EXACT = 1e-9; // tolerance, m: rounding of sums of a few doubles

describe('tool parts', () => {
  it.each(TOOL_SHAPES)('%s: hot parts end at the tip, a cold shaft leads up', (shape) => {
    const parts = toolParts({ name: 'it', shape, hot_radius_m: 0.002, tip_length_m: 0.01 });
    expect(parts.some((part) => part.hot)).toBe(hasHeat(shape));
    expect(parts.some((part) => part.jaw !== undefined)).toBe(hasJaws(shape));
    const shaft = parts.at(-1)!;
    expect(shaft.hot).toBe(false);
    expect(shaft.solid === 'capsule' && shaft.to[2]).toBeGreaterThan(0.1);
  });

  it('has the core’s hook: foot about the axis, heel of a quarter, neck to the shaft', () => {
    const [foot, heel, neck, shaft] = toolParts({ name: 'hook', shape: 'hook', hot_radius_m: 0.001, tip_length_m: 0.008, shaft_radius_m: 0.002 });
    expect(foot).toMatchObject({ from: [-0.002, 0, 0], to: [0.004, 0, 0], radius: 0.001 });
    expect(heel).toMatchObject({ center: [-0.002, 0, 0.002], bend: 0.002 });
    expect(neck).toMatchObject({ from: [-0.004, 0, 0.004], radius: 0.001 });
    // the shaft's surface begins one shaft radius below the neck's end
    if (neck.solid !== 'capsule' || shaft.solid !== 'capsule') throw new Error('not capsules');
    expect(Math.abs(shaft.from[2] - neck.to[2])).toBeLessThan(EXACT);
  });
});

describe('picking', () => {
  const position = Float32Array.from([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, -1, 1, 0, -1, 0, 1, -1]);
  const near = Uint32Array.from([0, 1, 2]);
  const far = Uint32Array.from([3, 5, 4]);

  it('finds the nearest of several batches, from either side', () => {
    expect(pick([0.2, 0.2, 5], [0, 0, -1], position, [far, near])).toEqual({ distance: 5, batch: 1, vertex: 0 });
    expect(pick([0.2, 0.2, -5], [0, 0, 1], position, [far, near])).toMatchObject({ distance: 4, batch: 0 });
  });

  it('sees through what is hidden and misses what is beside', () => {
    expect(pick([0.2, 0.2, 5], [0, 0, -1], position, [far, null])).toMatchObject({ distance: 6, batch: 0 });
    expect(pick([0.9, 0.9, 5], [0, 0, -1], position, [far, near])).toBeNull();
    expect(pick([0.2, 0.2, 5], [0, 0, 1], position, [far, near])).toBeNull();
  });

  it('lets no ray through between triangles that share an edge', () => {
    const CELLS = 12;
    const STEP_M = 0.0017;
    const at = (i: number): number => (i - CELLS / 2) * STEP_M;
    const sheet: number[] = [];
    const index: number[] = [];
    for (let j = 0; j <= CELLS; j++) for (let i = 0; i <= CELLS; i++) sheet.push(at(i), at(j), 0.0003 * Math.sin(3 * i + 5 * j));
    for (let j = 0; j < CELLS; j++) {
      for (let i = 0; i < CELLS; i++) {
        const a = j * (CELLS + 1) + i;
        index.push(a, a + 1, a + CELLS + 2, a, a + CELLS + 2, a + CELLS + 1);
      }
    }
    const sheetAt = Float32Array.from(sheet);
    const eye: [number, number, number] = [0, -0.13, 0.17];
    let through = 0;
    for (let v = 0; v < sheetAt.length; v += 3) {
      if ([0, 1].some((axis) => Math.abs(sheetAt[v + axis]) > (CELLS / 2 - 0.5) * STEP_M)) continue; // leaves out the rim
      for (const share of [0, 0.25, 0.37, 0.5]) { // share of the edge to the next vertex on the right
        const to = eye.map((from, axis) => sheetAt[v + axis] + share * (sheetAt[v + 3 + axis] - sheetAt[v + axis]) - from);
        const length = Math.hypot(...to);
        if (!pick(eye, [to[0] / length, to[1] / length, to[2] / length], sheetAt, [Uint32Array.from(index)])) through++;
      }
    }
    expect(through).toBe(0);
  });
});

describe('gaps', () => {
  // A sheet in the plane z = 1 mm, tilted or not, with a slit of 8 mm cut out of its middle.
  const CELL_M = 0.002;
  const HALF = 15; // half width of the sheet, in cells
  const sheet = (slope: number): { position: Float32Array; normal: Float32Array; index: Uint32Array } => {
    const position: number[] = [];
    const normal: number[] = [];
    const index: number[] = [];
    const side = 2 * HALF + 1;
    for (let j = -HALF; j <= HALF; j++) {
      for (let i = -HALF; i <= HALF; i++) {
        position.push(CELL_M * i, CELL_M * j, 0.001 + slope * CELL_M * i);
        normal.push(slope / Math.hypot(slope, 1), 0, -1 / Math.hypot(slope, 1)); // the normals point down
        if (i === HALF || j === HALF || (Math.abs(j + 0.5) < 2 && Math.abs(i + 0.5) < 6)) continue;
        const a = (j + HALF) * side + i + HALF;
        index.push(a, a + 1, a + side + 1, a, a + side + 1, a + side);
      }
    }
    return { position: Float32Array.from(position), normal: Float32Array.from(normal), index: Uint32Array.from(index) };
  };
  const down = [0, 0, -1] as const;

  it.each([0, 0.3])('are bridged in the surface of the tissue around, slope %d', (slope) => {
    const { position, normal, index } = sheet(slope);
    for (const x of [-0.01, -0.004, 0, 0.006]) {
      for (const y of [-0.003, 0, 0.003]) {
        expect(pick([x, y, 0.1], down, position, [index])).toBeNull();
        const distance = acrossGap([x, y, 0.1], down, position, normal, [index]);
        expect(0.1 - (distance ?? NaN)).toBeCloseTo(0.001 + slope * x, 4);
      }
    }
  });

  it('do not go on where the picture is cut away, nor by what is cut away', () => {
    const { position, normal, index } = sheet(0);
    const across = (hidden: (x: number, y: number, z: number) => boolean): number | null =>
      acrossGap([0.001, 0, 0.1], down, position, normal, [index], hidden);
    expect(across((x) => x > 0.02)).toBeCloseTo(0.099, 4);
    // only the looked-at place is cut away, between the vertices
    expect(across((x, y) => Math.hypot(x - 0.001, y) < 0.001)).toBeNull();
    expect(across((x) => x > 0.0015)).toBeNull(); // the tissue that is left is on one side of the gap only
    expect(across((_x, _y, z) => z < 0.0005)).toBeCloseTo(0.099, 4);
  });

  it('are not what lies beside the tissue, nor behind the eye, nor hidden', () => {
    const { position, normal, index } = sheet(0);
    for (const beside of [0.0301, 0.032, 0.04, 0.2]) {
      for (const [x, y] of [[beside, 0], [-beside, 0.01], [0, beside], [beside, beside]]) {
        expect(acrossGap([x, y, 0.1], down, position, normal, [index])).toBeNull();
      }
    }
    expect(acrossGap([0, 0, -0.1], down, position, normal, [index])).toBeNull();
    expect(acrossGap([0, 0, 0.1], down, position, normal, [null])).toBeNull();
  });
});

describe('fibres', () => {
  const layers: LayerDescription[] = [{ name: 'sheet', kind: 'fascia', first_face: 0, face_count: 1, element_count: 1 }];
  const topology = { faces: Int32Array.from([0, 1, 2]), faceLayers: Int32Array.from([0]), rest: new Int32Array(9) };
  const rest = Float32Array.from([0, 0, 0, 0.1, 0, 0, 0, 0.1, 0]);

  it('makes three directions at right angles', () => {
    for (const fibre of [[1, 0, 0], [0, 0, 2], [1, 2, 3], [0, 0, 0]] as [number, number, number][]) {
      const [a, b, c] = fibreFrame(fibre);
      for (const [u, v] of [[a, b], [b, c], [a, c]]) expect(u[0] * v[0] + u[1] * v[1] + u[2] * v[2]).toBeCloseTo(0, 12);
      expect(Math.hypot(...a)).toBeCloseTo(1, 12);
    }
  });

  it('goes along the layer’s direction without texture', () => {
    const scene = { name: 's', layers: [{ kind: 'fascia' as const, name: 'sheet', fibre: [0, 1, 0] as [number, number, number] }] };
    const material = materialCoordinates({ ...topology, texture: null }, rest, layers, scene);
    expect(material[6]).toBeCloseTo(0.1, 7);
    expect(material[3]).toBeCloseTo(0, 7);
  });

  it('goes along the texture where there is one, in metres', () => {
    const texture = Float32Array.from([0, 0, 0, 2, -2, 0]); // turned by 90 degrees; 2 units are 0.1 m
    const material = materialCoordinates({ ...topology, texture }, rest, layers, { name: 's' });
    expect([...material.subarray(3, 5)].map((v) => Number(v.toFixed(6)))).toEqual([0, 0.1]);
    expect([...material.subarray(6, 8)].map((v) => Number(v.toFixed(6)))).toEqual([-0.1, 0]);
  });
});

describe('what people save and see', () => {
  it('writes samples as CSV, empty where statistics are missing', () => {
    const sample = { atS: 1.5, tick: 9, latencyMs: 2, bytes: 100, decodeMs: 0.1, statistics: null, forceN: 0.5, energyJ: 3, moment: { tick: 9, tools: new Map() } };
    const [head, row, end] = samplesCsv([sample]).split('\n');
    expect(head.split(',').slice(0, 4)).toEqual(['time_s', 'tick', 'latency_ms', 'frame_bytes']);
    expect(row.split(',').slice(0, 8)).toEqual(['1.5', '9', '2', '100', '0.1', '0.5', '3', '']);
    expect(row.split(',')).toHaveLength(head.split(',').length);
    expect(end).toBe('');
  });
});
