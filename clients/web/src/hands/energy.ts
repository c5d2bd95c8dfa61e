// SPDX-License-Identifier: GPL-3.0-or-later
// Energy while something is held: a key, a button, a trigger, a finger. There is no latch: who lets go of
// everything has switched off. What was held and went dark all the same is said at once, with what brings
// it back, and comes back only by a fresh press.
import type { Control } from '../model/control';
import type { Model } from '../model/model';
import { nameOf } from '../model/person';
import type { EnergyOff, ToolState } from '../wire/records';
import type { Frame } from '../wire/worker_messages';
import { errorWords } from '../model/sentences';

/** What can be held, and how to hold it anew. */
export type Held = 'space' | 'button' | 'trigger' | 'pointer' | 'pedal' | 'cap';
const AGAIN: Readonly<Record<Held, string>> = {
  space: 'Let go of Space and press it again.',
  button: 'Let go of Energy and press it again.',
  trigger: 'Let go of the trigger and pull it again.',
  pointer: 'Lift and press again.',
  pedal: 'Lift the pedal and press it again.',
  cap: 'Let go of the 3D mouse’s button and press it again.',
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

type State = 'off' | 'asked' | 'on' | 'lost';

export class Energy {
  private readonly held = new Set<Held>();
  private state: State = 'off';
  private tool: string | null = null;
  /** counts enables, so that a late answer to an earlier one is told from that to the last */
  private enables = 0;
  /** where the last enable took effect */
  private since: { epoch: string; tick: number } | null = null;

  constructor(
    private readonly model: Model,
    private readonly control: Control,
    private readonly sequence: () => number,
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

  hold(by: Held): void {
    if (this.held.has(by)) return;
    this.held.add(by);
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
    this.model.emit('tools', undefined);
  }

  release(by: Held): void {
    if (!this.held.delete(by) || this.wanted) return;
    this.off();
  }

  /** Everything is let go at once: the page is out of sight, or another tool is in hand. */
  releaseAll(): boolean {
    const had = this.alive;
    this.held.clear();
    this.off();
    return had;
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
    else if (frame.tick > this.since.tick) this.lose(this.reason(state));
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
    this.model.say('warning', `Energy is off: ${why}. ${by ? AGAIN[by] : 'Press again.'}`, { key: KEY });
    this.model.emit('tools', undefined);
  }
}
