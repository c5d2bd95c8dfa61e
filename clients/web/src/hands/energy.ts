// SPDX-License-Identifier: GPL-3.0-or-later
// Energy while something is held: a key, a button, a trigger, a finger; or a latch, which holds for some
// seconds at most. Who lets go of everything has switched off. What was held and went dark all the same is
// said at once, with what brings it back, and comes back only by a fresh press.
//
// The latch's limit is the daemon's: with the latch goes an order to switch off at a later tick, which the
// daemon keeps whatever becomes of this page. Such an order cannot be taken back. One whose latch has ended
// before may darken what was pressed since; that alone is switched on again by itself.
import type { Control } from '../model/control';
import type { Model } from '../model/model';
import { nameOf } from '../model/person';
import type { EnergyOff, ToolState } from '../wire/records';
import type { Frame } from '../wire/worker_messages';
import { errorWords } from '../model/sentences';

/** What can be held, and how to hold it anew. */
export type Held = 'space' | 'button' | 'trigger' | 'pointer' | 'pedal' | 'cap' | 'latch';
const AGAIN: Readonly<Record<Held, string>> = {
  space: 'Let go of Space and press it again.',
  button: 'Let go of Energy and press it again.',
  trigger: 'Let go of the trigger and pull it again.',
  pointer: 'Lift and press again.',
  pedal: 'Lift the pedal and press it again.',
  cap: 'Let go of the 3D mouse’s button and press it again.',
  latch: 'Press Keep on for more.',
};
const LOST_WORDS: Readonly<Record<EnergyOff, string>> = {
  watchdog: 'the simulation heard nothing from this page in time, which a busy machine can cause',
  taken_over: 'somebody else took the tool over',
  restored: 'the session went back in time or was restarted',
  never_enabled: 'the simulation cut it before it came on',
  commanded: 'somebody switched it off',
};
const PAUSED = 'the session is paused';
const KEY = 'energy';
/** Simulated seconds, in which heat does what it does: a long cut of a hand, not one that was forgotten. */
export const LATCH_S = 15;

/** An order to switch off that waits at the daemon. */
interface Limit {
  session: string | null;
  tool: string;
  tick: number;
}

type State = 'off' | 'asked' | 'on' | 'lost';

export class Energy {
  private readonly held = new Set<Held>();
  private state: State = 'off';
  private tool: string | null = null;
  /** counts enables, so that a late answer to an earlier one is told from that to the last */
  private enables = 0;
  /** where the last enable took effect */
  private since: { epoch: string; tick: number } | null = null;
  /** of the latch that is on */
  private limit: Limit | null = null;
  /** of latches that ended before */
  private stale: Limit[] = [];

  constructor(
    private readonly model: Model,
    private readonly control: Control,
    private readonly sequence: () => number,
    /** told when nothing holds any more although nobody let go: a latch has ended */
    private readonly ended: () => void,
  ) {
    model.on('frame', (frame) => this.check(frame));
    model.on('link', (link) => {
      if (link.state !== 'online') this.lose('the connection was lost');
    });
    model.on('tools', () => this.checkDriver());
  }

  /** Something is held that should keep energy on. */
  get wanted(): boolean {
    return this.held.size > 0;
  }

  /** Energy was asked for and, as far as this page knows, not cut since. */
  get alive(): boolean {
    return this.state === 'asked' || this.state === 'on';
  }

  get latched(): boolean {
    return this.held.has('latch');
  }

  /** Simulated seconds until the latch ends. */
  get latchedForS(): number {
    const { limit, model } = this;
    return limit && model.frame ? Math.max(0, (limit.tick - model.frame.tick) * this.stepS) : LATCH_S;
  }

  hold(by: Held): void {
    if (this.held.has(by)) return;
    this.held.add(by);
    if (by === 'latch' && this.alive) this.setLimit();
  }

  /** Switches on if something is held; `fresh`: it has just been pressed, which also brings back what was cut. */
  enable(tool: string, fresh: boolean): void {
    if (!this.wanted || this.alive || (this.state === 'lost' && !fresh)) return;
    this.state = 'asked';
    this.tool = tool;
    this.since = null;
    this.model.unsay(KEY);
    if (this.model.frame?.paused) {
      this.lose(PAUSED);
      return;
    }
    const epoch = this.model.frame?.epoch ?? '';
    const enable = ++this.enables;
    this.control.call('tool.energize', { tool, sequence: this.sequence(), energized: true }).then(
      ({ tick }) => {
        if (enable === this.enables) this.since = { epoch, tick };
      },
      (error: unknown) => {
        if (enable === this.enables) this.lose(error instanceof Error ? error.message : String(error));
      },
    );
    if (this.latched) this.setLimit();
    this.model.emit('tools', undefined);
  }

  release(by: Held): void {
    if (!this.held.delete(by)) return;
    if (by === 'latch') this.forgetLimit();
    if (!this.wanted) this.off();
    else this.model.emit('tools', undefined);
  }

  /** Everything is let go at once: the page is out of sight, or another tool is in hand. */
  releaseAll(): boolean {
    const had = this.alive;
    this.held.clear();
    this.forgetLimit();
    this.off();
    return had;
  }

  private get stepS(): number {
    return this.model.summary?.step_s ?? 1 / 60;
  }

  /** Has the daemon switch off when the latch's time is up. */
  private setLimit(): void {
    const { model, tool } = this;
    if (this.limit || tool === null || !model.frame) return;
    const tick = model.frame.tick + Math.round(LATCH_S / this.stepS);
    this.limit = { session: model.session, tool, tick };
    this.control.call('tool.energize', { tool, sequence: this.sequence(), energized: false, tick }).catch((error: unknown) => {
      if (this.limit?.tick === tick) this.lose(`its limit was not taken: ${errorWords(error)}`);
    });
  }

  /** The latch has ended; its order waits on. */
  private forgetLimit(): void {
    if (this.limit) this.stale.push(this.limit);
    this.limit = null;
  }

  /** Whether it was an order of a latch long ended that has darkened what is held now. */
  private endedByStale({ tick }: Frame): boolean {
    const { since, tool, model } = this;
    const before = this.stale.length;
    const due = (one: Limit): boolean => one.session === model.session && one.tool === tool && one.tick <= tick;
    const hit = this.stale.some((one) => due(one) && since !== null && one.tick > since.tick);
    this.stale = this.stale.filter((one) => !due(one));
    return hit && this.stale.length < before;
  }

  private off(): void {
    const { tool, state } = this;
    this.model.unsay(KEY);
    this.state = 'off';
    this.since = null;
    this.tool = null;
    if (tool === null || state === 'off') return;
    // Off is also said after a loss, should an enable still be under way; but never to somebody else's tool.
    if (!this.model.drives(tool)) return;
    this.control.call('tool.energize', { tool, sequence: this.sequence(), energized: false }).catch((error: unknown) => {
      if (state !== 'lost') this.model.say('warning', errorWords(error));
    });
    this.model.emit('tools', undefined);
  }

  /** The newest frame tells whether energy that is held is on. */
  private check(frame: Frame): void {
    if (!this.alive || this.since === null) return;
    const state = frame.tools.find(({ name }) => name === this.tool);
    if (frame.epoch !== this.since.epoch) this.lose(LOST_WORDS['restored']);
    else if (state?.energized) this.state = 'on';
    else if (frame.paused) this.lose(PAUSED);
    else if (frame.tick > this.since.tick) this.wentDark(frame, state);
  }

  private wentDark(frame: Frame, state: ToolState | undefined): void {
    const commanded = state?.energyOff === 'commanded';
    if (commanded && this.limit && frame.tick >= this.limit.tick) {
      this.limit = null; // it has been carried out
      this.lose(`it stays on for ${LATCH_S} s at most`);
    } else if (commanded && this.endedByStale(frame)) {
      this.state = 'off';
      this.enable(this.tool!, true);
    } else {
      this.lose(this.reason(state));
    }
  }

  /** Frames tell why energy went off; of what never came on they tell only the reason of the time before. */
  private reason(state: ToolState | undefined): string {
    if (!state) return 'the tool was taken away';
    if (this.state === 'asked' && state.energyOff !== 'watchdog') return LOST_WORDS['never_enabled'];
    return LOST_WORDS[state.energyOff];
  }

  private checkDriver(): void {
    if (!this.alive || this.tool === null || this.model.link.state !== 'online') return;
    const driver = this.model.drivers.get(this.tool);
    if (!driver) this.lose('the tool was taken away');
    else if (driver.client === 0) this.lose('nobody drives the tool any more');
    else if (!this.model.drives(this.tool)) this.lose(`${nameOf(driver)} took the tool over`);
  }

  private lose(why: string): void {
    if (!this.alive) return;
    this.state = 'lost';
    this.enables++;
    const [by] = this.held;
    this.held.delete('latch');
    this.forgetLimit();
    if (!this.wanted) {
      this.off();
      this.ended();
    }
    // What is held has its words until it is let go; a latch is gone with its energy.
    this.model.say('warning', `Energy is off: ${why}. ${by ? AGAIN[by] : 'Press again.'}`, this.wanted ? { key: KEY } : {});
    this.model.emit('tools', undefined);
  }
}
