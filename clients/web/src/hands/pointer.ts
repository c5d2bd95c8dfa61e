// SPDX-License-Identifier: GPL-3.0-or-later
// Mouse, pen and fingers on the picture. One pointer moves the tool (or turns the camera), the right
// button turns it, the middle one or Shift moves it; two fingers turn, pinch for depth or zoom.
import type { Viewport } from '../scene/viewport';
import type { ToolHand } from './tool_hand';

interface Finger {
  x: number;
  y: number;
}

type Drag = 'tool' | 'turn' | 'pan' | 'none';

const TURN_RAD = 3.4; // for a drag over the picture's height
const WHEEL_DEPTH_M = 0.0005; // a notch
const WHEEL_ZOOM = 1.1;
const NOTCH = 100; // deltaY of one
const PINCH_DEPTH_M = 0.02; // for a pinch over the picture's height

export class Pointer {
  /** one pointer turns the camera instead of moving the tool */
  cameraMode = false;
  private readonly fingers = new Map<number, Finger>();
  private drag: Drag = 'none';

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly viewport: Viewport,
    private readonly hand: ToolHand,
  ) {
    canvas.addEventListener('pointerdown', (event) => this.down(event));
    canvas.addEventListener('pointermove', (event) => this.move(event));
    for (const end of ['pointerup', 'pointercancel'] as const) canvas.addEventListener(end, (event) => this.up(event));
    canvas.addEventListener('wheel', (event) => this.wheel(event), { passive: false });
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
  }

  private down(event: PointerEvent): void {
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(event.pointerId);
    this.fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (this.fingers.size > 1) {
      this.drag = 'none';
      return;
    }
    const right = event.button === 2;
    const middle = event.button === 1 || event.shiftKey;
    this.drag = middle ? 'pan' : right || this.cameraMode ? 'turn' : 'tool';
    if (this.drag === 'tool' && !this.point(event)) this.drag = 'turn';
  }

  private move(event: PointerEvent): void {
    const finger = this.fingers.get(event.pointerId);
    if (!finger) return;
    const height = this.canvas.clientHeight;
    const dx = (event.clientX - finger.x) / height;
    const dy = (event.clientY - finger.y) / height;
    if (this.fingers.size === 2) {
      this.twoFingers(finger, dx, dy);
    } else if (this.drag === 'tool') {
      this.point(event);
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
    if (this.fingers.size === 0) this.drag = 'none';
  }

  /** Each finger's share of the common motion turns; its share of the pinch is depth or zoom. */
  private twoFingers(moving: Finger, dx: number, dy: number): void {
    const other = [...this.fingers.values()].find((finger) => finger !== moving);
    if (!other) return;
    const height = this.canvas.clientHeight;
    const before = Math.hypot(moving.x - other.x, moving.y - other.y);
    const after = Math.hypot(moving.x + dx * height - other.x, moving.y + dy * height - other.y);
    this.viewport.orbit.turn((-TURN_RAD * dx) / 2, (TURN_RAD * dy) / 2);
    if (this.cameraMode) this.viewport.orbit.zoom(before / Math.max(after, 1));
    else this.hand.nudge(0, 0, (-PINCH_DEPTH_M * (after - before)) / height);
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    const notches = Math.min(Math.max(event.deltaY / NOTCH, -3), 3);
    if (this.cameraMode || event.ctrlKey || event.shiftKey) this.viewport.orbit.zoom(WHEEL_ZOOM ** notches);
    else this.hand.nudge(0, 0, WHEEL_DEPTH_M * notches);
    this.viewport.invalidate();
  }

  private point(event: PointerEvent): boolean {
    const box = this.canvas.getBoundingClientRect();
    const x = (2 * (event.clientX - box.left)) / box.width - 1;
    const y = 1 - (2 * (event.clientY - box.top)) / box.height;
    return this.hand.pointAt(x, y);
  }
}
