// SPDX-License-Identifier: GPL-3.0-or-later
// Keeps the page quick where drawing is slow: no picture is asked for while the last one is still being
// made, so that the page's own thread never waits for it, and pictures lose detail until they take
// less than a twentieth of a second. After one that took longer it rests as long, up to a fifth of a
// second: such pictures are made by the processor, and half of it is left to the page and the machine.

/** How much there is in a picture. */
export interface Detail {
  /** of the screen's resolution */
  scale: number;
  /** several samples a pixel, which smooth edges */
  smooth: boolean;
}

const SLOW_MS = 50;
const REST_MS = 200; // at most, after a slow picture
const QUICK_MS = 12;
/** Samples go first: in software they are more than half of a picture's cost. */
export const STEPS: readonly Detail[] = [
  { scale: 1, smooth: true },
  { scale: 1, smooth: false },
  { scale: 0.75, smooth: false },
  { scale: 0.55, smooth: false },
  { scale: 0.4, smooth: false },
];
export const FULL = STEPS[0];
const PATIENCE = 12; // pictures before the detail changes; one that is far too slow counts as several
const FAR = 4; // times too slow, or more: such a picture counts as that many, and two steps are taken at once

export class Pace {
  private fence: WebGLSync | null = null;
  private started = 0;
  private restsUntil = 0;
  private level = 0;
  private slow = 0;
  private quick = 0;
  private held = false;
  /** milliseconds of the last picture, from the order until it was there */
  pictureMs = 0;

  constructor(
    private readonly gl: WebGL2RenderingContext,
    private readonly setDetail: (detail: Detail) => void,
  ) {}

  /** Whether drawing is work here: pictures take long, or have less detail so that they do not. */
  get laboured(): boolean {
    return this.level > 0 || this.pictureMs > SLOW_MS;
  }

  /** Whether the last picture is there, and its rest over; asked once per animation frame. */
  ready(): boolean {
    if (!this.fence) return performance.now() >= this.restsUntil;
    const status = this.gl.getSyncParameter(this.fence, this.gl.SYNC_STATUS) as number;
    if (status !== this.gl.SIGNALED) return false;
    this.gl.deleteSync(this.fence);
    this.fence = null;
    const now = performance.now();
    this.pictureMs = now - this.started;
    this.restsUntil = this.pictureMs > SLOW_MS ? now + Math.min(this.pictureMs, REST_MS) : now;
    this.adapt();
    return now >= this.restsUntil;
  }

  /** Full detail, however long pictures take, until that is over: for pictures that are kept. */
  holdFull(held: boolean): void {
    this.held = held;
    if (held && this.level > 0) this.change(-this.level);
  }

  /** The graphics came back anew: fences of before never come true. */
  reset(): void {
    this.fence = null;
  }

  /** After the drawing commands of a picture. */
  drawn(started: number): void {
    this.started = started;
    this.fence = this.gl.fenceSync(this.gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    this.gl.flush();
  }

  private adapt(): void {
    if (this.held) return;
    this.slow = this.pictureMs > SLOW_MS ? this.slow + Math.min(this.pictureMs / SLOW_MS, FAR) : 0;
    this.quick = this.pictureMs < QUICK_MS ? this.quick + 1 : 0;
    const last = STEPS.length - 1;
    if (this.slow >= PATIENCE && this.level < last) this.change(Math.min(this.pictureMs > FAR * SLOW_MS ? 2 : 1, last - this.level));
    // Going back up waits ten times as long: a picture that flickers between two looks is worse.
    else if (this.quick >= 10 * PATIENCE && this.level > 0) this.change(-1);
  }

  private change(by: number): void {
    this.level += by;
    this.slow = this.quick = 0;
    this.setDetail(STEPS[this.level]);
  }
}
