// SPDX-License-Identifier: GPL-3.0-or-later
// A plane that cuts tissue away from the picture, and from what picks in it.
import { Vector3, type IUniform, type Vector4 } from 'three';

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

  /** Whether places along a ray are cut away. */
  away(origin: Vector3, direction: Vector3): (distance: number) => boolean {
    const { x, y, z, w } = this.uniform.value;
    const normal = new Vector3(x, y, z);
    const [from, along] = [origin.dot(normal), direction.dot(normal)];
    return (distance) => from + distance * along > w;
  }
}
