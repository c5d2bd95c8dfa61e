// SPDX-License-Identifier: Apache-2.0
// Records of blood vessels in a frame: "Vessel record" in protocol/README.md.
import { viewOf, WireError } from './header';

/** A vessel after a step. */
export interface VesselState {
  name: string;
  parted: boolean; // whether it is parted somewhere
  pierced: boolean; // whether the wall has a hole
  shut: boolean; // whether it is pressed shut somewhere
  sealed: boolean; // whether a seal withstands the blood pressure
  bleeds: boolean;
  radiusM: number; // outer radius of the undeformed tube
  bleedingM3S: number; // flow of blood out of the vessel in the last step
  shedM3: number; // volume of blood that has left the vessel since the session began
  burstPa: number; // predicted pressure at which the best seal opens; 0: no seal
  /** of its middle line, four numbers a point: position in m, and the share of the lumen that is open; below 0: parted here */
  points: Float32Array;
}

/** Numbers of a point in `points`. */
export const POINT_NUMBERS = 4;
const VESSEL_BYTES = 20; // before the name
const POINT_BYTES = 4 * POINT_NUMBERS;

function readVessel(payload: Uint8Array, view: DataView, at: number): { vessel: VesselState; next: number } {
  if (at + VESSEL_BYTES > payload.byteLength) throw new WireError('a vessel is cut off');
  const length = view.getUint8(at);
  const flags = view.getUint8(at + 1);
  const pointCount = view.getUint16(at + 2, true);
  const real = (i: number): number => view.getFloat32(at + 4 + 4 * i, true);
  const first = at + VESSEL_BYTES + 4 * Math.ceil(length / 4);
  const next = first + POINT_BYTES * pointCount;
  if (next > payload.byteLength) throw new WireError('the points of a vessel are cut off');
  const vessel = {
    name: new TextDecoder().decode(payload.subarray(at + VESSEL_BYTES, at + VESSEL_BYTES + length)),
    parted: (flags & 1) !== 0,
    pierced: (flags & 2) !== 0,
    shut: (flags & 4) !== 0,
    sealed: (flags & 8) !== 0,
    bleeds: (flags & 16) !== 0,
    radiusM: real(0),
    bleedingM3S: real(1),
    shedM3: real(2),
    burstPa: real(3),
    points: Float32Array.from({ length: POINT_NUMBERS * pointCount }, (_, i) => view.getFloat32(first + 4 * i, true)),
  };
  if (![vessel.radiusM, vessel.bleedingM3S, vessel.shedM3, vessel.burstPa, ...vessel.points].every(Number.isFinite)) throw new WireError('a number of a vessel is not finite');
  return { vessel, next };
}

export function readVessels(payload: Uint8Array): VesselState[] {
  if (payload.byteLength < 4) throw new WireError('vessels are cut off');
  const view = viewOf(payload);
  const vessels: VesselState[] = [];
  let at = 4;
  for (let left = view.getUint32(0, true); left > 0; left--) {
    const { vessel, next } = readVessel(payload, view, at);
    vessels.push(vessel);
    at = next;
  }
  if (at !== payload.byteLength) throw new WireError('bytes after the last vessel');
  return vessels;
}
