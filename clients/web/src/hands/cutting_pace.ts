// SPDX-License-Identifier: GPL-3.0-or-later
// How far a hot tool may go on: as fast as its heat parts the tissue under it. That takes simulated time, so
// the frames tell it: on a machine that simulates at half the clock's rate a cut takes twice as long and looks
// the same.
import type { Vector3 } from 'three';

import type { Model } from '../model/model';
import { toolSizes } from '../model/tool_parts';
import type { Scene, Tool } from '../wire/messages.gen';

const SAVED_S = 0.1; // of simulated time that a tool may catch up with at once
const SLOWEST_M_S = 0.001;
const ARRIVED_M = 0.001;
const FASTEST_M_S = 0.01; // the hottest tip leaves much behind it beyond this
const BODY_C = 37;
const USUAL_C = 170; // of a tip

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

/** How long a tool's hot part is on its way, m. */
function hotLength(tool: Tool): number {
  const { hot, tip } = toolSizes(tool);
  return 2 * hot + (tool.shape === 'hook' ? tip : 0);
}

export function cuttingSpeed(scene: Scene, tool: Tool): { metresPerS: number; stayS: number } {
  const lasts = partingS(scene, tool.temperature_c ?? USUAL_C);
  const metresPerS = Math.min(Math.max(hotLength(tool) / lasts, SLOWEST_M_S), FASTEST_M_S);
  // What lies under the middle of a hot part when it sets off is left behind after half of its length.
  return { metresPerS, stayS: hotLength(tool) / metresPerS / 2 };
}

export class CuttingPace {
  /** where a cut begins, until the tool is there */
  from: Vector3 | null = null;
  private last: { epoch: string; timeS: number } | null = null;
  private savedS = 0;

  constructor(private readonly model: Model) {
    model.on('frame', ({ epoch, timeS }) => {
      if (this.last?.epoch === epoch) this.savedS = Math.min(this.savedS + timeS - this.last.timeS, SAVED_S);
      this.last = { epoch, timeS };
    });
  }

  /** How far a hot tool may go: fast to where the cut begins, not a step beyond it, and slowly from there on. */
  metresFrom(position: Vector3): number {
    const left = this.from?.distanceTo(position) ?? 0;
    if (left > ARRIVED_M) return left;
    if (this.from) this.savedS = -this.speed.stayS; // it stays there first
    this.from = null;
    return this.take();
  }

  /** Metres since this was asked last. */
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
