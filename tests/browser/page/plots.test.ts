// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the plots of the tools over the session. They share one cursor with each other and with the timeline.

import { Stage } from './stage';
import { COARSE, ViewerPage } from './viewer_page';

const HOT_C = 150;
const BODY_C = 37;
const FRAMES_APART_S = 0.2; // a busy machine may leave this time between two frames

/** In the page, before its scripts: stores what plots write outside of their canvas. */
function watchPlotWords(): void {
  const canvas = CanvasRenderingContext2D.prototype;
  const write = Reflect.get<CanvasRenderingContext2D, 'fillText'>(canvas, 'fillText');
  window.plotWords = { written: 0, clipped: [] };
  canvas.fillText = function (words, x, y, most) {
    const { actualBoundingBoxLeft: left, actualBoundingBoxRight: right, actualBoundingBoxAscent: up, actualBoundingBoxDescent: down } = this.measureText(words);
    const corners = [[x - left, y - up], [x + right, y - up], [x - left, y + down], [x + right, y + down]].map(([cx, cy]) => this.getTransform().transformPoint({ x: cx, y: cy }));
    const { width, height } = this.canvas;
    window.plotWords.written++;
    if (corners.some((corner) => corner.x < -1 || corner.y < -1 || corner.x > width + 1 || corner.y > height + 1))
      window.plotWords.clipped.push(`${words} at ${x}, ${y} of ${width} x ${height}`);
    if (most === undefined) write.call(this, words, x, y);
    else write.call(this, words, x, y, most);
  };
}
declare global {
  interface Window {
    plotWords: { written: number; clipped: string[] };
  }
}

describe('plots over the session', () => {
  const stage = new Stage(['--demo', 'fascia'], COARSE);
  let viewer: ViewerPage;

  const told = async (): Promise<{ seconds: number; celsius: number; joules: number }> => {
    const words = (await viewer.page.locator('#at-cursor').textContent()) ?? '';
    const [, seconds, celsius, joules] = /^([\d.]+) s: hook (\d+) °C, [\d.e-]+ N, ([\d.e-]+) J$/.exec(words) ?? [];
    expect(seconds, words).toBeDefined();
    return { seconds: Number(seconds), celsius: Number(celsius), joules: Number(joules) };
  };
  /** Returns the x position of the cursor in each plot, pixels. */
  const cursors = (): Promise<number[]> =>
    viewer.page.evaluate(() => [...document.querySelectorAll<HTMLElement>('[aria-label="Tools over the session"] .u-cursor-x')].map(({ style }) => new DOMMatrix(style.transform).e));
  const spread = (places: readonly number[]): number => Math.max(...places) - Math.min(...places);

  beforeAll(async () => {
    viewer = await stage.open({ before: watchPlotWords });
    await viewer.live('d1-fascia');
    const { tick } = await viewer.state();
    await viewer.until((then) => window.cautery.tick > then, tick + 120, 'two seconds without heat');
    await viewer.page.keyboard.down('Space');
    await viewer.until(([hot]) => window.cautery.energized && (window.cautery.tipTemperatureC ?? 0) > hot, [HOT_C], 'the tip is hot');
    const lit = (await viewer.state()).tick;
    await viewer.until((then) => window.cautery.tick > then, lit + 60, 'a second of heat');
    await viewer.page.keyboard.up('Space');
    await viewer.until(() => !window.cautery.energized, null, 'energy is off');
    await viewer.pause();
    await viewer.page.getByRole('tab', { name: 'Plots' }).click();
    await viewer.until(() => document.querySelectorAll('[aria-label="Tools over the session"] canvas').length === 3, null, 'three plots');
  });

  it('tell the newest values of each tool', async () => {
    const { seconds, celsius } = await told();
    const { tick, tipTemperatureC } = await viewer.state();
    expect(Math.abs(60 * seconds - tick)).toBeLessThan(2);
    expect(Math.abs(celsius - tipTemperatureC!)).toBeLessThanOrEqual(0.5); // the plot shows whole degrees
    expect(celsius).toBeGreaterThan(BODY_C + 5); // the tip cools until the session pauses
  });

  it('share a cursor that shows the values where it points, and holds the timeline there', async () => {
    const { page } = viewer;
    const newest = await told();
    const box = (await page.locator('[aria-label="Tools over the session"] .u-over').nth(1).boundingBox())!;
    await page.mouse.move(box.x + 0.2 * box.width, box.y + box.height / 2);
    await viewer.until((before) => !document.querySelector('#at-cursor')!.textContent.startsWith(before), newest.seconds.toFixed(2), 'the time that is pointed at');
    const before = await told();
    expect(before.seconds).toBeLessThan(newest.seconds);
    expect(before.celsius).toBeLessThan(newest.celsius);
    // each plot rounds its own position to whole pixels
    await expect.poll(async () => spread(await cursors()), { timeout: 30_000 }).toBeLessThanOrEqual(1);
    expect(await cursors()).toHaveLength(3);
    await page.mouse.down();
    await page.mouse.up();
    await viewer.until(() => document.querySelector('#rewind')?.checkVisibility() === true, null, 'that moment is offered');
    const offered = /^Rewind to ([\d.]+) s$/.exec((await page.locator('#rewind').textContent()) ?? '')?.[1];
    expect(Math.abs(Number(offered) - before.seconds)).toBeLessThan(FRAMES_APART_S);
    await viewer.screenshot('plots');
  });

  it('clip no number on their axes, on desks and phones', async () => {
    for (const [width, height] of [[1100, 720], [390, 780], [780, 390]] as const) {
      await viewer.page.evaluate(() => (window.plotWords = { written: 0, clipped: [] }));
      await viewer.page.setViewportSize({ width, height });
      await viewer.until(() => window.plotWords.written > 20, null, 'the axes are drawn anew');
      expect(await viewer.page.evaluate(() => window.plotWords.clipped), `${width} x ${height}`).toEqual([]);
    }
    await viewer.page.setViewportSize({ width: 1100, height: 720 });
  });

  it('follow the timeline', async () => {
    const { page } = viewer;
    await page.mouse.move(5, 300); // moves the pointer off the plots
    await page.locator('#tick').focus();
    const newest = Number(await page.locator('#tick').getAttribute('max'));
    await page.keyboard.press('End');
    await page.keyboard.press('PageDown');
    const tick = Number(await page.locator('#tick').inputValue());
    expect(tick).toBeLessThan(newest);
    await viewer.until(([seconds, apart]) => Math.abs(parseFloat(document.querySelector('#at-cursor')!.textContent) - seconds) < apart, [tick / 60, FRAMES_APART_S] as const, 'the values of that time');
    expect(viewer.complaints).toEqual([]);
  });
});
