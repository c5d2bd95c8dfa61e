// SPDX-License-Identifier: GPL-3.0-or-later
// A gamepad with the standard mapping: the sticks move the tool, the right trigger turns energy on, A grasps.
// Browsers report no presses of gamepads as events, so the trigger is read fifty times a second. A trigger
// counts only after it was seen at rest: one that is held while the pad is plugged in, or while the page comes
// to the front, does nothing.

const POLL_MS = 20;
const PULLED = 0.5;
const STICK_REST = 0.12;
const A = 0, RIGHT_TRIGGER = 7;

export interface LedByPad {
  /** deflections, -1 to 1: right, up, nearer to the eye, and turn about the shaft */
  lead(right: number, up: number, nearer: number, turn: number): void;
  hold(): void;
  letGo(unplugged: boolean): void;
  grasp(): void;
}

export class Pad {
  /** index of the gamepad in use; null: none */
  private index: number | null = null;
  /** whether the trigger was at rest since the gamepad was connected or the page came to the front */
  private rested = false;
  private pulled = false;
  private grasped = false;

  constructor(private readonly led: LedByPad) {
    setInterval(() => this.read(), POLL_MS);
    window.addEventListener('gamepaddisconnected', () => this.lose());
  }

  /** Applies the sticks; called once per animation frame. */
  advance(): void {
    const pad = this.find();
    if (!pad) return;
    const stick = (i: number): number => (Math.abs(pad.axes[i]) > STICK_REST ? pad.axes[i] : 0);
    this.led.lead(stick(0), -stick(1), stick(3), stick(2));
  }

  private find(): Gamepad | null {
    return navigator.getGamepads().find((pad) => pad?.mapping === 'standard' && pad.connected) ?? null;
  }

  private read(): void {
    const pad = this.find();
    if ((pad?.index ?? null) !== this.index) this.lose();
    this.index = pad?.index ?? null;
    if (!document.hasFocus() || document.hidden) this.rested = false;
    if (!pad) return;
    this.readTrigger(pad.buttons[RIGHT_TRIGGER].value > PULLED);
    const grasped = pad.buttons[A].pressed;
    if (grasped && !this.grasped) this.led.grasp();
    this.grasped = grasped;
  }

  private readTrigger(pulled: boolean): void {
    if (!pulled && this.pulled) this.led.letGo(false);
    else if (pulled && !this.pulled && this.rested) this.led.hold();
    this.pulled = pulled;
    this.rested = !pulled && document.hasFocus() && !document.hidden;
  }

  private lose(): void {
    this.rested = this.pulled = this.grasped = false;
    this.led.letGo(true);
  }
}
