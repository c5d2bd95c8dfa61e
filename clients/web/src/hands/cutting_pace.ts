// SPDX-License-Identifier: GPL-3.0-or-later
// How far a hot tool may go on. Heat parts tissue in simulated time, so the pace is told by the frames: on
// a machine that simulates at half the clock's rate a cut takes twice as long and looks the same.
import type { Model } from '../model/model';

/** What a hook at 170 degC parts without leaving much behind it. */
const SPEED_M_S = 0.004;
const SAVED_S = 0.1; // of simulated time that a tool may catch up with at once

export class CuttingPace {
  private last: { epoch: string; timeS: number } | null = null;
  private savedS = 0;

  constructor(model: Model) {
    model.on('frame', ({ epoch, timeS }) => {
      if (this.last?.epoch === epoch) this.savedS = Math.min(this.savedS + timeS - this.last.timeS, SAVED_S);
      this.last = { epoch, timeS };
    });
  }

  /** Metres since this was asked last. */
  take(): number {
    const metres = SPEED_M_S * this.savedS;
    this.savedS = 0;
    return metres;
  }
}
