// SPDX-License-Identifier: GPL-3.0-or-later
// Prepares decoded frames for drawing. Every frame updates the tissue. The newest state is handed over as soon as the page
// has returned the buffers of the last one, so the page can never fall behind.
import { materialCoordinates } from '../model/fibres';
import { surroundingsOf } from '../model/field_shape';
import { BURN_BYTES, Tissue, type ShownScalar } from '../model/tissue';
import type { Changes, StreamState } from './decoder';
import { SCALARS, type SessionDescription, type StreamDescription } from './messages.gen';
import type { Topology } from './topology';
import type { Frame, FrameBuffers, Joined, Sample, VertexState } from './worker_messages';

const SAMPLES_MAX = 600;
const WHOLE: Changes = { whole: true, moved: [], maskWords: [], scalars: true };
/** After the lips of cuts were computed, the next frame waits this many times as long, because decoding has priority. On a
 * fast machine this is less than the time of a frame. */
const REST = 4;
const BYTE = 255; // byte of the value 1 in exposure and charring

export class Feed {
  readonly joined: Joined;
  private readonly tissue: Tissue;
  private readonly stale = new Set<number>();
  /** batches whose lips were shown when they were last handed over */
  private readonly lipped = new Set<number>();
  private restUntilMs = 0;
  private spare: FrameBuffers | null;
  private newest: StreamState | null = null;
  private last: StreamState | null = null;
  /** past state that is shown instead of the newest */
  private past: StreamState | null = null;
  private changed = true;
  private samples: Sample[] = [];

  constructor(
    description: SessionDescription,
    private readonly stream: StreamDescription,
    topology: Topology,
    /** scalar that is drawn as colour */
    private readonly scalar: ShownScalar,
  ) {
    const { vertex_count: vertexCount, face_count: faceCount, origin_m: originM, step_m: stepM } = stream;
    const { layers } = description;
    const rest = Float32Array.from(topology.rest, (value, i) => originM[i % 3] + stepM * value);
    const material = materialCoordinates(topology, rest, layers, description.definition);
    const sheets = (description.definition.layers ?? []).map((layer) => [layer.name, 'thickness_m' in layer ? layer.thickness_m : undefined] as const);
    const thicknessM = Object.fromEntries(sheets.filter((sheet): sheet is [string, number] => sheet[1] !== undefined));
    this.tissue = new Tissue({ vertexCount, faceCount, originM, stepM, layers, topology, scalar, material, thicknessM });
    const batches = this.tissue.batches.map(({ faces, ...batch }) => ({ ...batch, faceCount: faces.length }));
    const surroundings = surroundingsOf(rest, material, topology.faces, layers, description.definition);
    const blood = scalar === 'blood' && stream.channels.includes('blood');
    this.joined = { description, stream, batches, rest, material, surroundings, blood };
    this.spare = {
      position: new Float32Array(3 * vertexCount),
      normal: new Float32Array(3 * vertexCount),
      burn: new Uint8Array(BURN_BYTES * vertexCount),
    };
  }

  take(state: StreamState, changes: Changes, sample: Sample): void {
    if (!this.past) this.draw(state, changes);
    this.newest = this.last = state;
    this.samples.push(sample);
    if (this.samples.length > SAMPLES_MAX) this.samples.shift();
  }

  /** Shows a past state, or with null the newest again, from the next frame that is handed over on. */
  look(past: StreamState | null): void {
    const state = past ?? this.last;
    if (past === this.past || !state) return;
    this.past = past;
    this.draw(state, WHOLE);
    this.newest = this.last;
  }

  private draw(state: StreamState, changes: Changes): void {
    for (const batch of this.tissue.update(state, changes)) this.stale.add(batch);
    this.changed ||= changes.whole || changes.scalars || changes.moved.length > 0 || changes.maskWords.length > 0;
  }

  /** Returns the values of a vertex in the shown frame. */
  vertex(vertex: number): VertexState | null {
    const { stream } = this;
    const last = this.past ?? this.last;
    if (!last || vertex < 0 || vertex >= stream.vertex_count) return null;
    const has = (channel: 'stress' | 'temperature'): boolean => stream.channels.includes(channel);
    return {
      vertex,
      exposure: last.exposure[vertex] / BYTE,
      charring: last.charring[vertex] / BYTE,
      stressPa: has('stress') ? last.stress[vertex] * stream.stress_step_pa : null,
      temperatureC: has('temperature') ? SCALARS.temperature.least + SCALARS.temperature.step * last.temperature[vertex] : null,
    };
  }

  giveBack(buffers: FrameBuffers): void {
    if (buffers.position.length === this.tissue.position.length) this.spare = buffers;
  }

  /** Time that the next frame should wait, ms. */
  get restMs(): number {
    return this.restUntilMs - performance.now();
  }

  /** Returns the newest state, if it was not handed over yet and the buffers are here. The caller transfers them. */
  handOver(framesDecoded: number, framesSkipped: number): Frame | null {
    const { newest: state, spare: buffers, tissue, past } = this;
    if (!state || !buffers) return null;
    this.newest = null;
    this.spare = null;
    buffers.position.set(tissue.position);
    buffers.normal.set(tissue.normal);
    buffers.burn.set(tissue.burn);
    const drawn = [...this.stale].map((batch) => ({ batch, index: tissue.drawnIndex[batch], plain: tissue.plainFaces[batch] }));
    this.stale.clear();
    const { samples, changed } = this;
    const lips = changed ? this.lips() : [];
    const edges = changed ? this.edges() : [];
    this.samples = [];
    this.changed = false;
    return {
      session: this.stream.session,
      epoch: state.epoch.toString(16).padStart(16, '0'),
      sequence: state.sequence,
      tick: state.tick,
      timeS: state.timeS,
      paused: state.paused,
      faulted: state.faulted,
      changed,
      buffers,
      drawn,
      lips,
      edges,
      drawnFaces: tissue.drawnFaceCounts(),
      stressScalePa: tissue.stressScale * this.stream.stress_step_pa,
      temperatureRangeC: this.scalar === 'temperature' && this.stream.channels.includes('temperature') ? [...tissue.temperatureRangeC] : null,
      tools: state.tools,
      vessels: state.vessels,
      past: past && { tick: past.tick, timeS: past.timeS, tools: past.tools, vessels: past.vessels },
      samples,
      framesDecoded,
      framesSkipped,
    };
  }

  private edges(): Frame['edges'] {
    return this.tissue.edges.flatMap((edge, batch) => (edge ? [{ batch, ...edge.shape() }] : []));
  }

  /** Returns the lips of all batches that have lips now, or had lips at the last handing over. */
  private lips(): Frame['lips'] {
    const beganMs = performance.now();
    const shapes = this.lipShapes();
    const nowMs = performance.now();
    this.restUntilMs = nowMs + REST * (nowMs - beganMs);
    return shapes;
  }

  private lipShapes(): Frame['lips'] {
    return this.tissue.lips.flatMap((lips, batch) => {
      if (!lips || (lips.empty && !this.lipped.has(batch))) return [];
      if (lips.empty) this.lipped.delete(batch);
      else this.lipped.add(batch);
      return [{ batch, ...lips.shape() }];
    });
  }
}
