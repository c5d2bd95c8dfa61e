// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that slow pictures lose detail, one step after the other, and get it back late.
import { FULL, Pace, STEPS, type Detail } from '../../../../clients/web/src/scene/pace';

const SLOW_MS = 60;
const FAR_TOO_SLOW_MS = 600;
const QUICK_MS = 5;

/** A pace, and pictures that each take some time. */
class Drawing {
  detail: Detail = FULL;
  changes: Detail[] = [];
  now = 0;
  private doneAt = 0;
  private readonly gl = {
    fenceSync: () => ({}),
    flush: () => undefined,
    deleteSync: () => undefined,
    SIGNALED: 1,
    getSyncParameter: () => Number(this.now >= this.doneAt),
  };
  readonly pace = new Pace(this.gl as unknown as WebGL2RenderingContext, (detail) => this.changes.push((this.detail = detail)));

  constructor() {
    vi.spyOn(performance, 'now').mockImplementation(() => this.now);
  }

  /** `ms` returns the time of a picture with its detail */
  draw(pictures: number, ms: (detail: Detail) => number): void {
    for (let i = 0; i < pictures; i++) {
      this.doneAt = this.now + ms(this.detail);
      this.pace.drawn(this.now);
      do this.now++;
      while (!this.pace.ready());
    }
  }
}

afterEach(() => {
  vi.restoreAllMocks();
});

describe('the pace of pictures', () => {
  it('has steps from full detail down, samples first, and never more detail after less', () => {
    expect(FULL).toEqual({ scale: 1, smooth: true });
    expect(STEPS[1]).toEqual({ scale: 1, smooth: false });
    for (let i = 1; i < STEPS.length; i++) {
      expect(STEPS[i].scale).toBeLessThanOrEqual(STEPS[i - 1].scale);
      expect(Number(STEPS[i].smooth)).toBeLessThanOrEqual(Number(STEPS[i - 1].smooth));
    }
  });

  it('keeps full detail while pictures are quick, or slow only now and then', () => {
    const drawing = new Drawing();
    for (let i = 0; i < 100; i++) {
      drawing.draw(5, () => SLOW_MS);
      drawing.draw(1, () => QUICK_MS);
    }
    expect(drawing.changes).toEqual([]);
  });

  it('leaves out samples where that is enough, and no more', () => {
    const drawing = new Drawing();
    drawing.draw(200, ({ smooth }) => (smooth ? SLOW_MS : SLOW_MS / 2));
    expect(drawing.changes).toEqual([STEPS[1]]);
    expect(drawing.pace.laboured).toBe(true);
  });

  it('goes down two steps at once where pictures are far too slow, and stays at the last', () => {
    const drawing = new Drawing();
    drawing.draw(6, () => FAR_TOO_SLOW_MS);
    expect(drawing.changes).toEqual([STEPS[2], STEPS[4]]);
    drawing.draw(100, () => FAR_TOO_SLOW_MS);
    expect(drawing.detail).toBe(STEPS[STEPS.length - 1]);
    expect(drawing.changes).toHaveLength(2);
  });

  it('gets detail back a step at a time, ten times as late, and does not flicker', () => {
    const drawing = new Drawing();
    drawing.draw(20, () => SLOW_MS);
    expect(drawing.detail).toBe(STEPS[1]);
    drawing.draw(119, () => QUICK_MS);
    expect(drawing.detail).toBe(STEPS[1]);
    drawing.draw(1, () => QUICK_MS);
    expect(drawing.detail).toBe(FULL);
    drawing.changes = [];
    // fast enough without `smooth`, but too slow to add it again
    drawing.draw(600, ({ smooth }) => (smooth ? SLOW_MS : SLOW_MS / 3));
    expect(drawing.changes).toEqual([STEPS[1]]);
  });

  it('keeps full detail while a picture is kept, and goes on by itself after', () => {
    const drawing = new Drawing();
    drawing.draw(100, () => FAR_TOO_SLOW_MS);
    drawing.pace.holdFull(true);
    expect(drawing.detail).toBe(FULL);
    drawing.draw(100, () => FAR_TOO_SLOW_MS);
    expect(drawing.detail).toBe(FULL);
    drawing.pace.holdFull(false);
    drawing.draw(100, () => FAR_TOO_SLOW_MS);
    expect(drawing.detail).toBe(STEPS[STEPS.length - 1]);
  });

  it('rests after a slow picture, so that the page has half of the time', () => {
    const drawing = new Drawing();
    drawing.draw(3, () => SLOW_MS);
    expect(drawing.now).toBeGreaterThanOrEqual(3 * 2 * SLOW_MS);
  });
});
