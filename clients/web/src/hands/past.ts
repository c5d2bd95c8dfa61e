// SPDX-License-Identifier: GPL-3.0-or-later
// Refuses input while the picture shows the past, because the user does not see the present tissue.
import type { Model } from '../model/model';
import { text } from '../text/text';

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

  /** Returns whether input is refused, and explains it to the user. */
  refuses(): boolean {
    if (this.shown) this.model.say('info', text.handsPast.refused);
    return this.shown;
  }
}
