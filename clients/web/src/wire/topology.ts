// SPDX-License-Identifier: Apache-2.0
// Reads the topology frame, which has what never changes: faces, their layers, texture, rest positions.
import type { StreamShape } from './decoder';
import { applyElements } from './elements';
import { readHeader, readSections, WireError } from './header';
import { SECTION } from './messages.gen';

export interface Topology {
  /** vertices of each face (faces x 3) */
  faces: Int32Array;
  /** layer of each face */
  faceLayers: Int32Array;
  /** u, v of each corner (faces x 3 x 2), if the session has any */
  texture: Float32Array | null;
  /** steps from the origin (vertices x 3) */
  rest: Int32Array;
}

function readWhole(sections: Map<number, Uint8Array>, type: number, count: number, components: number): Int32Array {
  const payload = sections.get(type);
  if (!payload) throw new WireError(`a topology frame without section ${type}`);
  const values = new Int32Array(count * components);
  const runs = applyElements(payload, values, components, false);
  const total = runs.reduce((sum, length, i) => (i % 2 ? sum + length : sum), 0);
  if (total !== count) throw new WireError(`section ${type} is not whole`);
  return values;
}

export function decodeTopology(shape: StreamShape, bytes: Uint8Array): Topology {
  const header = readHeader(bytes);
  if (header.kind !== 'topology' || header.session !== shape.session_number)
    throw new WireError('not the topology of this stream');
  const sections = readSections(bytes, header.sectionCount);
  const faces = readWhole(sections, SECTION.faces, shape.face_count, 3);
  if (faces.some((vertex) => vertex < 0 || vertex >= shape.vertex_count))
    throw new WireError('a face with a vertex that is not there');
  const texture = sections.has(SECTION.texture) ? readWhole(sections, SECTION.texture, shape.face_count, 6) : null;
  return {
    faces,
    faceLayers: readWhole(sections, SECTION.face_layers, shape.face_count, 1),
    texture: texture && new Float32Array(texture.buffer),
    rest: readWhole(sections, SECTION.rest, shape.vertex_count, 3),
  };
}
