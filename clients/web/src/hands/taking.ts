// SPDX-License-Identifier: GPL-3.0-or-later
// Takes a free tool when the user uses it. If the tool cannot be used, says at once why, beside the pointer.
import type { Control } from '../model/control';
import type { Model } from '../model/model';
import { nameOf } from '../model/person';
import { errorWords } from '../model/sentences';
import { text } from '../text/text';

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
      .catch((error: unknown) => this.refuse(text.taking.failed(tool, errorWords(error))))
      .finally(() => (this.busy = false));
    return true;
  }

  private obstacle(): string | null {
    const { model } = this;
    if (model.link.state !== 'online') return text.taking.noConnection;
    if (!model.mayOperate) return text.taking.watchOnly;
    if (!model.joined) return null; // the veil over the picture explains the wait
    if (model.tools.length === 0) return text.taking.noTools;
    return model.driver ? text.taking.inUse(nameOf(model.driver), model.driver.tool) : null;
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
        () => model.say('info', text.taking.asked(nameOf(driver), driver.tool)),
        (error: unknown) => model.say('error', errorWords(error)),
      );
    };
    model.say('warning', why, { action: { words: text.taking.ask(nameOf(driver)), press: ask } });
  }
}
