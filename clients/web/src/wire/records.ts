// SPDX-License-Identifier: Apache-2.0
// Tool names, tool records and the statistics record of a frame.
import { viewOf, WireError } from './header';
import { ENERGY_OFF_REASONS, TOOL_SHAPES } from './messages.gen';

export type ToolShape = (typeof TOOL_SHAPES)[number];
export type EnergyOff = (typeof ENERGY_OFF_REASONS)[number];
export type Vector = [number, number, number];
export type Quaternion = [number, number, number, number];

export interface ToolName {
  name: string;
  shape: ToolShape;
}

/** Force and torque in the tick of the frame, without filter and limit; time constant of the filter, 0: no filter. */
export interface RawForce {
  forceN: Vector;
  torqueNm: Vector;
  filterS: number;
}

export interface ToolState extends ToolName {
  sequence: number;
  positionM: Vector;
  rotation: Quaternion;
  asked: { positionM: Vector; rotation: Quaternion }; // commanded pose; tissue can hold the tool back
  jaw: number; // actual opening; held tissue can stop the jaws
  askedJaw: number; // commanded opening
  jawForceN: number; // force of the jaws on what they hold; 0 from servers that do not send it
  forceN: Vector; // of the tissue on the tool, filtered, at most force_max_n
  torqueNm: Vector; // about the tip, filtered as forceN
  raw: RawForce | null; // null from servers that do not send it
  tipTemperatureC: number;
  energyJ: number;
  deliveredW: number; // power given to tissue in the last step; 0 from servers that do not send it
  loadOhm: number; // load of the generator; 0: no current flows
  driver: number;
  energized: boolean;
  grasping: boolean;
  frozen: boolean;
  energyOff: EnergyOff;
  slipping: boolean; // whether grasped points slid in the last step; false from servers that do not send it
  graspedVertices: number;
  contactVertices: number;
  touchedLayers: number;
}

export const STAGES = ['commands', 'predict', 'local', 'global', 'contact', 'heat', 'dissect', 'frame'] as const;

export interface Statistics {
  realtimeFactor: number;
  stepCostS: number;
  stageS: number[];
  residual: number;
  deferredMaxS: number;
  iterations: number;
  backtracks: number;
  inverted: number;
  edgesParted: number;
  elementsRemoved: number;
  pendingDowndates: number;
  refactorisations: number;
  contacts: number;
  frozenVertices: number;
  refusedCommands: number;
  energyGainJ: number; // energy that the last step gained without a source; 0 from servers that do not send it
  resting: boolean; // whether steps are skipped because the tissue is at rest; false from servers that do not send it
  error: number; // estimated error of the last step, relative to its motion; 0 from servers that do not send it
  contactsLeftOut: number; // vertices beyond the contact capacity of the last step; 0 from servers that do not send it
  elementsTorn: number; // removed elements that tore; 0 from servers that do not send it
  touchingCutShort: number; // times in the last step that tissue contact exceeded its capacity; 0 from servers that do not send it
}

const TOOL_BYTES = 84;
const ASKED_BYTES = 28;
const JAW_BYTES = 8;
const POWER_BYTES = 8;
const FORCE_BYTES = 28;
const STATISTICS_BYTES = 88; // without the members that later servers added: energyGainJ, resting, error, contactsLeftOut, elementsTorn, touchingCutShort
const TOOLS_MAX = 8;

export function readToolNames(payload: Uint8Array): ToolName[] {
  if (payload.byteLength < 4) throw new WireError('tool names are cut off');
  const count = viewOf(payload).getUint32(0, true);
  if (count > TOOLS_MAX) throw new WireError(`${count} tools`);
  const names: ToolName[] = [];
  let offset = 4;
  for (let i = 0; i < count; i++) {
    const shape = TOOL_SHAPES[payload[offset] ?? -1];
    const length = payload[offset + 1] ?? 0;
    offset += 2;
    if (shape === undefined || length === 0 || offset + length > payload.byteLength)
      throw new WireError('tool names are damaged');
    names.push({ shape, name: String.fromCharCode(...payload.subarray(offset, offset + length)) });
    offset += length;
  }
  return names;
}

function readVector(view: DataView, offset: number): Vector {
  return [view.getFloat32(offset, true), view.getFloat32(offset + 4, true), view.getFloat32(offset + 8, true)];
}

function readPose(view: DataView, offset: number): { positionM: Vector; rotation: Quaternion } {
  return {
    positionM: readVector(view, offset),
    rotation: [view.getFloat32(offset + 12, true), ...readVector(view, offset + 16)],
  };
}

function readTool(view: DataView, offset: number, name: ToolName): ToolState {
  const flags = view.getUint8(offset + 76);
  const pose = readPose(view, offset + 8);
  return {
    ...name,
    sequence: Number(view.getBigUint64(offset, true)),
    ...pose,
    asked: pose,
    jaw: view.getFloat32(offset + 36, true),
    askedJaw: view.getFloat32(offset + 36, true),
    jawForceN: 0,
    forceN: readVector(view, offset + 40),
    torqueNm: readVector(view, offset + 52),
    raw: null,
    tipTemperatureC: view.getFloat32(offset + 64, true),
    energyJ: view.getFloat32(offset + 68, true),
    deliveredW: 0,
    loadOhm: 0,
    driver: view.getUint32(offset + 72, true),
    energized: (flags & 1) !== 0,
    grasping: (flags & 2) !== 0,
    frozen: (flags & 4) !== 0,
    slipping: (flags & 8) !== 0,
    energyOff: ENERGY_OFF_REASONS[view.getUint8(offset + 77)] ?? 'never_enabled',
    graspedVertices: view.getUint16(offset + 78, true),
    contactVertices: view.getUint16(offset + 80, true),
    touchedLayers: view.getUint16(offset + 82, true),
  };
}

export function readTools(payload: Uint8Array, names: readonly ToolName[]): ToolState[] {
  if (payload.byteLength !== names.length * TOOL_BYTES) throw new WireError('tool records do not match their names');
  const view = viewOf(payload);
  return names.map((name, i) => readTool(view, i * TOOL_BYTES, name));
}

/** Reads the section of jaws. Without it readTools assumes that jaws have their commanded opening. */
export function readJaws(payload: Uint8Array, tools: readonly ToolState[]): ToolState[] {
  if (payload.byteLength !== tools.length * JAW_BYTES) throw new WireError('jaws do not match their tools');
  const view = viewOf(payload);
  return tools.map((tool, i) => ({ ...tool, askedJaw: view.getFloat32(i * JAW_BYTES, true), jawForceN: view.getFloat32(i * JAW_BYTES + 4, true) }));
}

/** Reads the section of power. Without it readTools assumes that no generator gives power. */
export function readPower(payload: Uint8Array, tools: readonly ToolState[]): ToolState[] {
  if (payload.byteLength !== tools.length * POWER_BYTES) throw new WireError('power does not match the tools');
  const view = viewOf(payload);
  return tools.map((tool, i) => ({ ...tool, deliveredW: view.getFloat32(i * POWER_BYTES, true), loadOhm: view.getFloat32(i * POWER_BYTES + 4, true) }));
}

/** Reads the section of raw forces. Without it they are unknown. */
export function readForces(payload: Uint8Array, tools: readonly ToolState[]): ToolState[] {
  if (payload.byteLength !== tools.length * FORCE_BYTES) throw new WireError('raw forces do not match their tools');
  const view = viewOf(payload);
  return tools.map((tool, i) => {
    const at = i * FORCE_BYTES;
    return { ...tool, raw: { forceN: readVector(view, at), torqueNm: readVector(view, at + 12), filterS: view.getFloat32(at + 24, true) } };
  });
}

// Reads the section of commanded poses. Without it readTools assumes that every tool is at its commanded pose.
export function readAsked(payload: Uint8Array, tools: readonly ToolState[]): ToolState[] {
  if (payload.byteLength !== tools.length * ASKED_BYTES) throw new WireError('poses asked do not match their tools');
  const view = viewOf(payload);
  return tools.map((tool, i) => ({ ...tool, asked: readPose(view, i * ASKED_BYTES) }));
}

export function readStatistics(payload: Uint8Array): Statistics {
  if (payload.byteLength < STATISTICS_BYTES) throw new WireError('the statistics record is cut off');
  const view = viewOf(payload);
  const real = (i: number): number => view.getFloat32(4 * i, true);
  const count = (i: number): number => view.getUint32(48 + 4 * i, true);
  return {
    realtimeFactor: real(0),
    stepCostS: real(1),
    stageS: STAGES.map((_, i) => real(2 + i)),
    residual: real(10),
    deferredMaxS: real(11),
    iterations: count(0),
    backtracks: count(1),
    inverted: count(2),
    edgesParted: count(3),
    elementsRemoved: count(4),
    pendingDowndates: count(5),
    refactorisations: count(6),
    contacts: count(7),
    frozenVertices: count(8),
    refusedCommands: count(9),
    energyGainJ: payload.byteLength >= STATISTICS_BYTES + 4 ? real(22) : 0,
    resting: payload.byteLength >= STATISTICS_BYTES + 8 && count(11) !== 0,
    error: payload.byteLength >= STATISTICS_BYTES + 12 ? real(24) : 0,
    contactsLeftOut: payload.byteLength >= STATISTICS_BYTES + 16 ? count(13) : 0,
    elementsTorn: payload.byteLength >= STATISTICS_BYTES + 20 ? count(14) : 0,
    touchingCutShort: payload.byteLength >= STATISTICS_BYTES + 24 ? count(15) : 0,
  };
}
