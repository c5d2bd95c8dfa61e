// SPDX-License-Identifier: GPL-3.0-or-later
// Tests energy that stays on without a held input. The page shows this plainly, any user can end it, and the daemon
// ends it when its time is up.
import { Door } from './door';
import { Stage } from './stage';
import { COARSE, ViewerPage } from './viewer_page';

const FACES = 6000; // number of faces in deploy/scenes/fascia.json
const CUT_FACES = 8;

describe('latched energy', () => {
  const stage = new Stage(['--demo', 'fascia']);
  let door: Door;
  let viewer: ViewerPage;

  beforeAll(async () => {
    door = new Door(stage.daemon.url);
    viewer = await ViewerPage.openFirst(stage.browser, await door.start(), COARSE);
    await viewer.live('d1-fascia');
  });
  afterAll(() => door.end());

  const lit = (): Promise<void> => viewer.until(() => window.cautery.energized, null, 'energy is on');
  const dark = (): Promise<void> => viewer.until(() => !window.cautery.energized, null, 'energy is off');
  const sign = (): Promise<boolean> => viewer.page.locator('#latched').isVisible();
  const orders = (): number => door.asked.filter((method) => method === 'tool.energize').length;

  it('is ended by the daemon, without a word from the page', async () => {
    const { page } = viewer;
    await page.locator('#picture').focus();
    await page.keyboard.press('KeyL');
    await lit();
    const { tick } = await viewer.state();
    await viewer.until(() => document.querySelector('#said')?.textContent?.includes('Keep on lasts 15 s at most') === true, null, 'its time is up');
    expect((await viewer.state()).energized).toBe(false);
    // The last 60 ticks are for the page, which needs some time to notice this.
    expect((await viewer.state()).tick - tick).toBeLessThanOrEqual(60 * 15 + 60);
    expect(await sign()).toBe(false);
    expect(orders()).toBeLessThanOrEqual(3); // on, off at a later tick, and once more off when energy was off
  });

  it('says so, and cuts where a mouse without a button leads', async () => {
    const { page } = viewer;
    const from = await viewer.project([-0.01, 0.005, 0]);
    const to = await viewer.project([0.01, 0.005, 0]);
    await page.getByRole('button', { name: 'Keep on' }).click();
    await lit();
    expect(await page.locator('#latched').textContent()).toMatch(/^Energy stays on for \d+ s\. Press Keep on, L or Escape to turn energy off\.$/);
    expect(await page.locator('#latch').getAttribute('aria-pressed')).toBe('true');
    await page.mouse.move(from.x, from.y);
    await page.mouse.move(to.x, to.y, { steps: 10 });
    await viewer.until((left) => Object.values(window.cautery.drawnFaces).reduce((sum, n) => sum + n, 0) <= left, FACES - CUT_FACES, 'faces are gone');
    await page.getByRole('button', { name: 'Keep on' }).click();
    await dark();
    expect(await sign()).toBe(false);
  });

  it('ends with Escape, wherever the focus is', async () => {
    const { page } = viewer;
    await page.locator('#picture').focus();
    await page.keyboard.press('KeyL');
    await lit();
    await page.locator('input[name=person]').focus();
    await page.keyboard.press('Escape');
    await dark();
    expect(await sign()).toBe(false);
  });

  it('ends when the page goes out of sight', async () => {
    const { page } = viewer;
    await page.locator('#picture').focus();
    await page.keyboard.press('KeyL');
    await lit();
    await page.evaluate(() => window.dispatchEvent(new Event('blur')));
    await dark();
    expect(await sign()).toBe(false);
    expect(viewer.complaints).toEqual([]);
  });
});
