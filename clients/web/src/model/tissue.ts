// SPDX-License-Identifier: GPL-3.0-or-later
// The tissue for drawing: positions in metres, smooth normals, cut rims, and the indices of drawn faces in batches. It is
// updated from the state of a stream, and computes only what changed. It runs in the worker and does not use a renderer.
import { text } from '../text/text';
import type { Changes, StreamState } from '../wire/decoder';
import { SCALARS, type LayerDescription } from '../wire/messages.gen';
import type { Topology } from '../wire/topology';
import { CutSides, cornersOf } from './cut_sides';
import { Edge } from './edge';
import { Lips } from './lips';
import { makeNeighbours } from './surface';
import { makeVertexFaces, markInnerFaces, type VertexFaces } from './topology_tables';

export interface Batch {
  layer: string;
  kind: LayerDescription['kind'];
  /** whether this is the inside of fat, which only cuts expose */
  bared: boolean;
  faces: Int32Array;
}

/** Content of the fourth byte of `burn`: a scalar that is shown as colour, or the blood on the surface. */
export type ShownScalar = 'stress' | 'temperature' | 'blood';

export interface TissueSource {
  vertexCount: number;
  faceCount: number;
  originM: readonly [number, number, number];
  stepM: number;
  layers: readonly LayerDescription[];
  topology: Topology;
  /** scalar that is drawn besides exposure and charring */
  scalar: ShownScalar;
  /** thickness of sheets by layer, m */
  thicknessM: Readonly<Record<string, number>>;
  /** material coordinates, m (vertices x 3) */
  material: Float32Array;
}

/** Bytes of each vertex in `burn`: heat exposure, charring, cut rim, and the shown scalar: over its range, or blood in its steps. */
export const BURN_BYTES = 4;
const RIM = 2;
export const SCALAR = 3;
const USUAL_SHEET_M = 5e-4; // thickness of sheets without a known thickness
const BOILING_C = 100;

export class Tissue {
  readonly batches: Batch[];
  readonly position: Float32Array;
  readonly normal: Float32Array;
  readonly burn: Uint8Array;
  /** largest stress so far, in steps of the stream, which is 255 in burn */
  stressScale = 1;
  /** temperatures of 0 and 255 in burn, degC: least and largest temperature so far, including that of boiling water */
  readonly temperatureRangeC: [number, number] = [BOILING_C, BOILING_C];
  /** drawn faces of each batch; replaced when they change */
  readonly drawnIndex: Uint32Array[];
  /** number of drawn faces, the first ones, that are drawn unrefined; the others are drawn finer, as lips */
  readonly plainFaces: Int32Array;
  /** surfaces of each batch that a cut exposes; null if nothing is drawn finer */
  readonly lips: (Lips | null)[];
  /** walls of sheets at their borders */
  readonly edges: (Edge | null)[];
  /** for sheets, the face beyond each side of each face */
  private readonly neighbours: (Int32Array | null)[];
  private readonly vertexFaces: VertexFaces;
  private readonly batchOfFace: Int32Array;
  private readonly hidden: Uint8Array;
  private readonly faceNormal: Float32Array;
  private readonly vertexMark: Int32Array;
  private readonly faceMark: Int32Array;
  private mark = 0;

  constructor(private readonly source: TissueSource) {
    const { vertexCount, faceCount, topology } = source;
    this.position = new Float32Array(3 * vertexCount);
    this.normal = new Float32Array(3 * vertexCount);
    this.burn = new Uint8Array(BURN_BYTES * vertexCount);
    this.vertexFaces = makeVertexFaces(topology.faces, vertexCount);
    this.hidden = new Uint8Array(faceCount).fill(1);
    this.faceNormal = new Float32Array(3 * faceCount);
    this.vertexMark = new Int32Array(vertexCount);
    this.faceMark = new Int32Array(faceCount);
    this.batches = makeBatches(source);
    this.drawnIndex = this.batches.map(() => new Uint32Array(0));
    this.plainFaces = new Int32Array(this.batches.length);
    this.neighbours = this.batches.map(({ kind, faces }) => (isSheet(kind) ? makeNeighbours(topology.faces, faces, vertexCount) : null));
    const { material } = source;
    const surface = { faces: topology.faces, material, position: this.position, normal: this.normal, burn: this.burn, hidden: this.hidden };
    const thick = (batch: Batch): number => source.thicknessM[batch.layer] ?? USUAL_SHEET_M;
    this.lips = this.batches.map((batch) => (isSheet(batch.kind) ? new Lips(surface, thick(batch)) : batch.bared ? new Lips(surface, 0) : null));
    this.edges = this.batches.map((batch, b) => {
      const beyond = this.neighbours[b];
      return beyond && new Edge(surface, batch.faces, beyond, thick(batch));
    });
    this.batchOfFace = new Int32Array(faceCount);
    this.batches.forEach((batch, b) => {
      for (const face of batch.faces) this.batchOfFace[face] = b;
    });
  }

  /** Applies a state. Returns the batches whose drawn faces changed. */
  update(state: StreamState, changes: Changes): number[] {
    this.mark++;
    const touched: number[] = [];
    const changedBatches = this.updateMask(state.mask, changes, touched);
    this.updatePositions(state.quantised, changes, touched);
    this.updateNormals(touched);
    if (changes.scalars) this.updateBurn(state);
    for (const batch of changedBatches) {
      this.updateIndex(batch);
      this.edges[batch]?.rebuild();
    }
    return [...changedBatches];
  }

  /** Returns the number of drawn faces by layer, for users and tests. */
  drawnFaceCounts(): Record<string, number> {
    const counts: Record<string, number> = {};
    this.batches.forEach((batch, b) => {
      const name = batch.bared ? text.tissue.inside(batch.layer) : batch.layer;
      counts[name] = this.drawnIndex[b].length / 3;
    });
    return counts;
  }

  private touchFace(face: number, touched: number[]): void {
    if (this.faceMark[face] === this.mark) return;
    this.faceMark[face] = this.mark;
    this.computeFaceNormal(face);
    for (let c = 0; c < 3; c++) {
      const vertex = this.source.topology.faces[3 * face + c];
      if (this.vertexMark[vertex] === this.mark) continue;
      this.vertexMark[vertex] = this.mark;
      touched.push(vertex);
    }
  }

  private updateMask(mask: Int32Array, changes: Changes, touched: number[]): Set<number> {
    const changed = new Set<number>();
    const changedFaces: number[] = [];
    const words = changes.whole ? [0, mask.length] : changes.maskWords;
    for (let run = 0; run < words.length; run += 2) {
      const end = Math.min(32 * (words[run] + words[run + 1]), this.source.faceCount);
      for (let face = 32 * words[run]; face < end; face++) {
        const hidden = (mask[face >>> 5] >>> (face & 31)) & 1;
        if (hidden === this.hidden[face]) continue;
        this.hidden[face] = hidden;
        changed.add(this.batchOfFace[face]);
        changedFaces.push(face);
      }
    }
    // Only collects vertices here: normals of faces are computed from the positions that are applied below.
    for (const face of changedFaces) {
      for (let c = 0; c < 3; c++) {
        const vertex = this.source.topology.faces[3 * face + c];
        if (this.vertexMark[vertex] !== this.mark) {
          this.vertexMark[vertex] = this.mark;
          touched.push(vertex);
        }
      }
    }
    return changed;
  }

  private updatePositions(quantised: Int32Array, changes: Changes, touched: number[]): void {
    const { originM, stepM, vertexCount } = this.source;
    const runs = changes.whole ? [0, vertexCount] : changes.moved;
    for (let run = 0; run < runs.length; run += 2) {
      for (let v = runs[run]; v < runs[run] + runs[run + 1]; v++) {
        for (let c = 0; c < 3; c++) this.position[3 * v + c] = originM[c] + stepM * quantised[3 * v + c];
      }
    }
    const { start, items } = this.vertexFaces;
    for (let run = 0; run < runs.length; run += 2) {
      const end = runs[run] + runs[run + 1];
      for (let i = start[runs[run]]; i < start[end]; i++) if (!this.hidden[items[i]]) this.touchFace(items[i], touched);
    }
  }

  private computeFaceNormal(face: number): void {
    const { position: p, faceNormal: n } = this;
    const { faces } = this.source.topology;
    const a = 3 * faces[3 * face];
    const b = 3 * faces[3 * face + 1];
    const c = 3 * faces[3 * face + 2];
    const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
    const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
    n[3 * face] = uy * vz - uz * vy;
    n[3 * face + 1] = uz * vx - ux * vz;
    n[3 * face + 2] = ux * vy - uy * vx;
  }

  /** Area-weighted sums over drawn faces; the inside of fat has its own flat shading. */
  private updateNormals(touched: readonly number[]): void {
    const { start, items } = this.vertexFaces;
    for (const vertex of touched) {
      let x = 0, y = 0, z = 0;
      let rim = 0;
      for (let i = start[vertex]; i < start[vertex + 1]; i++) {
        const face = items[i];
        const batch = this.batches[this.batchOfFace[face]];
        if (batch.bared) continue;
        if (this.hidden[face]) {
          if (batch.kind !== 'fat') rim = 255;
          continue;
        }
        if (this.faceMark[face] !== this.mark) this.computeFaceNormal(face);
        x += this.faceNormal[3 * face];
        y += this.faceNormal[3 * face + 1];
        z += this.faceNormal[3 * face + 2];
      }
      const length = Math.hypot(x, y, z) || 1;
      this.normal[3 * vertex] = x / length;
      this.normal[3 * vertex + 1] = y / length;
      this.normal[3 * vertex + 2] = z / length;
      this.burn[BURN_BYTES * vertex + RIM] = rim;
    }
  }

  private updateBurn(state: StreamState): void {
    const { burn } = this;
    const { exposure, charring } = state;
    for (let v = 0; v < exposure.length; v++) {
      burn[BURN_BYTES * v] = Math.min(exposure[v], 255);
      burn[BURN_BYTES * v + 1] = Math.min(charring[v], 255);
    }
    if (this.source.scalar === 'temperature') this.updateTemperature(state.temperature);
    else if (this.source.scalar === 'stress') this.updateStress(state.stress);
    else state.blood.forEach((depth, v) => (burn[BURN_BYTES * v + SCALAR] = Math.min(depth, SCALARS.blood.most)));
  }

  private updateStress(stress: Int32Array): void {
    for (const value of stress) if (value > this.stressScale) this.stressScale = value;
    const perStep = 255 / this.stressScale;
    for (let v = 0; v < stress.length; v++) this.burn[BURN_BYTES * v + SCALAR] = stress[v] * perStep;
  }

  private updateTemperature(temperature: Int32Array): void {
    const { least: leastC, step: stepC } = SCALARS.temperature;
    const range = this.temperatureRangeC;
    for (const value of temperature) {
      const celsius = leastC + stepC * value;
      if (celsius < range[0]) range[0] = celsius;
      if (celsius > range[1]) range[1] = celsius;
    }
    const perDegree = 255 / Math.max(range[1] - range[0], stepC);
    for (let v = 0; v < temperature.length; v++) {
      const above = leastC + stepC * temperature[v] - range[0];
      this.burn[BURN_BYTES * v + SCALAR] = Math.round(above * perDegree);
    }
  }

  private updateIndex(b: number): void {
    const { faces } = this.source.topology;
    const { faces: own, bared } = this.batches[b];
    const drawn = own.filter((face) => !this.hidden[face]);
    const beyond = this.neighbours[b];
    const cuts = new CutSides(faces, beyond ? own : new Int32Array(0), beyond ?? new Int32Array(0), this.hidden);
    const finer = bared ? drawn : drawn.filter((face) => cuts.touches(face));
    const plain = bared ? new Int32Array(0) : drawn.filter((face) => !cuts.touches(face));
    this.plainFaces[b] = plain.length;
    const corners = cornersOf(faces, finer);
    this.drawnIndex[b] = new Uint32Array(3 * drawn.length);
    this.drawnIndex[b].set(cornersOf(faces, plain));
    this.drawnIndex[b].set(corners, 3 * plain.length);
    this.lips[b]?.rebuild(corners, (u, v) => !bared && !cuts.has(u, v));
  }
}

function isSheet(kind: Batch['kind']): boolean {
  return kind === 'fascia' || kind === 'membrane';
}

function range(first: number, count: number): Int32Array {
  return Int32Array.from({ length: count }, (_, i) => first + i);
}

function makeBatches(source: TissueSource): Batch[] {
  const { layers, topology, vertexCount, faceCount } = source;
  const inner = new Uint8Array(faceCount);
  const membranes = layers.filter((layer) => layer.kind === 'membrane');
  const covers = Int32Array.from(membranes.flatMap((layer) => [...range(layer.first_face, layer.face_count)]));
  const batches: Batch[] = [];
  for (const layer of layers) {
    if (layer.face_count === 0) continue;
    const faces = range(layer.first_face, layer.face_count);
    const { name, kind } = layer;
    if (kind !== 'fat') {
      batches.push({ layer: name, kind, bared: false, faces });
      continue;
    }
    markInnerFaces(topology.faces, faces, covers, vertexCount, inner);
    batches.push({ layer: name, kind, bared: false, faces: faces.filter((face) => !inner[face]) });
    batches.push({ layer: name, kind, bared: true, faces: faces.filter((face) => inner[face]) });
  }
  return batches;
}
