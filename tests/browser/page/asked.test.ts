// SPDX-License-Identifier: GPL-3.0-or-later
// Tests how the page draws a tool that tissue stops: the tool where it is, and a ghost where the hand leads it. Jaws
// are drawn on the tissue that they hold.
import { Stage } from './stage';
import type { Colour, ViewerPage } from './viewer_page';

type Point = [number, number, number];
const MIDDLE: Point = [0, 0, 0]; // middle of the slab's surface
const OVER_M = 0.008; // largest horizontal distance of the tip from the slab's middle at which the tool counts as over it
const BEHIND_M = 0.002; // height by which the slab stops the tool above where it is led; its floor is pinned
const NOTCHES = 4; // notches of the wheel for a step
const NOTCH_M = 0.0005;
const LIFT = 20; // notches of the wheel that lift the tool
const BESIDE: Point = [-0.02, 0, 0]; // a place where the tool in the middle does not hide the jaws
const ZOOM = 4, ZOOM_JAWS = 1; // notches of the wheel: tool and jaws fill part of the picture
const RESTED_M = 1e-4; // largest motion of a tool at rest, in RESTED_FRAMES frames
const RESTED_FRAMES = 10;
const RIM = 0.92; // distance of the looked-at rim from the ball's middle, as a share of the ball's radius
// least difference of blue and red, of 255: it is 170 on the ghost, and -50 on metal and tissue without the ghost
const RIM_BLUE = 10;

const blue = ([r, , b]: Colour): number => b - r;

describe('what tissue stops', () => {
  const stage = new Stage(['--demo', 'fat']);
  let viewer: ViewerPage;

  const turnWheel = async (notches: number): Promise<void> => {
    for (let i = 0; i < Math.abs(notches); i++) await viewer.page.mouse.wheel(0, -100 * Math.sign(notches));
  };
  const lookAt = async (place: Point, notches: number): Promise<void> => {
    const before = await viewer.project(place);
    await viewer.page.mouse.move(before.x, before.y);
    await viewer.zoom(notches);
    const { x, y } = await viewer.project(place);
    await viewer.page.mouse.move(x, y);
  };

  /** Returns where the tool is and where it is led, once the tool has come to rest. While it moves, it is also
   * behind. */
  const rested = async (): Promise<{ tip: readonly number[]; asked: readonly number[] }> => {
    for (let before = await viewer.state(); ; ) {
      await viewer.until((count) => window.cautery.framesDecoded >= count, before.framesDecoded + RESTED_FRAMES, 'frames later');
      const now = await viewer.state();
      if (Math.hypot(...now.tip.map((x, i) => x - before.tip[i])) < RESTED_M) return now;
      before = now;
    }
  };

  beforeAll(async () => {
    viewer = await stage.open();
    await viewer.live('d1-fat');
    await viewer.page.evaluate(() => (document.querySelector<HTMLElement>('#cue')!.style.display = 'none'));
  });

  it('a tool that is pressed on is drawn where it is, and as a ghost where it is led to, until it is drawn back', async () => {
    const { page } = viewer;
    await page.getByRole('button', { name: 'Move', exact: true }).click();
    await lookAt(MIDDLE, ZOOM);
    await page.mouse.down();
    await viewer.until((near) => Math.hypot(window.cautery.tip[0], window.cautery.tip[1]) < near, OVER_M, 'it is over the slab');
    expect((await viewer.state()).ghost).toBe(false);
    let notches = 0;
    for (let { tip, asked } = await rested(); tip[2] < asked[2] + BEHIND_M; { tip, asked } = await rested()) {
      await turnWheel(NOTCHES);
      notches += NOTCHES;
      await viewer.drawn();
    }
    expect((await viewer.state()).ghost).toBe(true);
    await viewer.full(true);
    await viewer.screenshot('asked-ghost');
    const { asked: [ax, ay, az], tool } = await viewer.state();
    const off = RIM * (tool?.hot_radius_m ?? 0);
    const rim = (await viewer.coloursAt([[ax - off, ay, az], [ax + off, ay, az]], 1)).map(blue);
    process.stdout.write(`the rim: ${rim.map((value) => value.toFixed(0)).join(' and ')} more of blue than of red\n`);
    expect((rim[0] + rim[1]) / 2).toBeGreaterThan(RIM_BLUE);
    await viewer.full(false);
    await turnWheel(-notches);
    await viewer.until(() => !window.cautery.ghost, null, 'it is where it is led to');
    await page.mouse.up();
  });

  it('jaws stop at what they hold, with a ghost where they are led to, and the page says what they hold', async () => {
    const { page } = viewer;
    await page.getByRole('tab', { name: 'Tools' }).click();
    await page.getByText('Add a tool').click();
    await page.locator('#panel-tools details').getByRole('button', { name: 'Add', exact: true }).click();
    await viewer.until(() => window.cautery.tool?.name === 'grasper' && window.cautery.driving, null, 'a grasper is in hand');
    await page.locator('[data-press=work]').click();
    await lookAt(BESIDE, ZOOM_JAWS);
    await page.mouse.down();
    await viewer.until(() => window.cautery.grasping && window.cautery.askedJaw === 0, null, 'the jaws have closed');
    await viewer.until(() => window.cautery.ghost, null, 'their ghost is closed');
    const { jaw } = await viewer.state();
    expect(jaw).toBeGreaterThan(0);
    expect(jaw).toBeLessThan(1);
    await viewer.until(() => /holds \d+ points pressed with [\d.]+ N/.test(document.querySelector('#panel-tools')?.textContent ?? ''), null, 'the page says so');
    await page.getByText('Tool in hand').scrollIntoViewIfNeeded();
    await viewer.full(true);
    await viewer.screenshot('asked-jaws');
    await viewer.full(false);
    await turnWheel(-LIFT);
    await viewer.until((z) => window.cautery.tip[2] > z, LIFT * NOTCH_M / 2, 'they have been lifted');
    await viewer.until(() => /holds \d+ points/.test(document.querySelector('#panel-tools')?.textContent ?? ''), null, 'they hold what they pull');
    await viewer.full(true);
    await viewer.screenshot('asked-pull');
    await viewer.full(false);
    await turnWheel(LIFT);
    await page.mouse.up();
    await viewer.until(() => window.cautery.jaw === 1 && !window.cautery.ghost, null, 'they are open, and no ghost is there');
  });
});
