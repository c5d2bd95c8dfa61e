// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the first half minute of a new user. Tissue and tool are in the picture. A cue shows where to cut, and nothing
// else covers the picture. A user who follows the cue makes a cut. Actions that destroy something ask first.

import type { CDPSession, Page } from 'playwright-core';

import { BrowserStage, daemonForTest, Stage } from './stage';
import { MOVING, ViewerPage } from './viewer_page';

const PHONE = { hasTouch: true, isMobile: true };
const SCREENS = [
  ['a desktop', 'first-view', { viewport: { width: 1280, height: 800 } }],
  ['a phone in portrait', 'first-view-on-a-phone', { ...PHONE, viewport: { width: 390, height: 780 } }],
  ['a phone in landscape', 'first-view-in-landscape', { ...PHONE, viewport: { width: 780, height: 390 } }],
] as const;

const CUT_FACES = 24; // number of faces that makes a visible cut
const CUE_PICTURES_PER_S = 5.01; // largest rate of the cue's pictures if drawing is slow

interface Place {
  x: number;
  y: number;
}

/** Returns the corners of the tissue and the tip, and the free part of the picture, in CSS pixels. */
async function inPicture(viewer: ViewerPage): Promise<{ points: Place[]; free: { left: number; right: number; top: number; bottom: number } }> {
  const { least, most } = await viewer.page.evaluate(() => window.cautery.extent());
  const corners = [0, 1, 2, 3].map((i): [number, number, number] => [i & 1 ? most[0] : least[0], i & 2 ? most[1] : least[1], most[2]]);
  const { tip } = await viewer.state();
  const points = await Promise.all([...corners, tip as [number, number, number]].map((point) => viewer.project(point)));
  const box = (await viewer.page.locator('#picture').boundingBox())!;
  const handles = (await viewer.page.locator('#handles').boundingBox())!;
  return { points, free: { left: box.x, right: box.x + box.width, top: box.y, bottom: handles.y } };
}

/** Returns both ends of the cue's stroke. */
async function cue(viewer: ViewerPage): Promise<[Place, Place]> {
  const box = (await viewer.page.locator('#picture').boundingBox())!;
  const [x1, y1, x2, y2] = await viewer.page.locator('#cue line').evaluate((line) => ['x1', 'y1', 'x2', 'y2'].map((name) => Number(line.getAttribute(name))));
  return [{ x: box.x + x1, y: box.y + y1 }, { x: box.x + x2, y: box.y + y2 }];
}

/** From now on, counts how often the cue appears. */
async function countCues(viewer: ViewerPage): Promise<void> {
  await viewer.page.evaluate(() => {
    const cue = document.querySelector<HTMLElement>('#cue')!;
    Object.assign(window, { cues: 0 });
    new MutationObserver(() => cue.hidden || (window as unknown as { cues: number }).cues++).observe(cue, { attributes: true, attributeFilter: ['hidden'] });
  });
}
const cues = (viewer: ViewerPage): Promise<number> => viewer.page.evaluate(() => (window as unknown as { cues: number }).cues);

/** Returns the pictures in a second that the cue's animations request; Infinity if the animations are continuous. */
function stepsPerSecond(viewer: ViewerPage): Promise<number> {
  return viewer.page.evaluate(() => {
    const rates = document.getAnimations().flatMap(({ effect }) => {
      if (!(effect instanceof KeyframeEffect)) return [];
      const frames = effect.getKeyframes();
      return frames.slice(0, -1).map(({ easing, computedOffset }, i) => {
        const span = (frames[i + 1].computedOffset - computedOffset) * Number(effect.getComputedTiming().duration);
        return easing === 'step-end' || span === 0 ? 0 : (1000 * Number(/^steps\((\d+)/.exec(easing)?.[1] ?? Infinity)) / span;
      });
    });
    return Math.max(0, ...rates);
  });
}

/** A way to press on the picture, drag, and release. */
interface Hand {
  press(at: Place): Promise<unknown>;
  drag(to: Place): Promise<unknown>;
  release(): Promise<unknown>;
}

class Finger implements Hand {
  constructor(private readonly fingers: CDPSession) {}
  private readonly touch = (type: 'touchStart' | 'touchMove' | 'touchEnd', ...places: Place[]): Promise<unknown> =>
    this.fingers.send('Input.dispatchTouchEvent', { type, touchPoints: places.map((place) => ({ ...place, id: 1 })) });
  press = (at: Place): Promise<unknown> => this.touch('touchStart', at);
  drag = (to: Place): Promise<unknown> => this.touch('touchMove', to);
  release = (): Promise<unknown> => this.touch('touchEnd');
}

class Mouse implements Hand {
  constructor(private readonly page: Page) {}
  async press(at: Place): Promise<void> {
    await this.page.mouse.move(at.x, at.y);
    await this.page.mouse.down();
  }
  drag = (to: Place): Promise<unknown> => this.page.mouse.move(to.x, to.y, { steps: 5 });
  release = (): Promise<unknown> => this.page.mouse.up();
}

/** Follows the cue until at most `left` faces of the fascia are left. A page that stalls for too long loses its
 * energy, and asks the user to press again. */
async function follow(viewer: ViewerPage, hand: Hand, from: Place, to: Place, left: number): Promise<void> {
  for (;;) {
    await hand.press(from);
    await viewer.until(() => window.cautery.energized, null, 'the press heats');
    await hand.drag(to);
    await viewer.until((most) => window.cautery.drawnFaces['fascia'] <= most || !window.cautery.energized, left, 'faces are gone');
    if ((await viewer.state()).drawnFaces['fascia'] <= left) return;
    await hand.release();
  }
}

describe('the first view', () => {
  const stage = new BrowserStage();

  it.each(SCREENS)('on %s shows where to cut, and who follows it cuts', async (_name, picture, options) => {
    const daemon = await daemonForTest(['--demo', 'layers']);
    const viewer = await ViewerPage.openFirst(stage.browser, daemon.url, { ...MOVING, ...options });
    const { page } = viewer;
    await viewer.live('d1-layers');
    await viewer.until(() => document.querySelector('#cue')?.checkVisibility() === true, null, 'the cue is there');
    const { points, free } = await inPicture(viewer);
    for (const { x, y } of points) {
      expect(x).toBeGreaterThan(free.left);
      expect(x).toBeLessThan(free.right);
      expect(y).toBeGreaterThan(free.top);
      expect(y).toBeLessThan(free.bottom);
    }
    const inTheWay = await page.evaluate(() =>
      [...document.querySelectorAll('#hint, #veil, #said > *, #notices > *, dialog, #tabs')].filter((one) => one.checkVisibility()).map((one) => one.outerHTML),
    );
    expect(inTheWay).toEqual([]);
    await viewer.until(() => window.cautery.idle, null, 'the sharp picture');
    await viewer.screenshot(picture);
    // Software draws each picture of the cue's animation as long as the whole page.
    const slow = await page.evaluate(() => window.cautery.pictureMs > 50);
    const rate = await stepsPerSecond(viewer);
    if (slow) expect(rate).toBeLessThanOrEqual(CUE_PICTURES_PER_S);
    expect(rate).toBeGreaterThan(1);

    const { fascia } = (await viewer.state()).drawnFaces;
    const [from, to] = await cue(viewer);
    await countCues(viewer);
    const hand = 'hasTouch' in options ? new Finger(await page.context().newCDPSession(page)) : new Mouse(page);
    await follow(viewer, hand, from, to, fascia - CUT_FACES);
    expect(await page.locator('#cue').isVisible()).toBe(false);
    const open = await page.evaluate(() => [-0.026, -0.023, -0.02, -0.017, -0.014].some((x) => !window.cautery.drawnAt('fascia', x, 0)));
    expect(open, 'the cut begins where the cue does').toBe(true);
    await viewer.full(true);
    await viewer.screenshot(picture.replace('first-view', 'cutting'));
    await viewer.full(false);
    await hand.release();
    await viewer.until(() => !window.cautery.energized, null, 'energy is off');
    expect(await cues(viewer), 'the cue does not come back').toBe(0);
    expect(viewer.complaints).toEqual([]);
    await viewer.close();
  });
});

describe('what destroys', () => {
  const stage = new Stage(['--demo', 'fascia']);
  let viewer: ViewerPage;

  beforeAll(async () => {
    viewer = await stage.openFirst();
    await viewer.live('d1-fascia');
  });

  it('leaves the cue away that somebody has followed, were it too briefly to cut', async () => {
    const { page } = viewer;
    await viewer.until(() => document.querySelector('#cue')?.checkVisibility() === true, null, 'the cue is there');
    await page.locator('#picture').focus();
    await page.keyboard.down('Space');
    await viewer.until(() => window.cautery.energized && document.querySelector<HTMLElement>('#cue')!.hidden === true, null, 'energy is on');
    await countCues(viewer);
    await page.keyboard.up('Space');
    await viewer.until(() => !window.cautery.energized, null, 'energy is off');
    const { tick } = await viewer.state();
    await viewer.until((later) => window.cautery.tick > later, tick + 10, 'frames without energy');
    expect(await cues(viewer)).toBe(0);
  });

  it('asks before it starts over', async () => {
    const { page } = viewer;
    const { epoch } = await viewer.state();
    await page.getByRole('button', { name: 'Start over' }).click();
    await page.keyboard.press('Escape');
    expect(await page.locator('dialog[open]').count()).toBe(0);
    expect((await viewer.state()).epoch).toBe(epoch);
    await page.getByRole('button', { name: 'Start over' }).click();
    await page.locator('dialog').getByRole('button', { name: 'Start over' }).click();
    await viewer.until((before) => window.cautery.epoch !== before, epoch, 'another epoch');
    await viewer.until(() => document.querySelector('#cue')?.checkVisibility() === true, null, 'the cue is back with tissue that is whole');
  });

  it('is out of a trainee’s reach, and asks a researcher', async () => {
    const { page } = viewer;
    for (const hidden of ['Step', 'Destroy d1-fascia', 'Fork this session']) expect(await page.getByRole('button', { name: hidden }).isVisible(), hidden).toBe(false);
    for (const shown of ['Instrument', 'Power', 'Camera']) expect(await page.getByRole('heading', { name: shown }).isVisible(), shown).toBe(true);
    await page.getByRole('button', { name: 'Research' }).click();
    await page.getByRole('button', { name: 'Destroy d1-fascia' }).click();
    await page.getByRole('button', { name: 'Cancel' }).click();
    expect((await viewer.state()).session).toBe('d1-fascia');
    await page.getByRole('button', { name: 'Destroy d1-fascia' }).click();
    await page.locator('dialog').getByRole('button', { name: 'Destroy' }).click();
    await viewer.until(() => window.cautery.session === null, null, 'it is gone');
    await page.locator('#veil').getByText('No session is open').waitFor();
  });
});
