// SPDX-License-Identifier: GPL-3.0-or-later
// Mouse, pen and fingers on the picture. A hovering mouse moves the tool; a press on the tissue works there. Beside the
// tissue a press turns the camera, and the right button turns it everywhere. The middle button or Shift moves the
// camera. Two fingers turn the camera; a pinch changes depth or zoom.
import type { Viewport } from '../scene/viewport';
import { pointerId } from './holds';
import type { PinBrush } from './pin_brush';
import type { Ruler } from './ruler';
import type { ToolHand } from './tool_hand';

/** What a press on the tissue does. */
export type Press = 'work' | 'move' | 'look' | 'measure' | 'pin';

interface Finger {
  x: number;
  y: number;
}

type Drag = 'tool' | 'turn' | 'pan' | 'ruler' | 'pins' | 'none';

const TURN_RAD = 3.4; // turn for a drag over the height of the picture
const WHEEL_DEPTH_M = 0.0005; // for each notch of the wheel
const WHEEL_ZOOM = 1.1;
const NOTCH = 100; // deltaY of one notch
const PINCH_DEPTH_M = 0.02; // for a pinch over the height of the picture
/** Time in which a second finger may follow, before energy may come on. */
const FINGER_MS = 120;

export class Pointer {
  press: Press = 'work';
  /** last position of a pointer in the page, CSS pixels; null: no pointer yet */
  last: { x: number; y: number } | null = null;
  private readonly fingers = new Map<number, Finger>();
  private drag: Drag = 'none';

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly viewport: Viewport,
    private readonly hand: ToolHand,
    private readonly ruler: Ruler,
    private readonly pins: PinBrush,
  ) {
    canvas.addEventListener('pointerdown', (event) => this.down(event));
    canvas.addEventListener('pointermove', (event) => this.move(event));
    for (const end of ['pointerup', 'pointercancel', 'lostpointercapture'] as const) canvas.addEventListener(end, (event) => this.up(event));
    canvas.addEventListener('wheel', (event) => this.wheel(event), { passive: false });
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    window.addEventListener('blur', () => {
      this.fingers.clear(); // this page may miss their release
      this.drag = 'none';
    });
  }

  private down(event: PointerEvent): void {
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(event.pointerId);
    this.fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    this.last = { x: event.clientX, y: event.clientY };
    if (this.fingers.size > 1) {
      this.drag = 'none';
      return;
    }
    this.drag = this.dragOf(event);
    const { x, y } = this.place(event);
    if (this.drag === 'ruler') this.ruler.begin(x, y);
    if (this.drag === 'pins') this.pins.begin(x, y);
    if (this.drag !== 'tool') return;
    this.hand.press();
    if (!this.hand.pointAt(x, y)) this.drag = 'none';
    else if (this.press === 'work') this.hold(event);
  }

  private hold({ pointerId: pointer, pointerType, button }: PointerEvent): void {
    if (button !== 0) return;
    const id = pointerId(pointer);
    const finger = pointerType === 'touch';
    this.hand.take({ type: 'press', by: 'pointer', id, place: 'picture', ripe: !finger });
    if (finger) setTimeout(() => this.hand.take({ type: 'ripe', id }), FINGER_MS);
  }

  private dragOf(event: PointerEvent): Drag {
    if (event.button === 1 || event.shiftKey) return 'pan';
    const { x, y } = this.place(event);
    if (event.button === 2 || this.press === 'look' || !this.hand.overTissue(x, y)) return 'turn';
    if (this.press === 'pin') return 'pins';
    return this.press === 'measure' ? 'ruler' : 'tool';
  }

  private move(event: PointerEvent): void {
    this.last = { x: event.clientX, y: event.clientY };
    const finger = this.fingers.get(event.pointerId);
    if (!finger) {
      const { x, y } = this.place(event);
      if (event.pointerType !== 'touch' && this.leads && this.fingers.size === 0) this.hand.hover(x, y);
      return;
    }
    const height = this.canvas.clientHeight;
    const dx = (event.clientX - finger.x) / height;
    const dy = (event.clientY - finger.y) / height;
    if (this.fingers.size === 2) {
      this.twoFingers(finger, dx, dy);
    } else if (this.drag === 'tool') {
      this.lead(event);
    } else if (this.drag === 'ruler') {
      const { x, y } = this.place(event);
      this.ruler.reach(x, y);
    } else if (this.drag === 'pins') {
      const { x, y } = this.place(event);
      this.pins.reach(x, y);
    } else if (this.drag === 'turn') {
      this.viewport.orbit.turn(-TURN_RAD * dx, TURN_RAD * dy);
    } else if (this.drag === 'pan') {
      this.viewport.orbit.pan(dx, -dy);
    }
    finger.x = event.clientX;
    finger.y = event.clientY;
    this.viewport.invalidate();
  }

  private up(event: PointerEvent): void {
    this.fingers.delete(event.pointerId);
    this.drag = 'none';
  }

  /** Leads the tool along all positions that the browser has gathered since the last event. */
  private lead(event: PointerEvent): void {
    const passed = event.getCoalescedEvents();
    for (const one of passed.length > 0 ? passed : [event]) {
      const { x, y } = this.place(one);
      this.hand.pointAt(x, y);
    }
  }

  /** Handles the motion of one of two fingers: the common motion turns the camera, the pinch changes depth or zoom. */
  private twoFingers(moving: Finger, dx: number, dy: number): void {
    const other = [...this.fingers.values()].find((finger) => finger !== moving);
    if (!other) return;
    const height = this.canvas.clientHeight;
    const before = Math.hypot(moving.x - other.x, moving.y - other.y);
    const after = Math.hypot(moving.x + dx * height - other.x, moving.y + dy * height - other.y);
    this.viewport.orbit.turn((-TURN_RAD * dx) / 2, (TURN_RAD * dy) / 2);
    if (this.leadsTool) this.hand.nudge(0, 0, (-PINCH_DEPTH_M * (after - before)) / height);
    else this.viewport.orbit.zoom(before / Math.max(after, 1));
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    const notches = Math.min(Math.max(event.deltaY / NOTCH, -3), 3);
    if (!this.leadsTool || event.ctrlKey || event.shiftKey) this.viewport.orbit.zoom(WHEEL_ZOOM ** notches);
    else this.hand.nudge(0, 0, WHEEL_DEPTH_M * notches);
    this.viewport.invalidate();
  }

  /** Whether wheel and pinch change the depth of the tool in hand; otherwise they zoom. */
  private get leadsTool(): boolean {
    return this.leads && this.hand.driving;
  }

  /** Whether pointing moves the tool. */
  private get leads(): boolean {
    return this.press === 'work' || this.press === 'move';
  }

  private place(event: PointerEvent): { x: number; y: number } {
    const box = this.canvas.getBoundingClientRect();
    return { x: (2 * (event.clientX - box.left)) / box.width - 1, y: 1 - (2 * (event.clientY - box.top)) / box.height };
  }
}
