// SPDX-License-Identifier: GPL-3.0-or-later
// Finds the point of the tissue under a point of the picture (both coordinates from -1 to 1).
import { Vector3 } from 'three';

import { acrossGap } from '../model/gap';
import { pick } from '../model/pick';
import type { Viewport } from '../scene/viewport';

export class Aim {
  constructor(private readonly viewport: Viewport) {}

  /** Returns the nearest drawn tissue, or the point in a gap where the tissue would be. Returns null beside the tissue, and
   * where the picture is black. */
  onSurface(x: number, y: number): Vector3 | null {
    if (!this.viewport.sees(x, y)) return null;
    const { origin, direction } = this.viewport.orbit.ray(x, y);
    const distance = this.meet(origin, direction);
    return distance === null ? null : origin.addScaledVector(direction, distance);
  }

  /** Returns the point in the plane through `through` that faces the eye. */
  inPlane(x: number, y: number, through: Vector3): Vector3 {
    const { orbit } = this.viewport;
    const { origin, direction } = orbit.ray(x, y);
    const { z } = orbit.axes();
    return origin.addScaledVector(direction, through.clone().sub(origin).dot(z) / direction.dot(z));
  }

  /** Returns the tissue straight under a point, else the nearest vertex; without tissue in the picture, the point itself. */
  under(point: Vector3): Vector3 {
    const { tissue, clip } = this.viewport;
    if (!tissue) return point.clone();
    const distance = this.meet(point, DOWN);
    if (distance !== null) return point.clone().setZ(point.z - distance);
    return nearestVertex(tissue.position.array as Float32Array, point, (at) => clip.hides(at.x, at.y, at.z));
  }

  private meet(origin: Vector3, direction: Vector3): number | null {
    const { tissue, clip } = this.viewport;
    if (!tissue) return null;
    const [from, along] = [origin.toArray(), direction.toArray()];
    const [position, normal] = [tissue.position.array as Float32Array, tissue.normal.array as Float32Array];
    const indices = tissue.visibleIndices();
    const hit = pick(from, along, position, indices, clip.away(origin, direction));
    return hit?.distance ?? acrossGap(from, along, position, normal, indices, (px, py, pz) => clip.hides(px, py, pz));
  }
}

const DOWN = new Vector3(0, 0, -1);

function nearestVertex(position: Float32Array, point: Vector3, hidden: (at: Vector3) => boolean): Vector3 {
  const nearest = point.clone();
  const at = new Vector3();
  let least = Infinity;
  for (let i = 0; i < position.length; i += 3) {
    const squared = at.fromArray(position, i).distanceToSquared(point);
    if (squared >= least || hidden(at)) continue;
    least = squared;
    nearest.copy(at);
  }
  return nearest;
}
