// SPDX-License-Identifier: GPL-3.0-or-later
// An arrow at the first instrument that tissue presses on; its length shows the force.
import { ArrowHelper, Vector3 } from 'three';

import type { ToolState } from '../wire/records';

const METRES_PER_NEWTON = 0.02;
const LEAST_N = 1e-3;
const LENGTH_M = [0.004, 0.08] as const;

export class ForceArrow {
  readonly arrow = new ArrowHelper(new Vector3(0, 0, 1), new Vector3(), 0.01, 0xf5b301);

  constructor() {
    this.arrow.visible = false;
  }

  place(wanted: boolean, states: readonly ToolState[]): void {
    const pressed = states.find((state) => Math.hypot(...state.forceN) > LEAST_N);
    this.arrow.visible = wanted && pressed !== undefined;
    if (!pressed || !this.arrow.visible) return;
    const force = new Vector3(...pressed.forceN);
    const length = Math.min(Math.max(force.length() * METRES_PER_NEWTON, LENGTH_M[0]), LENGTH_M[1]);
    this.arrow.position.set(...pressed.positionM);
    this.arrow.setDirection(force.normalize());
    this.arrow.setLength(length, 0.3 * length, 0.15 * length);
  }
}
