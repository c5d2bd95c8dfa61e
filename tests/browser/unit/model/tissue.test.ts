// SPDX-License-Identifier: GPL-3.0-or-later
import { Tissue, type TissueSource } from '../../../../clients/web/src/model/tissue';
import type { Changes, StreamState } from '../../../../clients/web/src/wire/decoder';
import type { LayerDescription } from '../../../../clients/web/src/wire/messages.gen';

const STEP_M = 5e-5;
const SINGLE = 1e-6; // tolerance: single precision of unit vectors
const WHOLE: Changes = { whole: true, moved: [], maskWords: [], scalars: true };

/** Two tetrahedra with the common triangle 0 1 2 and the apices 3 below and 4 above. A membrane covers them. */
const TETRAHEDRA = [[1, 0, 2, 3], [0, 1, 2, 4]];
const FAT = [
  [0, 1, 2],
  ...TETRAHEDRA.flatMap(([a, b, c, d]) => [[a, b, d], [b, c, d], [c, a, d]]),
];
const MEMBRANE = FAT.slice(1);
const POINTS = [[0, 0, 0], [400, 0, 0], [0, 400, 0], [100, 100, -300], [100, 100, 300]];

function layer(name: string, kind: LayerDescription['kind'], first: number, count: number): LayerDescription {
  return { name, kind, first_face: first, face_count: count, element_count: count };
}

function makeTissue(faces: number[][], layers: LayerDescription[], shown: TissueSource['scalar'] = 'stress'): { tissue: Tissue; state: StreamState } {
  const topology = { faces: Int32Array.from(faces.flat()), faceLayers: new Int32Array(faces.length), texture: null, rest: new Int32Array(15) };
  const tissue = new Tissue({
    vertexCount: POINTS.length, faceCount: faces.length, originM: [1, 0, 0], stepM: STEP_M, layers, topology, scalar: shown,
    material: Float32Array.from(POINTS.flat(), (value) => STEP_M * value), thicknessM: {},
  });
  const scalar = (): Int32Array => new Int32Array(POINTS.length);
  const state = {
    quantised: Int32Array.from(POINTS.flat()), mask: new Int32Array(1), exposure: scalar(), charring: scalar(), stress: scalar(), temperature: scalar(), blood: scalar(),
  } as unknown as StreamState;
  return { tissue, state };
}

/** Makes the tissue. Faces 0 to 5 are the membrane's, faces 6 to 12 the fat's; face 6 lies between the tetrahedra. */
function twoTetrahedra(): ReturnType<typeof makeTissue> {
  const made = makeTissue([...MEMBRANE, ...FAT], [layer('skin', 'membrane', 0, 6), layer('fat', 'fat', 6, 7)]);
  made.state.mask[0] = 0b1111111 << 6;
  return made;
}

describe('tissue', () => {
  it('takes positions over in metres', () => {
    const { tissue, state } = twoTetrahedra();
    tissue.update(state, WHOLE);
    expect(tissue.position[3]).toBeCloseTo(1 + 400 * STEP_M, 6);
    expect(tissue.position[14]).toBeCloseTo(300 * STEP_M, 6);
  });

  it('knows the inside of fat: between tetrahedra, and under a membrane', () => {
    const { tissue } = twoTetrahedra();
    const fat = tissue.batches.filter((batch) => batch.layer === 'fat');
    expect(fat.map(({ bared, faces }) => [bared, faces.length])).toEqual([[false, 0], [true, 7]]);
    const bare = makeTissue(FAT, [layer('fat', 'fat', 0, 7)]).tissue;
    expect(bare.batches.map(({ bared, faces }) => [bared, faces.length])).toEqual([[false, 6], [true, 1]]);
  });

  it('draws what the mask leaves, and tells which batches changed', () => {
    const { tissue, state } = twoTetrahedra();
    expect(tissue.update(state, WHOLE)).toEqual([0]);
    expect(tissue.drawnFaceCounts()).toEqual({ 'skin': 6, 'fat': 0, 'fat (inside)': 0 });
    state.mask[0] = (1 << 0) | (0b1111111 << 6) ^ (1 << 7); // one membrane face goes, so the fat under it becomes visible
    const changed = tissue.update(state, { whole: false, moved: [], maskWords: [0, 1], scalars: false });
    expect(changed.sort()).toEqual([0, 2]);
    expect(tissue.drawnFaceCounts()).toEqual({ 'skin': 5, 'fat': 0, 'fat (inside)': 1 });
    expect([...tissue.drawnIndex[2]]).toEqual(FAT[1]);
  });

  it('marks the rims of cut sheets', () => {
    const { tissue, state } = twoTetrahedra();
    tissue.update(state, WHOLE);
    const rims = (): number[] => POINTS.map((_, v) => tissue.burn[4 * v + 2]);
    expect(rims()).toEqual([0, 0, 0, 0, 0]);
    state.mask[0] |= 1;
    tissue.update(state, { whole: false, moved: [], maskWords: [0, 1], scalars: false });
    expect(rims()).toEqual([255, 255, 0, 255, 0]);
  });

  it('has the same normals after a part moved as if all were computed anew', () => {
    const { tissue, state } = twoTetrahedra();
    tissue.update(state, WHOLE);
    state.quantised.set([90, 120, 450], 12);
    tissue.update(state, { whole: false, moved: [4, 1], maskWords: [], scalars: false });
    const anew = twoTetrahedra();
    anew.state.quantised.set(state.quantised);
    anew.tissue.update(anew.state, WHOLE);
    tissue.normal.forEach((value, i) => expect(Math.abs(value - anew.tissue.normal[i])).toBeLessThan(SINGLE));
    expect(Math.hypot(...tissue.normal.subarray(12, 15))).toBeCloseTo(1, 6);
    expect(tissue.normal[14]).toBeGreaterThan(0.5);
  });

  it('does not touch the normals of what neither moved nor met what moved', () => {
    const { tissue, state } = twoTetrahedra();
    tissue.update(state, WHOLE);
    tissue.normal.fill(7);
    tissue.update(state, { whole: false, moved: [4, 1], maskWords: [], scalars: false });
    expect([...tissue.normal.subarray(9, 12)]).toEqual([7, 7, 7]);
    expect(tissue.normal[12]).not.toBe(7);
  });

  it('scales stress to the largest seen', () => {
    const { tissue, state } = twoTetrahedra();
    state.stress.set([0, 500, 1000, 0, 0]);
    state.exposure.set([255, 0, 0, 0, 12]);
    tissue.update(state, WHOLE);
    expect(tissue.stressScale).toBe(1000);
    expect([...tissue.burn.subarray(0, 2)]).toEqual([255, 0]);
    expect([tissue.burn[7], tissue.burn[11]]).toEqual([127, 255]);
  });

  it('has blood in its steps, and not the stress that nothing shows', () => {
    const { tissue, state } = makeTissue(FAT, [layer('fat', 'fat', 0, 7)], 'blood');
    state.stress.fill(1000);
    state.blood.set([0, 1, 25, 255, 3]);
    tissue.update(state, WHOLE);
    expect(POINTS.map((_, v) => tissue.burn[4 * v + 3])).toEqual([0, 1, 25, 255, 3]);
  });

  it('scales temperature from the least seen to the largest, or to boiling water', () => {
    const { tissue, state } = makeTissue(FAT, [layer('fat', 'fat', 0, 7)], 'temperature');
    const steps = (celsius: number): number => (celsius + 20) / 0.25; // the encoding of protocol/README.md
    const scalars = (): number[] => POINTS.map((_, v) => tissue.burn[4 * v + 3]);
    state.stress.fill(1000); // stress, which is not shown
    state.temperature.fill(steps(37));
    tissue.update(state, WHOLE);
    expect(tissue.temperatureRangeC).toEqual([37, 100]);
    expect(scalars()).toEqual([0, 0, 0, 0, 0]);
    state.temperature.set([steps(100), steps(68.5)], 1);
    tissue.update(state, WHOLE);
    expect(scalars()).toEqual([0, 255, 128, 0, 0]);
    state.temperature.set([steps(170), steps(12)], 3);
    tissue.update(state, WHOLE);
    expect(tissue.temperatureRangeC).toEqual([12, 170]);
    expect(scalars()).toEqual([37, 100, 68.5, 170, 12].map((celsius) => Math.round((255 * (celsius - 12)) / 158)));
    state.temperature.fill(steps(37)); // the tissue has cooled: the colours must keep their meaning
    tissue.update(state, WHOLE);
    expect(tissue.temperatureRangeC).toEqual([12, 170]);
  });
});
