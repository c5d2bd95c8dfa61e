// SPDX-License-Identifier: GPL-3.0-or-later
// A ruler between two points of the tissue. The ruler does not move with the tissue.
import type { Vector3 } from 'three';

import type { Aim } from './aim';

export class Ruler {
  from: Vector3 | null = null;
  to: Vector3 | null = null;

  constructor(private readonly places: Aim) {}

  /** Returns the length, m. */
  get length(): number | null {
    return this.from && this.to ? this.from.distanceTo(this.to) : null;
  }

  begin(x: number, y: number): void {
    this.from = this.places.onSurface(x, y);
    this.to = null;
  }

  /** Moves the end of the ruler to a point of the picture. Beside the tissue the end stays. */
  reach(x: number, y: number): void {
    if (this.from) this.to = this.places.onSurface(x, y) ?? this.to;
  }

  clear(): void {
    this.from = this.to = null;
  }
}
