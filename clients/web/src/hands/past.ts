// SPDX-License-Identifier: GPL-3.0-or-later
// While the picture shows the past there is nothing in it for a hand to do: what is not seen is not worked on.
import type { Model } from '../model/model';

export class Past {
  constructor(
    private readonly model: Model,
    left: () => void,
  ) {
    model.on('held', (tick) => {
      if (tick !== null) left();
    });
  }

  get shown(): boolean {
    return this.model.held !== null;
  }

  /** Says so to a hand that tries. */
  refuses(): boolean {
    if (this.shown) this.model.say('info', 'This is a past view. Press Return to live to use the tools.');
    return this.shown;
  }
}
