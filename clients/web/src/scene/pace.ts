// SPDX-License-Identifier: GPL-3.0-or-later
// Keeps the page responsive if drawing is slow. A new picture is ordered only when the last one is finished, so that the
// main thread never waits for it. Detail is reduced until pictures take less than a twentieth of a second. After a slower
// picture, drawing pauses as long as the picture took, up to a fifth of a second: the processor draws such pictures, and
// half of its time is left to the page and the machine.

/** Level of detail of a picture. */
export interface Detail {
  /** resolution of the picture over that of the screen */
  scale: number;
  /** whether each pixel has several samples, which smooth edges */
  smooth: boolean;
}

const SLOW_MS = 50;
const REST_MS = 200; // longest pause after a slow picture
const QUICK_MS = 12;
/** Steps of detail. Samples are reduced first: without a graphics card they are more than half of the cost of a picture. */
export const STEPS: readonly Detail[] = [
  { scale: 1, smooth: true },
  { scale: 1, smooth: false },
  { scale: 0.75, smooth: false },
  { scale: 0.55, smooth: false },
  { scale: 0.4, smooth: false },
];
export const FULL = STEPS[0];
const PATIENCE = 12; // pictures before the detail changes; a far too slow picture counts as several
const FAR = 4; // a picture that is this many times too slow counts as this many, and detail falls by two steps

export class Pace {
  private fence: WebGLSync | null = null;
  private started = 0;
  private restsUntil = 0;
  private level = 0;
  private slow = 0;
  private quick = 0;
  private held = false;
  /** time of the last picture from the order until it was finished, ms */
  pictureMs = 0;

  constructor(
    private readonly gl: WebGL2RenderingContext,
    private readonly setDetail: (detail: Detail) => void,
  ) {}

  /** Whether drawing is slow on this machine: pictures take long, or detail was reduced. */
  get laboured(): boolean {
    return this.level > 0 || this.pictureMs > SLOW_MS;
  }

  /** Whether the last picture is finished and the pause is over; called once per animation frame. */
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

  /** Keeps full detail while `held`, however long pictures take; for pictures that are saved. */
  holdFull(held: boolean): void {
    this.held = held;
    if (held && this.level > 0) this.change(-this.level);
  }

  /** Starts again after the graphics context was restored, because old fences never complete. */
  reset(): void {
    this.fence = null;
  }

  /** Notes that the drawing commands of a picture were given. */
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
    // Raising the detail waits ten times as long, because flickering between two levels is worse.
    else if (this.quick >= 10 * PATIENCE && this.level > 0) this.change(-1);
  }

  private change(by: number): void {
    this.level += by;
    this.slow = this.quick = 0;
    this.setDetail(STEPS[this.level]);
  }
}
