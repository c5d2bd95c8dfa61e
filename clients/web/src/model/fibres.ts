// SPDX-License-Identifier: GPL-3.0-or-later
// Computes material coordinates in metres for each vertex, the first along the fibres. They come from texture coordinates
// if the mesh has them, else from rest positions and the fibre direction of the layer.
import type { Layer, LayerDescription, Scene } from '../wire/messages.gen';
import type { Topology } from '../wire/topology';

type Vector = [number, number, number];

const cross = (a: Vector, b: Vector): Vector => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];

function normalised(v: Vector): Vector {
  const length = Math.hypot(...v) || 1;
  return [v[0] / length, v[1] / length, v[2] / length];
}

/** Returns three perpendicular directions, the first along `fibre`. */
export function fibreFrame(fibre: Vector): [Vector, Vector, Vector] {
  const first = normalised(Math.hypot(...fibre) > 0 ? fibre : [1, 0, 0]);
  const aside: Vector = Math.abs(first[2]) < 0.9 ? [0, 0, 1] : [0, 1, 0];
  const second = normalised(cross(aside, first));
  return [first, second, cross(first, second)];
}

function layerFibre(scene: Scene, name: string): Vector {
  const layer: Layer | undefined = scene.layers?.find((candidate) => candidate.name === name);
  return layer && 'fibre' in layer && layer.fibre ? layer.fibre : [1, 0, 0];
}

/** Returns the metres in one unit of the texture, from the longest sides of the faces of the layer. */
function textureScale(topology: Topology, texture: Float32Array, rest: Float32Array, layer: LayerDescription): number {
  let metres = 0;
  let units = 0;
  for (let face = layer.first_face; face < layer.first_face + layer.face_count; face++) {
    const a = 3 * topology.faces[3 * face];
    const b = 3 * topology.faces[3 * face + 1];
    metres += Math.hypot(rest[b] - rest[a], rest[b + 1] - rest[a + 1], rest[b + 2] - rest[a + 2]);
    units += Math.hypot(texture[6 * face + 2] - texture[6 * face], texture[6 * face + 3] - texture[6 * face + 1]);
  }
  return units > 0 ? metres / units : 0;
}

/** Returns the material coordinates (vertices x 3). A vertex of several layers has the coordinates of the first sheet. */
export function materialCoordinates(
  topology: Topology,
  rest: Float32Array,
  layers: readonly LayerDescription[],
  scene: Scene,
): Float32Array {
  const material = new Float32Array(rest.length);
  const sheetsLast = [...layers].sort((a, b) => Number(a.kind !== 'fat') - Number(b.kind !== 'fat'));
  for (const layer of sheetsLast) {
    const frame = fibreFrame(layerFibre(scene, layer.name));
    const texture = layer.kind === 'fat' ? null : topology.texture;
    const scale = texture ? textureScale(topology, texture, rest, layer) : 0;
    for (let corner = 3 * layer.first_face; corner < 3 * (layer.first_face + layer.face_count); corner++) {
      const v = 3 * topology.faces[corner];
      if (texture && scale > 0) {
        material.set([scale * texture[2 * corner], scale * texture[2 * corner + 1], 0], v);
        continue;
      }
      for (let c = 0; c < 3; c++)
        material[v + c] = rest[v] * frame[c][0] + rest[v + 1] * frame[c][1] + rest[v + 2] * frame[c][2];
    }
  }
  return material;
}
