// SPDX-License-Identifier: GPL-3.0-or-later
// Handles the gamepad, and keys while the picture has the focus or no element has it. KEY_HELP lists their effects.
import type { Viewport } from '../scene/viewport';
import { text } from '../text/text';
import { LATCH_S } from './energy';
import { Pad } from './gamepad';
import { keyId } from './holds';
import type { ToolHand } from './tool_hand';

export const KEY_HELP = text.keys.help(LATCH_S);

const SPEED_M_S = 0.03;
const TURN_RAD_S = 1.2;
const ZOOM_PER_S = 2.5;
const PAD_SPEED = 1.5; // times the speed of the keys

const TRIGGER = 'trigger';

/** Keys that work as long as they are held. */
const HELD = new Set([
  'ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown', 'KeyW', 'KeyS', 'KeyQ', 'KeyE', 'KeyR', 'KeyF', 'Equal', 'Minus',
  'NumpadAdd', 'NumpadSubtract',
]);

/** All keys that this page uses. */
export const WORKING_KEYS: ReadonlySet<string> = new Set([...HELD, 'Space', 'KeyG', 'KeyH', 'KeyL']);

export class Keys {
  private readonly down = new Set<string>();
  private readonly pad: Pad;
  /** motion of the present animation frame, metres and radians */
  private step = 0;
  private turn = 0;
  private last = performance.now();

  constructor(
    canvas: HTMLCanvasElement,
    private readonly viewport: Viewport,
    private readonly hand: ToolHand,
    private readonly grasping: () => boolean,
  ) {
    // In a page that was just loaded no element has the focus: keys must work then, too.
    const meant = (event: KeyboardEvent): boolean => event.target === canvas || event.target === document.body;
    window.addEventListener('keydown', (event) => meant(event) && this.press(event));
    window.addEventListener('keyup', (event) => this.down.delete(event.code));
    canvas.addEventListener('blur', () => this.down.clear());
    window.addEventListener('blur', () => this.down.clear());
    this.pad = new Pad({
      lead: (right, up, nearer, turn) => {
        const step = PAD_SPEED * this.step;
        this.apply(right * step, up * step, nearer * step, turn * this.turn, 0);
      },
      hold: () => hand.take({ type: 'press', by: 'trigger', id: TRIGGER, place: null, ripe: true }),
      letGo: (unplugged) => hand.take({ type: 'release', id: TRIGGER, why: unplugged ? 'unplugged' : 'released' }),
      grasp: () => hand.jaws.grasp(!grasping()),
    });
  }

  /** Applies held keys and sticks; called once per animation frame. */
  advance(): void {
    const now = performance.now();
    const seconds = Math.min((now - this.last) / 1000, 0.1);
    this.last = now;
    const axis = (less: string, more: string): number => Number(this.down.has(more)) - Number(this.down.has(less));
    const step = (this.step = SPEED_M_S * seconds);
    const turn = (this.turn = TURN_RAD_S * seconds);
    this.apply(
      axis('ArrowLeft', 'ArrowRight') * step,
      axis('ArrowDown', 'ArrowUp') * step,
      axis('KeyW', 'KeyS') * step,
      axis('KeyQ', 'KeyE') * turn,
      axis('KeyR', 'KeyF') * turn,
    );
    const zoom = axis('Equal', 'Minus') + axis('NumpadAdd', 'NumpadSubtract');
    if (zoom !== 0) {
      this.viewport.orbit.zoom(ZOOM_PER_S ** (zoom * seconds));
      this.viewport.invalidate();
    }
    this.pad.advance();
  }

  private apply(right: number, up: number, nearer: number, turn: number, tilt: number): void {
    if (right !== 0 || up !== 0 || nearer !== 0) this.hand.nudge(right, up, nearer);
    if (turn !== 0 || tilt !== 0) this.hand.turn(turn, tilt);
  }

  private press(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (HELD.has(event.code)) {
      this.down.add(event.code);
    } else if (event.repeat) {
      if (event.code !== 'Space') return;
    } else if (event.code === 'Space') {
      this.hand.take({ type: 'press', by: 'space', id: keyId('Space'), place: 'picture', ripe: true });
    } else if (event.code === 'KeyL') {
      this.hand.latch();
    } else if (event.code === 'KeyG') {
      this.hand.jaws.grasp(!this.grasping());
    } else if (event.code === 'KeyH') {
      this.viewport.orbit.reset();
      this.viewport.invalidate();
    } else {
      return;
    }
    event.preventDefault();
  }
}
