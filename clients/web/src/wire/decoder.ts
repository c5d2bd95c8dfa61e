// SPDX-License-Identifier: Apache-2.0
// Holds the state of a stream and applies frames to it, by the rules of "Streams" in protocol/README.md.
import { applyElements, type Runs } from './elements';
import { readHeader, readSections, WireError, type FrameHeader } from './header';
import { SCALARS, SECTION, type ScalarName } from './messages.gen';
import { readAsked, readForces, readJaws, readPower, readStatistics, readToolNames, readTools, type Statistics, type ToolName, type ToolState } from './records';
import { readContacts, type ContactState } from './contacts';
import { readVessels, type VesselState } from './vessels';

export interface StreamShape {
  session_number: number;
  profile: number;
  vertex_count: number;
  face_count: number;
}

/** One number for each vertex, in steps of SCALARS, by the name of the scalar. */
export type ScalarArrays = Record<ScalarName, Int32Array>;

export interface StreamState extends ScalarArrays {
  /** false: there is no state yet, or it is damaged; a key frame is needed */
  synced: boolean;
  epoch: bigint;
  sequence: number;
  tick: number;
  timeS: number;
  publishedUs: number;
  paused: boolean;
  faulted: boolean;
  /** steps from the origin (vertices x 3); like the scalars, valid for vertices that a drawn face uses */
  quantised: Int32Array;
  /** words of 32 faces; a set bit: the face is not drawn */
  mask: Int32Array;
  tools: ToolState[];
  /** in the order of the scene; empty if the stream does not have the channel */
  vessels: VesselState[];
  /** by tool; empty if the stream does not have the channel `tool_contact` */
  contacts: ContactState[];
  statistics: Statistics | null;
}

/** The changes by the last frame. `whole`: everything may have changed. */
export interface Changes {
  whole: boolean;
  moved: Runs;
  maskWords: Runs;
  scalars: boolean;
}

export type Outcome =
  | { kind: 'applied'; key: boolean; changes: Changes }
  | { kind: 'skipped'; reason: string; gap: boolean };

const SCALAR_NAMES = Object.keys(SCALARS) as ScalarName[];

export class FrameDecoder {
  readonly state: StreamState;
  private names: ToolName[] = [];

  constructor(private readonly shape: StreamShape) {
    const scalars = SCALAR_NAMES.map((name) => [name, new Int32Array(shape.vertex_count)] as const);
    this.state = {
      ...(Object.fromEntries(scalars) as ScalarArrays),
      synced: false,
      epoch: 0n,
      sequence: 0,
      tick: 0,
      timeS: 0,
      publishedUs: 0,
      paused: false,
      faulted: false,
      quantised: new Int32Array(3 * shape.vertex_count),
      mask: new Int32Array(Math.ceil(shape.face_count / 32)),
      tools: [],
      vessels: [],
      contacts: [],
      statistics: null,
    };
  }

  /** Takes a key or delta frame. Throws WireError on damage; the state then waits for a key frame. */
  decode(bytes: Uint8Array): Outcome {
    const header = readHeader(bytes);
    const refusal = this.refusal(header);
    if (refusal) return refusal;
    try {
      const changes = this.apply(header, readSections(bytes, header.sectionCount));
      return { kind: 'applied', key: header.kind === 'key', changes };
    } catch (error) {
      this.state.synced = false;
      throw error;
    }
  }

  private refusal(header: FrameHeader): Outcome | null {
    const { state, shape } = this;
    const skip = (reason: string, gap = false): Outcome => ({ kind: 'skipped', reason, gap });
    if (header.session !== shape.session_number || header.profile !== shape.profile)
      return skip('a frame of another stream');
    if (header.kind === 'topology') return skip('a topology frame');
    if (header.kind === 'key') {
      const older = state.synced && header.epoch === state.epoch && header.sequence <= state.sequence;
      return older ? skip('a key frame of what is held') : null;
    }
    if (!state.synced) return skip('a delta before a key frame', true);
    if (header.epoch !== state.epoch) return skip('a delta of another epoch', true);
    if (header.sequence <= state.sequence) return skip('a delta that is held already');
    if (header.baseSequence !== state.sequence) return skip('a delta on a state that is not held', true);
    return null;
  }

  private apply(header: FrameHeader, sections: Map<number, Uint8Array>): Changes {
    const { state } = this;
    const key = header.kind === 'key';
    if (key) this.clear();
    const changes: Changes = { whole: key, moved: [], maskWords: [], scalars: key };
    const positions = sections.get(SECTION.positions);
    if (positions) changes.moved = applyElements(positions, state.quantised, 3, !key);
    if (key) this.requireWhole(changes.moved, positions !== undefined);
    const mask = sections.get(SECTION.mask);
    if (mask) changes.maskWords = applyElements(mask, state.mask, 1, !key);
    for (const name of SCALAR_NAMES) {
      const payload = sections.get(SCALARS[name].section);
      if (!payload) continue;
      const runs = applyElements(payload, state[name], 1, !key);
      changes.scalars ||= runs.length > 0;
    }
    this.applyRecords(sections);
    state.epoch = header.epoch;
    state.sequence = header.sequence;
    state.tick = header.tick;
    state.timeS = header.timeS;
    state.publishedUs = header.publishedUs;
    state.paused = header.paused;
    state.faulted = header.faulted;
    state.synced = true;
    return changes;
  }

  /** Sets everything to zero, because a key frame leaves zeros out. */
  private clear(): void {
    const { state } = this;
    state.mask.fill(0);
    for (const name of SCALAR_NAMES) state[name].fill(0);
    state.tools = [];
    state.vessels = [];
    state.contacts = [];
    state.statistics = null;
    this.names = [];
  }

  private requireWhole(runs: Runs, present: boolean): void {
    const { vertex_count } = this.shape;
    const whole = runs.length === 2 && runs[0] === 0 && runs[1] === vertex_count;
    if (present && !whole && vertex_count > 0) throw new WireError('a key frame without all positions');
  }

  private applyRecords(sections: Map<number, Uint8Array>): void {
    const names = sections.get(SECTION.tool_names);
    if (names) this.names = readToolNames(names);
    const tools = sections.get(SECTION.tools);
    if (tools) this.state.tools = readTools(tools, this.names);
    const asked = sections.get(SECTION.tools_asked);
    if (asked) this.state.tools = readAsked(asked, this.state.tools);
    const jaws = sections.get(SECTION.tool_jaws);
    if (jaws) this.state.tools = readJaws(jaws, this.state.tools);
    const power = sections.get(SECTION.tool_power);
    if (power) this.state.tools = readPower(power, this.state.tools);
    const forces = sections.get(SECTION.tool_force);
    if (forces) this.state.tools = readForces(forces, this.state.tools);
    const vessels = sections.get(SECTION.vessels);
    if (vessels) this.state.vessels = readVessels(vessels);
    const contacts = sections.get(SECTION.tool_contact);
    if (contacts) this.state.contacts = readContacts(contacts);
    const statistics = sections.get(SECTION.statistics);
    if (statistics) this.state.statistics = readStatistics(statistics);
  }
}
