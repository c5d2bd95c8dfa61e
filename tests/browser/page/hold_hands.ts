// SPDX-License-Identifier: GPL-3.0-or-later
// Abilities of a browser that the tests of holds need: real input if the browser can produce it, and functions that run in
// the page. One implementation drives Chromium, another drives Firefox.

export interface Point {
  x: number;
  y: number;
}

export type Pointing = 'mouse' | 'pen' | 'touch';

export interface HoldHands {
  evaluate<A, R>(work: (argument: A) => R, argument: A): Promise<R>;
  /** Presses a button of a pointer. A finger has only one button. Held buttons stay held. */
  down(kind: Pointing, at: Point, button?: 0 | 2): Promise<void>;
  up(kind: Pointing, button?: 0 | 2): Promise<void>;
  /** Moves a pointer by a pixel. Its pressed buttons stay pressed. */
  move(kind: Pointing): Promise<void>;
  /** Makes the browser take the pointer over. */
  cancel(kind: Pointing): Promise<void>;
  secondFinger(at: Point): Promise<void>;
  keyDown(key: string): Promise<void>;
  keyUp(key: string): Promise<void>;
  end(): Promise<void>;
}

/** In the page: values that tests read and change there. */
export interface HoldPage {
  /** time of the first event since this was last set to null, ms since 1970 */
  at: number | null;
  /** id of the pointer of the last press */
  pointerId: number;
  pad: { connected: boolean; buttons: { pressed: boolean; value: number }[] } | null;
  /** sends a report of the 3D mouse; unplug() removes it */
  cap(values: number[]): void;
  unplug(): void;
  /** restores the parts that a test took out of the page */
  undo: (() => void) | null;
}

declare global {
  interface Window {
    holds: HoldPage;
  }
}

/**
 * In the page, before its scripts: notes when input arrives, and holds a gamepad and a 3D mouse. The page gets no
 * WebGL: input is what is tested, and a picture drawn in software makes each pair take four times as long.
 */
export function prepareHolds(): void {
  if (window.holds) return;
  const device = Object.assign(new EventTarget(), { productName: 'Test SpaceMouse', opened: true, open: () => Promise.resolve() });
  const hid = Object.assign(new EventTarget(), { getDevices: () => Promise.resolve([device]), requestDevice: () => Promise.resolve([device]) });
  Object.defineProperty(navigator, 'hid', { value: hid });
  const holds: HoldPage = {
    at: null,
    pointerId: -1,
    pad: null,
    undo: null,
    cap: (values) => {
      const data = new DataView(Uint8Array.from(values).buffer);
      device.dispatchEvent(Object.assign(new Event('inputreport'), { reportId: 3, data }));
    },
    unplug: () => {
      hid.dispatchEvent(Object.assign(new Event('disconnect'), { device }));
      // the device's button is still down, so this is not a new press
      hid.dispatchEvent(Object.assign(new Event('connect'), { device }));
      holds.cap([1]);
    },
  };
  HTMLCanvasElement.prototype.getContext = () => null;
  navigator.getGamepads = () => [holds.pad as unknown as Gamepad];
  const note = (event: Event): void => {
    holds.at ??= performance.timeOrigin + performance.now();
    if (event.type === 'pointerdown') holds.pointerId = (event as PointerEvent).pointerId;
  };
  for (const type of ['pointerdown', 'pointermove', 'pointerup', 'pointercancel', 'lostpointercapture', 'keydown', 'keyup', 'blur', 'contextmenu'])
    window.addEventListener(type, note, { capture: true });
  window.holds = holds;
  localStorage.setItem('mode', 'operate');
  localStorage.setItem('pedal', 'F9');
}
