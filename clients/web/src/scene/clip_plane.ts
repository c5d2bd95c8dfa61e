// SPDX-License-Identifier: GPL-3.0-or-later
// A plane that hides tissue in the picture, also from picking.
import type { IUniform, Vector3, Vector4 } from 'three';

export interface Clip {
  axis: 0 | 1 | 2;
  atM: number;
}

export class ClipPlane {
  constructor(private readonly uniform: IUniform<Vector4>) {}

  /** Hides everything beyond a position along an axis; null: nothing. */
  set(clip: Clip | null): void {
    const { value } = this.uniform;
    value.set(0, 0, 0, 1);
    if (clip) value.setComponent(clip.axis, 1).setW(clip.atM);
  }

  /** Returns whether a point is hidden. */
  hides(x: number, y: number, z: number): boolean {
    const { x: nx, y: ny, z: nz, w } = this.uniform.value;
    return nx * x + ny * y + nz * z > w;
  }

  /** Returns a function that tests points along a ray for being hidden. */
  away(origin: Vector3, direction: Vector3): (distance: number) => boolean {
    return (distance) => this.hides(origin.x + distance * direction.x, origin.y + distance * direction.y, origin.z + distance * direction.z);
  }
}
