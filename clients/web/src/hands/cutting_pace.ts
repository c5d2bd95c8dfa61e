// SPDX-License-Identifier: GPL-3.0-or-later
// Limits how far a hot tool may move: as fast as its heat parts the tissue under it. This takes simulated time, which
// the frames give. On a machine that simulates at half the rate of the clock, a cut takes twice as long and looks the
// same.
import type { Vector3 } from 'three';

import type { Model } from '../model/model';
import { toolSizes } from '../model/tool_parts';
import type { Scene, Tool } from '../wire/messages.gen';

const SAVED_S = 0.1; // simulated time that a tool may catch up with in one frame
const SLOWEST_M_S = 0.001;
const ARRIVED_M = 0.001;
const FASTEST_M_S = 0.01; // beyond this, even the hottest tip leaves much tissue behind
const BODY_C = 37;
const USUAL_C = 170; // usual temperature of a tip

/**
 * Seconds under a tip until the most stubborn tissue has taken so much heat up that it parts: it nears the
 * tip's temperature by a share of the difference each second. Infinite: it never does.
 */
function partingS({ ambient_c: ambient = BODY_C, layers = [] }: Scene, tipC: number): number {
  return Math.max(0, ...layers.map((layer) => {
    const { ignition_c: ignition, absorption_per_s: absorption } = layer as { ignition_c?: number; absorption_per_s?: number };
    if (ignition === undefined || !absorption) return 0;
    return ignition >= tipC ? Infinity : -Math.log(1 - (ignition - ambient) / (tipC - ambient)) / absorption;
  }));
}

/** Length of the hot part of a tool along its motion, m. */
function hotLength(tool: Tool): number {
  const { hot, tip } = toolSizes(tool);
  return 2 * hot + (tool.shape === 'hook' ? tip : 0);
}

export function cuttingSpeed(scene: Scene, tool: Tool): { metresPerS: number; stayS: number } {
  const lasts = partingS(scene, tool.temperature_c ?? USUAL_C);
  const metresPerS = Math.min(Math.max(hotLength(tool) / lasts, SLOWEST_M_S), FASTEST_M_S);
  // The hot part leaves the tissue under its middle after half of its length.
  return { metresPerS, stayS: hotLength(tool) / metresPerS / 2 };
}

export class CuttingPace {
  /** start of a cut; null once the tool has reached it */
  from: Vector3 | null = null;
  private last: { epoch: string; timeS: number } | null = null;
  private savedS = 0;

  constructor(private readonly model: Model) {
    model.on('frame', ({ epoch, timeS }) => {
      if (this.last?.epoch === epoch) this.savedS = Math.min(this.savedS + timeS - this.last.timeS, SAVED_S);
      this.last = { epoch, timeS };
    });
  }

  /** Returns how far a hot tool may move: fast to the start of the cut, and slowly from there on. */
  metresFrom(position: Vector3): number {
    const left = this.from?.distanceTo(position) ?? 0;
    if (left > ARRIVED_M) return left;
    if (this.from) this.savedS = -this.speed.stayS; // first the tool waits there
    this.from = null;
    return this.take();
  }

  /** Returns the metres that have become free since the last call. */
  private take(): number {
    if (this.savedS <= 0) return 0;
    const metres = this.speed.metresPerS * this.savedS;
    this.savedS = 0;
    return metres;
  }

  private get speed(): { metresPerS: number; stayS: number } {
    const { joined, tool } = this.model;
    return joined && tool ? cuttingSpeed(joined.description.definition, tool) : { metresPerS: SLOWEST_M_S, stayS: 0 };
  }
}
