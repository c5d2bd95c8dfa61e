// SPDX-License-Identifier: GPL-3.0-or-later
// The scene that an uploaded mesh becomes: one tissue, held at its lowest corners, a hook above it.
import type { Layer, Scene } from '../wire/messages.gen';

export type MeshKind = 'fascia' | 'fat';

const FASCIA: Layer = {
  kind: 'fascia', name: 'fascia', mesh: 'mesh', limit: 'range', shrink: [0.1, 0.3], ignition_c: 160, absorption_per_s: 0.4,
  bending_stiffness_nm: 1e-5,
};
const FAT: Layer = {
  kind: 'fat', name: 'fat', mesh: 'mesh', young_modulus_pa: 5000, shrink: [0.1, 1, 1], ignition_c: 78, absorption_per_s: 0.6,
};
const MEMBRANE: Layer = {
  kind: 'membrane', name: 'membrane', of: 'fat', thickness_m: 2e-4, limit_stiffness_pa: 1e5, ignition_c: 78, absorption_per_s: 0.6,
};

/** The vertices nearest to these are the lowest corners of any mesh: held, so that it cannot float away. */
const FAR_BELOW: readonly [number, number, number][] = [
  [90, 90, -90],
  [90, -90, -90],
  [-90, 90, -90],
  [-90, -90, -90],
];

/** `file` as the upload's answer names it; unitM: metres in one unit of the file. */
export function sceneOfMesh(file: string, kind: MeshKind, unitM: number): Scene {
  const layers = kind === 'fat' ? [FAT, MEMBRANE] : [FASCIA];
  return {
    name: 'uploaded',
    description: 'An uploaded mesh.',
    damping_per_s: 4,
    gravity_m_s2: [0, 0, 0],
    parting: 'elements',
    meshes: [{ source: 'bytes', name: 'mesh', file, unit_m: unitM }],
    layers,
    pins: FAR_BELOW.map((center_m) => ({ kind: 'nearest', center_m })),
    tools: [{ name: 'hook', shape: 'hook', position_m: [0, 0, 0.1] }],
  };
}
