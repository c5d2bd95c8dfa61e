// SPDX-License-Identifier: GPL-3.0-or-later
// Tests a look at the past: the timeline shows the tissue at an earlier time, in one page only, while the session
// continues.
import { Stage } from './stage';
import { COARSE, type ViewerPage } from './viewer_page';

const FACES = 6000; // number of faces in deploy/scenes/fascia.json
const HOT_C = 900;

describe('looking back', () => {
  const stage = new Stage(['--demo', 'fascia'], COARSE);
  let viewer: ViewerPage;
  let other: ViewerPage;
  let left = 0;

  beforeAll(async () => {
    viewer = await stage.open();
    await viewer.live('d1-fascia');
    await viewer.heatTool(HOT_C);
    await viewer.grab([-0.02, 0, 0]);
    await viewer.cut(0, 0, -0.02, 0, 4);
    // Hot tissue still parts a face or two after the hand has gone.
    for (let before = -1; left !== before; ) {
      before = left;
      const { tick } = await viewer.state();
      await viewer.until((from) => window.cautery.tick > from + 60, tick, 'another second');
      left = await viewer.faces();
    }
    other = await stage.openFirst();
    await other.live('d1-fascia');
  });

  const sign = (): Promise<string | null> => viewer.page.locator('#past p').textContent();
  const showsPast = (tick: number): Promise<void> => viewer.until((wanted) => window.cautery.past === wanted, tick, `tick ${tick} is shown`);

  it('shows the whole tissue again where the cut had not begun, with a plain sign', async () => {
    const { page } = viewer;
    const { epoch, tick } = await viewer.state();
    expect(left).toBeLessThan(FACES);
    await page.locator('#tick').focus();
    await page.keyboard.press('Home');
    await page.locator('#past').getByText(/^Loading t = 0\.00 s/).waitFor();
    await showsPast(0);
    await viewer.drawn();
    await viewer.screenshot('looking-back');
    expect(await viewer.faces()).toBe(FACES);
    expect(await sign()).toBe('You see the past at t = 0.00 s. The session continues.');
    expect(await page.locator('#past progress').isVisible()).toBe(false);
    await viewer.until((before) => window.cautery.tick > before + 30, tick, 'the session goes on meanwhile');
    expect((await viewer.state()).epoch).toBe(epoch);
    expect(await viewer.faces()).toBe(FACES);
  });

  it('and no other client sees any of it', async () => {
    expect((await other.state()).past).toBeNull();
    expect(await other.faces()).toBe(left);
    expect(await other.page.locator('#past').isVisible()).toBe(false);
  });

  it('no hand works in the past, and is told so', async () => {
    const { page } = viewer;
    const { tip } = await viewer.state();
    const { x, y } = await viewer.project([0.01, 0.005, 0]);
    await page.mouse.move(x, y);
    await page.mouse.down();
    const words = page.locator('#said').getByText('This is a past view. Press Return to live to use the tools.');
    await words.waitFor();
    await page.mouse.up();
    const box = (await words.boundingBox())!;
    const under = await page.evaluate(([px, py]) => document.elementFromPoint(px, py)?.id, [box.x + box.width / 2, box.y + box.height / 2]);
    expect(under, 'what a press on the words meets').toBe('picture');
    await page.keyboard.press('Space');
    const after = await viewer.state();
    expect(after.energized).toBe(false);
    expect(after.tip).toEqual(tip);
  });

  it('goes along with the timeline: to the moment of the cut', async () => {
    const { page } = viewer;
    const { tip } = await viewer.state();
    const moments = page.locator('#moments');
    const cut = (await moments.locator('option').allTextContents()).find((words) => / s: cut, hook$/.test(words))!;
    await moments.selectOption({ label: cut });
    const [seconds] = cut.split(' ');
    await viewer.until((words) => document.querySelector('#past p')?.textContent === words, `You see the past at t = ${seconds} s. The session continues.`, 'the cut is shown');
    const faces = await viewer.faces();
    expect(faces).toBeLessThanOrEqual(FACES);
    expect(faces).toBeGreaterThanOrEqual(left);
    expect((await viewer.state()).tip, 'the tool stays where it was left').toEqual(tip);
  });

  it('returns to live at a press, and the hand works again', async () => {
    const { page } = viewer;
    await page.getByRole('button', { name: 'Return to live' }).click();
    await viewer.until(() => window.cautery.past === null, null, 'the present is shown');
    expect(await viewer.faces()).toBe(left);
    expect(await page.locator('#past').isVisible()).toBe(false);
    await viewer.grab([-0.01, 0.01, 0]);
    await page.mouse.up();
  });

  it('energy goes off where one looks away to the past', async () => {
    const { page } = viewer;
    await viewer.grab([-0.02, 0.015, 0]);
    await page.keyboard.down('Space');
    await viewer.until(() => window.cautery.energized, null, 'energy is on');
    await page.locator('#moments').evaluate((list: HTMLSelectElement) => {
      list.selectedIndex = list.options.length - 1;
      list.dispatchEvent(new Event('change'));
    });
    await viewer.until(() => !window.cautery.energized, null, 'energy is off');
    await page.locator('#said').getByText('Energy is off: the picture shows a past view.').waitFor();
    await page.keyboard.up('Space');
    await page.mouse.up();
    await page.getByRole('button', { name: 'Return to live' }).click();
    expect(viewer.complaints).toEqual([]);
    expect(other.complaints).toEqual([]);
  });
});
