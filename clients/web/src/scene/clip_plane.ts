// SPDX-License-Identifier: GPL-3.0-or-later
// A plane that cuts tissue away from the picture, and from what picks in it.
import type { IUniform, Vector3, Vector4 } from 'three';

export interface Clip {
  axis: 0 | 1 | 2;
  atM: number;
}

export class ClipPlane {
  constructor(private readonly uniform: IUniform<Vector4>) {}

  /** Cuts away what lies further along an axis than a place; null: nothing. */
  set(clip: Clip | null): void {
    const { value } = this.uniform;
    value.set(0, 0, 0, 1);
    if (clip) value.setComponent(clip.axis, 1).setW(clip.atM);
  }

  /** Whether a place is cut away. */
  hides(x: number, y: number, z: number): boolean {
    const { x: nx, y: ny, z: nz, w } = this.uniform.value;
    return nx * x + ny * y + nz * z > w;
  }

  /** Whether places along a ray are cut away. */
  away(origin: Vector3, direction: Vector3): (distance: number) => boolean {
    return (distance) => this.hides(origin.x + distance * direction.x, origin.y + distance * direction.y, origin.z + distance * direction.z);
  }
}
