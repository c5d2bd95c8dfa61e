// SPDX-License-Identifier: GPL-3.0-or-later
// Takes a free tool when the user uses it. If the tool cannot be used, says at once why, beside the pointer.
import type { Control } from '../model/control';
import type { Model } from '../model/model';
import { nameOf } from '../model/person';
import { errorWords } from '../model/sentences';

const KEY = 'driver';
const TOLD_MS = 4000; // least time between two messages; keys and sticks try sixty times a second

export class Taking {
  private busy = false;
  private toldAt = -Infinity;

  constructor(
    private readonly model: Model,
    private readonly control: Control,
  ) {
    model.on('tools', () => {
      if (model.driving || !model.driver) model.unsay(KEY);
    });
  }

  /** Becomes the driver of the chosen tool if it has none. Returns false, and shows the reason, if it cannot be used. */
  use(): boolean {
    const { model } = this;
    if (this.busy || model.driving) return true;
    const tool = model.selectedTool;
    const why = this.obstacle();
    if (why !== null || tool === null) {
      if (why !== null) this.refuse(why);
      return false;
    }
    this.busy = true;
    this.control
      .takeOver(tool)
      .catch((error: unknown) => this.refuse(`The ${tool} could not be taken. ${errorWords(error)}`))
      .finally(() => (this.busy = false));
    return true;
  }

  private obstacle(): string | null {
    const { model } = this;
    if (model.link.state !== 'online') return 'There is no connection, so the tool cannot be moved.';
    if (!model.mayOperate) return 'You can only watch, because your access token does not allow you to use tools.';
    if (!model.joined) return null; // the veil over the picture explains the wait
    if (model.tools.length === 0) return 'This session has no tools.';
    return model.driver ? `${nameOf(model.driver)} is using the ${model.driver.tool}.` : null;
  }

  private refuse(why: string): void {
    const { model, control } = this;
    const now = performance.now();
    if (now - this.toldAt < TOLD_MS) return;
    this.toldAt = now;
    const { driver } = model;
    if (!driver || !model.mayOperate) {
      model.say('warning', why);
      return;
    }
    const ask = (): void => {
      control.ask(driver.tool).then(
        () => model.say('info', `${nameOf(driver)} has been asked for the ${driver.tool}.`),
        (error: unknown) => model.say('error', errorWords(error)),
      );
    };
    model.say('warning', why, { action: { words: `Ask ${nameOf(driver)} for the tool`, press: ask } });
  }
}
