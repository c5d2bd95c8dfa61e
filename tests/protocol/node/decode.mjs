// SPDX-License-Identifier: GPL-3.0-or-later
// A decoder of frames and topology, written from protocol/README.md alone; which scalars there are it
// reads in the machine-readable document.
import { MeshoptDecoder } from 'meshoptimizer';
import { readFileSync } from 'node:fs';

await MeshoptDecoder.ready;

const document = JSON.parse(readFileSync(process.env.CAUTERY_ASYNCAPI, 'utf8'));
export const SCALARS = document['x-stream-channels'].filter((channel) => 'most' in channel);

export const KEY = 1;
export const DELTA = 2;
export const TOPOLOGY = 3;

const HEADER_BYTES = 72;
const POSITION_LIMIT = 2 ** 30;

/** Damage inside a frame: what is held is lost. */
export class Corrupt extends Error {}
/** A frame that is not for this state: what is held stays. */
export class Refused extends Error {}

function fail(what) {
  throw new Corrupt(what);
}

export function readHeader(bytes) {
  if (bytes.length < HEADER_BYTES) throw new Refused('too short for a header');
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (String.fromCharCode(...bytes.subarray(0, 4)) !== 'CAUF') throw new Refused('no frame');
  if (bytes[4] !== 1) throw new Refused('another version');
  const header = {
    kind: bytes[5],
    flags: view.getUint16(6, true),
    byteCount: view.getUint32(8, true),
    session: view.getUint32(12, true),
    epoch: view.getBigUint64(16, true),
    sequence: view.getBigUint64(24, true),
    baseSequence: view.getBigUint64(32, true),
    tick: view.getBigUint64(40, true),
    time: view.getFloat64(48, true),
    publishedUs: view.getBigUint64(56, true),
    profile: view.getUint16(64, true),
    sectionCount: view.getUint16(66, true),
  };
  if (header.byteCount !== bytes.length) throw new Refused('the length is another');
  return header;
}

/** The sections of a frame as {type, payload}. */
function readSections(bytes, header) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const sections = [];
  let at = HEADER_BYTES;
  let before = 0;
  for (let i = 0; i < header.sectionCount; i++) {
    if (at + 8 > bytes.length) fail('a section is missing');
    const type = bytes[at];
    const length = view.getUint32(at + 4, true);
    if (length % 4 !== 0 || at + 8 + length > bytes.length) fail('a section is too long');
    if (type <= before) fail('section types do not ascend');
    sections.push({ type, payload: bytes.subarray(at + 8, at + 8 + length) });
    before = type;
    at += 8 + length;
  }
  if (at !== bytes.length) fail('bytes after the last section');
  return sections;
}

const roundUp4 = (bytes) => (bytes + 3) & ~3;

/** [[begin, end), ...] of a run list. */
function readRuns(list, count, arrayLength) {
  let at = 0;
  const number = () => {
    let value = 0;
    for (let shift = 0; shift < 35; shift += 7) {
      if (at >= list.length) fail('a run list is damaged');
      const byte = list[at++];
      value += (byte & 0x7f) * 2 ** shift;
      if (byte < 0x80) return value;
    }
    return fail('a run list is damaged');
  };
  const runs = [];
  let element = 0;
  let total = 0;
  while (at < list.length) {
    const begin = element + number();
    const length = number();
    if (length === 0 || begin + length > arrayLength) fail('a run is beyond the array');
    runs.push([begin, begin + length]);
    element = begin + length;
    total += length;
  }
  if (total !== count) fail('runs do not add up');
  return runs;
}

/** The numbers of an element section as bytes, and the stride between elements. */
function unpack(data, { width, components, coding, count }) {
  const elementBytes = width * components;
  if (coding === 0) {
    if (data.length !== roundUp4(count * elementBytes)) fail('plain data of the wrong length');
    return { bytes: data, stride: elementBytes };
  }
  const length = new DataView(data.buffer, data.byteOffset).getUint32(0, true);
  if (4 + roundUp4(length) !== data.length) fail('coded data of the wrong length');
  const stride = components === 1 ? elementBytes : roundUp4(elementBytes);
  const vertexBytes = components === 1 ? 4 : stride;
  const vertexCount = components === 1 ? roundUp4(count * elementBytes) / 4 : count;
  const bytes = new Uint8Array(vertexCount * vertexBytes);
  MeshoptDecoder.decodeVertexBuffer(bytes, vertexCount, vertexBytes, data.subarray(4, 4 + length));
  return { bytes, stride };
}

function readNumber(view, at, width, isDifference) {
  const digits = width === 1 ? view.getUint8(at) : width === 2 ? view.getUint16(at, true) : view.getUint32(at, true);
  if (!isDifference) return digits | 0;
  const balance = width === 1 ? 0x80 : width === 2 ? 0x8080 : 0x80808080 | 0;
  return ((digits ^ balance) - balance) | 0;
}

/** Reads a section into `values`, an Int32Array of elements; returns how many elements it held. */
function readElements(payload, values, components, mayReferToHeld) {
  if (payload.length < 12) fail('an element section is too short');
  const view = new DataView(payload.buffer, payload.byteOffset, payload.byteLength);
  const head = { width: payload[0], components: payload[1], coding: payload[2], count: view.getUint32(4, true) };
  const reference = payload[3];
  const runBytes = view.getUint32(8, true);
  if (![1, 2, 4].includes(head.width) || head.components !== components) fail('width or components');
  if (head.coding > 1 || reference > 2 || (reference === 2 && !mayReferToHeld)) fail('coding or reference');
  if (12 + roundUp4(runBytes) > payload.length) fail('the run list is too long');
  const runs = readRuns(payload.subarray(12, 12 + runBytes), head.count, values.length / components);
  const { bytes, stride } = unpack(payload.subarray(12 + roundUp4(runBytes)), head);
  const numbers = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const previous = new Int32Array(components);
  let at = 0;
  for (const [begin, end] of runs) {
    for (let element = begin; element < end; element++, at += stride) {
      for (let c = 0; c < components; c++) {
        const number = readNumber(numbers, at + c * head.width, head.width, reference !== 0);
        const i = element * components + c;
        const base = reference === 2 ? values[i] : reference === 1 ? previous[c] : 0;
        values[i] = (base + number) | 0;
        previous[c] = values[i];
      }
    }
  }
  return head.count;
}

function readToolNames(payload) {
  const count = new DataView(payload.buffer, payload.byteOffset).getUint32(0, true);
  const names = [];
  let at = 4;
  for (let i = 0; i < count; i++) {
    const length = payload[at + 1];
    if (at + 2 + length > payload.length) fail('a tool name is too long');
    names.push({ shape: payload[at], name: new TextDecoder().decode(payload.subarray(at + 2, at + 2 + length)) });
    at += 2 + length;
  }
  return names;
}

function readTool(view, at, name) {
  const floats = (offset, count) => Array.from({ length: count }, (_, i) => view.getFloat32(at + offset + 4 * i, true));
  const flags = view.getUint8(at + 76);
  return {
    ...name,
    sequence: view.getBigUint64(at, true),
    position: floats(8, 3),
    rotation: floats(20, 4),
    asked: floats(8, 3),
    askedRotation: floats(20, 4),
    jaw: floats(36, 1),
    askedJaw: floats(36, 1),
    jawForce: [0],
    power: [0],
    load: [0],
    force: floats(40, 3),
    torque: floats(52, 3),
    temperature: floats(64, 1),
    energy: floats(68, 1),
    driver: view.getUint32(at + 72, true),
    energized: (flags & 1) !== 0,
    grasping: (flags & 2) !== 0,
    frozen: (flags & 4) !== 0,
    energyOff: view.getUint8(at + 77),
    grasped: view.getUint16(at + 78, true),
    contacts: view.getUint16(at + 80, true),
    layers: view.getUint16(at + 82, true),
  };
}

function readStatistics(payload) {
  const view = new DataView(payload.buffer, payload.byteOffset, payload.byteLength);
  return { realtimeFactor: view.getFloat32(0, true), iterations: view.getUint32(48, true), contacts: view.getUint32(76, true) };
}

function readVessels(payload) {
  const view = new DataView(payload.buffer, payload.byteOffset, payload.byteLength);
  const vessels = [];
  let at = 4;
  for (let left = view.getUint32(0, true); left > 0; left--) {
    const length = payload[at];
    const points = view.getUint16(at + 2, true);
    const first = at + 20 + 4 * Math.ceil(length / 4);
    const floats = (from, count) => Array.from({ length: count }, (_, i) => view.getFloat32(from + 4 * i, true));
    vessels.push({ name: new TextDecoder().decode(payload.subarray(at + 20, at + 20 + length)), flags: payload[at + 1], scalars: floats(at + 4, 4), points: floats(first, 4 * points) });
    at = first + 16 * points;
  }
  if (at !== payload.length) fail('vessels of another length');
  return vessels;
}

function readContacts(payload) {
  const view = new DataView(payload.buffer, payload.byteOffset, payload.byteLength);
  const contacts = [];
  let at = 4;
  for (let left = view.getUint32(0, true); left > 0; left--) {
    const length = payload[at];
    const planes = view.getUint16(at + 2, true);
    const floats = (from, count) => Array.from({ length: count }, (_, i) => view.getFloat32(from + 4 * i, true));
    const first = at + 120 + 4 * Math.ceil(length / 4);
    contacts.push({
      name: new TextDecoder().decode(payload.subarray(at + 120, at + 120 + length)), valid: payload[at + 1] === 1, asked: floats(at + 4, 3), askedRotation: floats(at + 16, 4),
      position: floats(at + 32, 3), rotation: floats(at + 44, 4), force: floats(at + 60, 3), compliance: floats(at + 72, 6), scalars: floats(at + 96, 3), anchor: floats(at + 108, 3),
      planes: floats(first, 5 * planes),
    });
    at = first + 20 * planes;
  }
  if (at !== payload.length) fail('contacts of another length');
  return contacts;
}

/** Holds one stream, as a subscriber does. */
export class StreamDecoder {
  constructor({ session, profile, vertexCount, faceCount }) {
    this.session = session;
    this.profile = profile;
    this.synced = false;
    this.quantised = new Int32Array(3 * vertexCount);
    this.mask = new Int32Array(Math.ceil(faceCount / 32));
    this.arrays = [null, this.quantised, this.mask]; // by section
    for (const { name, section } of SCALARS) this.arrays[section] = this[name] = new Int32Array(vertexCount);
    this.toolNames = [];
    this.tools = [];
    this.codings = new Set();
    this.widths = new Set();
  }

  checkPlace(header) {
    if (header.session !== this.session || header.profile !== this.profile) throw new Refused('another stream');
    if (header.kind === KEY) {
      if (this.synced && header.epoch === this.epoch && header.sequence <= this.sequence) throw new Refused('not newer');
      return;
    }
    if (header.kind !== DELTA) throw new Refused('no state');
    if (!this.synced) throw new Refused('a key frame is needed');
    if (header.epoch !== this.epoch) throw new Refused('another epoch');
    if (header.baseSequence !== this.sequence) throw new Refused('another base');
  }

  readSection({ type, payload }, isDelta) {
    if (this.arrays[type]) {
      const count = readElements(payload, this.arrays[type], type === 1 ? 3 : 1, isDelta);
      if (!isDelta && type === 1 && count * 3 !== this.quantised.length) fail('a key frame lacks positions');
      this.widths.add(payload[0]);
      this.codings.add(payload[2]);
    } else if (type === 6) {
      this.toolNames = readToolNames(payload);
    } else if (type === 7) {
      if (payload.length !== 84 * this.toolNames.length) fail('not as many tools as names');
      const view = new DataView(payload.buffer, payload.byteOffset, payload.byteLength);
      this.tools = this.toolNames.map((name, i) => readTool(view, 84 * i, name));
    } else if (type === 32) {
      if (payload.length !== 28 * this.tools.length) fail('not as many poses asked as tools');
      const view = new DataView(payload.buffer, payload.byteOffset, payload.byteLength);
      const floats = (at, count) => Array.from({ length: count }, (_, k) => view.getFloat32(at + 4 * k, true));
      this.tools.forEach((tool, i) => Object.assign(tool, { asked: floats(28 * i, 3), askedRotation: floats(28 * i + 12, 4) }));
    } else if (type === 33) {
      if (payload.length !== 8 * this.tools.length) fail('not as many jaws as tools');
      const view = new DataView(payload.buffer, payload.byteOffset, payload.byteLength);
      this.tools.forEach((tool, i) => Object.assign(tool, { askedJaw: [view.getFloat32(8 * i, true)], jawForce: [view.getFloat32(8 * i + 4, true)] }));
    } else if (type === 35) {
      if (payload.length !== 28 * this.tools.length) fail('not as many raw forces as tools');
      const view = new DataView(payload.buffer, payload.byteOffset, payload.byteLength);
      const floats = (at, count) => Array.from({ length: count }, (_, i) => view.getFloat32(at + 4 * i, true));
      this.tools.forEach((tool, i) => Object.assign(tool, { rawForce: floats(28 * i, 3), rawTorque: floats(28 * i + 12, 3), forceFilter: floats(28 * i + 24, 1) }));
    } else if (type === 34) {
      if (payload.length !== 8 * this.tools.length) fail('not as much power as tools');
      const view = new DataView(payload.buffer, payload.byteOffset, payload.byteLength);
      this.tools.forEach((tool, i) => Object.assign(tool, { power: [view.getFloat32(8 * i, true)], load: [view.getFloat32(8 * i + 4, true)] }));
    } else if (type === 10) {
      this.vessels = readVessels(payload);
    } else if (type === 12) {
      this.toolContacts = readContacts(payload);
    } else if (type === 8) {
      this.statistics = readStatistics(payload);
    }
  }

  decode(bytes) {
    const header = readHeader(bytes);
    this.checkPlace(header);
    if (header.kind === KEY) {
      for (const array of this.arrays) array?.fill(0);
      this.toolNames = [];
      this.tools = [];
    }
    this.synced = false;
    for (const section of readSections(bytes, header)) this.readSection(section, header.kind === DELTA);
    if (this.quantised.some((q) => Math.abs(q) > POSITION_LIMIT)) fail('a position is out of range');
    Object.assign(this, { synced: true, epoch: header.epoch, sequence: header.sequence, tick: header.tick, time: header.time });
  }
}

/** Faces, layers, texture and rest positions of a topology frame. */
export function decodeTopology(bytes, vertexCount, faceCount) {
  const header = readHeader(bytes);
  if (header.kind !== TOPOLOGY) throw new Refused('no topology');
  const arrays = {
    16: [new Int32Array(3 * faceCount), 3],
    17: [new Int32Array(faceCount), 1],
    18: [new Int32Array(6 * faceCount), 6],
    19: [new Int32Array(3 * vertexCount), 3],
  };
  for (const { type, payload } of readSections(bytes, header))
    if (arrays[type]) readElements(payload, ...arrays[type], false);
  return { faces: arrays[16][0], layers: arrays[17][0], texture: new Float32Array(arrays[18][0].buffer), rest: arrays[19][0] };
}
