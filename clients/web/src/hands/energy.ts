// SPDX-License-Identifier: GPL-3.0-or-later
// Turns energy on while something is held: a key, a button, a trigger, a finger, or the latch (Keep on), which holds for
// at most some seconds. Releasing everything turns energy off. If energy goes off while something is held, the page says
// so at once and says how to continue. Energy then comes back only by a new press.
//
// The enable tells the daemon the limit of the latch, so the daemon ends it even if this page fails. The page never
// enables energy without a press.
import type { Control } from '../model/control';
import type { Model } from '../model/model';
import { nameOf } from '../model/person';
import { text } from '../text/text';
import type { ToolState } from '../wire/records';
import type { Frame } from '../wire/worker_messages';
import { errorWords } from '../model/sentences';
import { LATCH, type Holds, type Lost } from './holds';

const KEY = 'energy';
/** Limit of the latch in simulated seconds: enough for a long cut, short if the user forgets it. */
export const LATCH_S = 15;

type State = 'off' | 'asked' | 'on' | 'lost';

export class Energy {
  private state: State = 'off';
  private tool: string | null = null;
  /** number of enables, which distinguishes a late answer to an earlier enable */
  private enables = 0;
  /** epoch and tick at which the last enable took effect */
  private since: { epoch: string; tick: number } | null = null;
  /** limit of the last enable in ticks; null: no limit */
  private limit: number | null = null;

  constructor(
    private readonly model: Model,
    private readonly control: Control,
    private readonly sequence: () => number,
    private readonly holds: Holds,
    /** called when the latch has ended by itself */
    private readonly ended: () => void,
  ) {
    model.on('frame', (frame) => this.check(frame));
    model.on('link', (link) => {
      if (link.state !== 'online') this.lose(text.energy.noConnection);
    });
    model.on('tools', () => this.checkDriver());
  }

  /** Whether something is held that should keep energy on. */
  get wanted(): boolean {
    return this.holds.held;
  }

  /** Whether energy was requested and, as far as this page knows, has not gone off since. */
  get alive(): boolean {
    return this.state === 'asked' || this.state === 'on';
  }

  get latched(): boolean {
    return this.holds.latched;
  }

  /** Returns the simulated seconds until the latch ends. */
  get latchedForS(): number {
    const { limit, since, model } = this;
    return limit !== null && since && model.frame ? Math.max(0, (since.tick + limit - model.frame.tick) * this.stepS) : LATCH_S;
  }

  /** Turns energy on if something is held. `fresh`: it was just pressed, which also ends a loss of energy. */
  enable(tool: string, fresh: boolean): void {
    if (!this.wanted || this.alive || (this.state === 'lost' && !fresh)) return;
    this.state = 'asked';
    this.tool = tool;
    this.since = null;
    this.model.unsay(KEY);
    if (this.model.frame?.paused) {
      this.lose(text.energy.paused);
      return;
    }
    this.ask(tool);
    this.model.emit('tools', undefined);
  }

  /** Applies the limit of the latch to energy that is already on, because the latch was also pressed. */
  limitByLatch(): void {
    if (this.tool !== null && this.alive && this.latched) this.ask(this.tool);
  }

  /** Turns energy off, because nothing is held any more. Explains an end without a release. */
  off(why: Lost): void {
    const had = this.alive;
    this.end();
    if (had && why !== 'released') this.model.say('warning', text.energy.off(text.energy.letGo[why]));
  }

  private get stepS(): number {
    return this.model.summary?.step_s ?? 1 / 60;
  }

  private ask(tool: string): void {
    const epoch = this.model.frame?.epoch ?? '';
    const enable = ++this.enables;
    this.limit = this.latched ? Math.round(LATCH_S / this.stepS) : null;
    const ticks = this.limit === null ? {} : { ticks: this.limit };
    this.control.call('tool.energize', { tool, sequence: this.sequence(), energized: true, ...ticks }).then(
      ({ tick }) => {
        if (enable === this.enables) this.since = { epoch, tick };
      },
      (error: unknown) => {
        if (enable === this.enables) this.lose(error instanceof Error ? error.message : String(error));
      },
    );
  }

  private end(): void {
    const { tool, state } = this;
    this.model.unsay(KEY);
    this.state = 'off';
    this.since = null;
    this.limit = null;
    this.tool = null;
    if (tool === null || state === 'off') return;
    // Off is also sent after a loss, in case an enable is still under way, but never to the tool of another driver.
    if (!this.model.drives(tool)) return;
    this.control.call('tool.energize', { tool, sequence: this.sequence(), energized: false }).catch((error: unknown) => {
      if (state !== 'lost') this.model.say('warning', errorWords(error));
    });
    this.model.emit('tools', undefined);
  }

  /** Checks in the newest frame whether the energy that is held is on. */
  private check(frame: Frame): void {
    if (!this.alive || this.since === null) return;
    const state = frame.tools.find(({ name }) => name === this.tool);
    if (frame.epoch !== this.since.epoch) this.lose(text.energy.lost.restored);
    else if (state?.energized) this.state = 'on';
    else if (frame.paused) this.lose(text.energy.paused);
    else if (frame.tick > this.since.tick) this.wentDark(frame, state);
  }

  private wentDark(frame: Frame, state: ToolState | undefined): void {
    const over = state?.energyOff === 'commanded' && this.limit !== null && frame.tick >= this.since!.tick + this.limit;
    this.lose(over ? text.energy.latchOver(LATCH_S) : this.reason(state));
  }

  /** Returns the reason why energy went off. If it never came on, the frame has only the reason of an earlier time. */
  private reason(state: ToolState | undefined): string {
    if (!state) return text.energy.removed;
    if (this.state === 'asked' && state.energyOff !== 'watchdog') return text.energy.lost.never_enabled;
    return text.energy.lost[state.energyOff];
  }

  private checkDriver(): void {
    if (!this.alive || this.tool === null || this.model.link.state !== 'online') return;
    const driver = this.model.drivers.get(this.tool);
    if (!driver) this.lose(text.energy.removed);
    else if (driver.client === 0) this.lose(text.energy.noDriver);
    else if (!this.model.drives(this.tool)) this.lose(text.energy.takenOver(nameOf(driver)));
  }

  private lose(why: string): void {
    if (!this.alive) return;
    this.state = 'lost';
    this.enables++;
    const [by] = this.holds.by;
    this.holds.take({ type: 'release', id: LATCH });
    if (!this.wanted) {
      this.end();
      this.ended();
    }
    // The message stays while something is held. A latch has ended with its energy.
    this.model.say('warning', text.energy.offUntil(why, by ? text.energy.again[by] : text.energy.againWithoutHold), this.wanted ? { key: KEY } : {});
    this.model.emit('tools', undefined);
  }
}
