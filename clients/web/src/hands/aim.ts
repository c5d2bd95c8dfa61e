// SPDX-License-Identifier: GPL-3.0-or-later
// Places of the tissue that a place of the picture (both coordinates from -1 to 1) points at.
import { Vector3 } from 'three';

import { pick } from '../model/pick';
import type { Viewport } from '../scene/viewport';

export class Aim {
  constructor(private readonly viewport: Viewport) {}

  /** The nearest tissue that is drawn there; null beside it. */
  onSurface(x: number, y: number): Vector3 | null {
    const { tissue, orbit } = this.viewport;
    if (!tissue) return null;
    const { origin, direction } = orbit.ray(x, y);
    const position = tissue.position.array as Float32Array;
    const hit = pick(origin.toArray(), direction.toArray(), position, tissue.visibleIndices());
    return hit && origin.addScaledVector(direction, hit.distance);
  }

  /** In the plane that faces the eye, through a point. */
  inPlane(x: number, y: number, through: Vector3): Vector3 {
    const { orbit } = this.viewport;
    const { origin, direction } = orbit.ray(x, y);
    const { z } = orbit.axes();
    return origin.addScaledVector(direction, through.clone().sub(origin).dot(z) / direction.dot(z));
  }

  /** The tissue straight under a point, or else its vertex nearest to it; without tissue the point. */
  under(point: Vector3): Vector3 {
    const { tissue } = this.viewport;
    if (!tissue) return point.clone();
    const position = tissue.position.array as Float32Array;
    const hit = pick(point.toArray(), [0, 0, -1], position, tissue.visibleIndices());
    return hit ? point.clone().setZ(point.z - hit.distance) : nearestVertex(position, point);
  }
}

function nearestVertex(position: Float32Array, point: Vector3): Vector3 {
  const nearest = point.clone();
  const at = new Vector3();
  let least = Infinity;
  for (let i = 0; i < position.length; i += 3) {
    const squared = at.fromArray(position, i).distanceToSquared(point);
    if (squared >= least) continue;
    least = squared;
    nearest.copy(at);
  }
  return nearest;
}
