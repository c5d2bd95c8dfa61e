// SPDX-License-Identifier: GPL-3.0-or-later
// A ruler from one place of the tissue to another. It stays where it was laid; tissue may move under it.
import type { Vector3 } from 'three';

import type { Aim } from './aim';

export class Ruler {
  from: Vector3 | null = null;
  to: Vector3 | null = null;

  constructor(private readonly places: Aim) {}

  /** m */
  get length(): number | null {
    return this.from && this.to ? this.from.distanceTo(this.to) : null;
  }

  begin(x: number, y: number): void {
    this.from = this.places.onSurface(x, y);
    this.to = null;
  }

  /** Beside the tissue it stays. */
  reach(x: number, y: number): void {
    if (this.from) this.to = this.places.onSurface(x, y) ?? this.to;
  }

  clear(): void {
    this.from = this.to = null;
  }
}
