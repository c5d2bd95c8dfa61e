// SPDX-License-Identifier: GPL-3.0-or-later
// Paints pins onto the tissue: a drag pins the vertices under the pointer.
import type { Vector3 } from 'three';

import type { Selection } from '../wire/messages.gen';
import type { Aim } from './aim';

const RADIUS_M = 0.005;
/** Distance of the dabs of a stroke: half a radius, so that the stroke has no gaps. */
const STEP_M = RADIUS_M / 2;

export class PinBrush {
  private last: Vector3 | null = null;

  constructor(
    private readonly places: Aim,
    private readonly pin: (selection: Selection) => void,
  ) {}

  begin(x: number, y: number): void {
    this.last = null;
    this.reach(x, y);
  }

  /** Continues the stroke to a point of the picture. Beside the tissue nothing is pinned. */
  reach(x: number, y: number): void {
    const place = this.places.onSurface(x, y);
    if (!place || (this.last && place.distanceTo(this.last) < STEP_M)) return;
    this.last = place;
    this.pin({ kind: 'sphere', center_m: place.toArray(), radius_m: RADIUS_M });
  }
}
