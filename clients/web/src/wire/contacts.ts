// SPDX-License-Identifier: Apache-2.0
// Records of the contact of tools in a frame: "Contact record" in protocol/README.md.
import { viewOf, WireError } from './header';

/** A plane of tissue that touches a tool or is near it. */
export interface ContactPlane {
  normal: number[]; // out of the tissue
  offsetM: number; // in contact if normal . position is less
  velocityMS: number; // of the tissue, along the normal
}

/** A linear model of the contact of a tool at the tick of the frame. */
export interface ContactState {
  name: string; // of the tool
  valid: boolean; // false: only the poses are known
  askedPositionM: number[]; // commanded
  askedRotation: number[]; // w, x, y, z
  positionM: number[]; // actual
  rotation: number[];
  forceN: number[]; // raw, of the tissue on the tool
  complianceMN: number[]; // at the commanded position, m/N: xx, yy, zz, xy, xz, yz
  friction: number;
  dampingNsM: number;
  graspNM: number; // stiffness of what the jaws hold; 0: nothing
  graspAnchorM: number[]; // commanded position at which the grasped tissue pulls with 0 N
  planes: ContactPlane[];
}

const RECORD_BYTES = 120; // before the name
const PLANE_BYTES = 20;

function readContact(payload: Uint8Array, view: DataView, at: number): { contact: ContactState; next: number } {
  if (at + RECORD_BYTES > payload.byteLength) throw new WireError('a contact is cut off');
  const length = view.getUint8(at);
  const planeCount = view.getUint16(at + 2, true);
  const first = at + RECORD_BYTES + 4 * Math.ceil(length / 4);
  const next = first + PLANE_BYTES * planeCount;
  if (next > payload.byteLength) throw new WireError('the planes of a contact are cut off');
  const reals = (from: number, count: number): number[] => {
    const found = Array.from({ length: count }, (_, i) => view.getFloat32(from + 4 * i, true));
    if (!found.every(Number.isFinite)) throw new WireError('a number of a contact is not finite');
    return found;
  };
  const [friction = 0, dampingNsM = 0, graspNM = 0] = reals(at + 96, 3);
  const contact = {
    name: new TextDecoder().decode(payload.subarray(at + RECORD_BYTES, at + RECORD_BYTES + length)),
    valid: (view.getUint8(at + 1) & 1) !== 0,
    askedPositionM: reals(at + 4, 3),
    askedRotation: reals(at + 16, 4),
    positionM: reals(at + 32, 3),
    rotation: reals(at + 44, 4),
    forceN: reals(at + 60, 3),
    complianceMN: reals(at + 72, 6),
    friction,
    dampingNsM,
    graspNM,
    graspAnchorM: reals(at + 108, 3),
    planes: Array.from({ length: planeCount }, (_, i) => {
      const [offsetM = 0, velocityMS = 0] = reals(first + PLANE_BYTES * i + 12, 2);
      return { normal: reals(first + PLANE_BYTES * i, 3), offsetM, velocityMS };
    }),
  };
  return { contact, next };
}

export function readContacts(payload: Uint8Array): ContactState[] {
  if (payload.byteLength < 4) throw new WireError('contacts are cut off');
  const view = viewOf(payload);
  const contacts: ContactState[] = [];
  let at = 4;
  for (let left = view.getUint32(0, true); left > 0; left--) {
    const { contact, next } = readContact(payload, view, at);
    contacts.push(contact);
    at = next;
  }
  if (at !== payload.byteLength) throw new WireError('bytes after the last contact');
  return contacts;
}
