// SPDX-License-Identifier: GPL-3.0-or-later
// Tests tools for a close look: the values under the pointer, a ruler, a plane that hides tissue in the picture, and
// stored views.

import { daemonForTest, Stage } from './stage';
import { ViewerPage } from './viewer_page';

const ANOTHER_COLOUR = 60; // least distance of another colour, of 441; see cut.test.ts
const NEAR_MM = 0.6; // tolerance: a picture has three pixels a millimetre
const SHOWN_MS = 60_000; // a slow machine may take so long to show a value
const ASK_MS = 500; // between moves of the pointer: longer than the page waits before it asks again

describe('looking closely', () => {
  const stage = new Stage(['--demo', 'fascia']);
  let viewer: ViewerPage;

  const pointAt = async (point: [number, number, number]): Promise<void> => {
    const { x, y } = await viewer.project(point);
    await viewer.page.mouse.move(x, y);
  };

  beforeAll(async () => {
    viewer = await stage.open();
    await viewer.live('d1-fascia');
    await viewer.page.getByRole('tab', { name: 'View' }).click();
  });

  it('shows layer, vertex, place and temperature under the pointer', async () => {
    const { page } = viewer;
    await page.getByLabel('Show what is under the pointer').check();
    await pointAt([0.03, 0.02, 0]);
    await viewer.until(() => document.querySelector('#inspected')?.checkVisibility() === true && document.querySelector('#inspected')!.textContent.includes('°C'), null, 'it is told');
    const [what, where, temperature, stress, heat] = ((await page.locator('#inspected').textContent()) ?? '').split('\n');
    expect(what).toMatch(/^fascia, vertex \d+$/);
    const at = where.replace(' mm', '').split(', ').map(Number);
    expect(Math.hypot(at[0] - 30, at[1] - 20)).toBeLessThan(2);
    expect(temperature).toBe('37.0 °C');
    expect(stress).toBe('stress is shown for fat only');
    expect(heat).toBe('0 % of the heat exposure at which this tissue parts');
    const answered = await page.evaluate(() => {
      const canvas = document.querySelector('#picture')!;
      // the motion makes the page request the value
      canvas.dispatchEvent(new PointerEvent('pointermove', { clientX: 400, clientY: 300 }));
      canvas.dispatchEvent(new PointerEvent('pointerleave'));
      return window.cautery.tick + 60;
    });
    await viewer.until((tick) => window.cautery.tick > tick, answered, 'the answer was on its way meanwhile');
    expect(await page.locator('#inspected').isVisible()).toBe(false);
    await page.getByLabel('Show what is under the pointer').uncheck();
    await pointAt([0.03, 0.02, 0]);
    expect(await page.locator('#inspected').isVisible()).toBe(false);
  });

  it('shows stress of fat', async () => {
    const pulled = await daemonForTest(['--demo', 'fat-neohookean']);
    const other = await ViewerPage.open(stage.browser, pulled.url);
    await other.live('d1-fat-neohookean');
    await other.page.getByRole('tab', { name: 'Materials' }).click();
    const forces = other.page.locator('#forces');
    await forces.locator('summary').click();
    await forces.locator('select[name=selection]').selectOption('nearest');
    await forces.getByLabel('Force on each vertex z').fill('1');
    await forces.getByRole('button', { name: 'Apply the force' }).click();
    await other.page.getByRole('tab', { name: 'View' }).click();
    await other.page.getByLabel('Show what is under the pointer').check();
    // While a request takes long, a message lies over the middle of the picture and would take the pointer.
    await other.until(() => document.querySelector('[aria-busy=true]') === null && document.querySelector('#veil')?.checkVisibility() === false, null, 'nothing is over the picture');
    const { x, y } = await other.project([0.004, 0.003, 0]);
    const stress = (): boolean => Number(/([\d.e+-]+) kPa/.exec(document.querySelector('#inspected')?.textContent ?? '')?.[1] ?? 0) > 0;
    // Such a message may also come later, and takes the pointer off the picture until it moves again.
    const end = Date.now() + SHOWN_MS;
    for (let step = 0; !(await other.page.evaluate(stress)) && Date.now() < end; step++) {
      await other.page.mouse.move(x + (step % 2), y);
      await other.page.evaluate((ms) => new Promise((resolve) => setTimeout(resolve, ms)), ASK_MS);
    }
    expect(await other.page.evaluate(stress), 'the stress of fat that is pulled').toBe(true);
    expect(other.complaints).toEqual([]);
    await other.close();
  });

  it('measures from one place of the tissue to another', async () => {
    const { page } = viewer;
    await viewer.live('d1-fascia');
    await page.getByRole('button', { name: 'Measure' }).click();
    await pointAt([-0.021, 0.011, 0]);
    await page.mouse.down();
    await pointAt([0.029, 0.011, 0]);
    await page.mouse.up();
    await viewer.until(() => document.querySelector('#ruler')?.checkVisibility() === true, null, 'the ruler lies there');
    const told = (await page.locator('#ruler output').textContent()) ?? '';
    expect(Math.abs(parseFloat(told) - 50)).toBeLessThan(NEAR_MM);
    await viewer.screenshot('ruler');
    expect((await viewer.state()).energized).toBe(false);
    await page.getByRole('button', { name: 'Remove the ruler' }).click();
    await viewer.until(() => document.querySelector('#ruler')?.checkVisibility() === false, null, 'it is gone');
    await page.getByRole('button', { name: 'Cut', exact: true }).click();
  });

  it('cuts away from the picture what lies beyond a plane, for the hand too', async () => {
    const { page } = viewer;
    const places: [number, number, number][] = [[0.03, 0.035, 0], [0.03, -0.035, 0]];
    const whole = await viewer.coloursAt(places);
    await page.getByLabel('Hide tissue').selectOption('from behind');
    await viewer.drawn();
    await viewer.until(() => window.cautery.idle, null, 'the picture of it');
    const half = await viewer.coloursAt(places);
    const change = half.map((colour, i) => Math.hypot(...colour.map((value, c) => value - whole[i][c])));
    expect(change[0]).toBeGreaterThan(ANOTHER_COLOUR);
    expect(change[1]).toBeLessThan(ANOTHER_COLOUR / 2);
    await page.getByLabel('Show what is under the pointer').check();
    await pointAt(places[1]);
    await viewer.until(() => document.querySelector('#inspected')?.checkVisibility() === true, null, 'what is left is told');
    await pointAt(places[0]);
    await viewer.until(() => document.querySelector('#inspected')?.checkVisibility() === false, null, 'what is cut away is not');
    await page.mouse.down(); // the press is beside the tissue: the view turns, and no tool is taken
    const corner = await viewer.project(places[1]);
    const { x, y } = await viewer.project(places[0]);
    await page.mouse.move(x + 60, y);
    await page.mouse.up();
    const turned = await viewer.project(places[1]);
    expect(Math.hypot(turned.x - corner.x, turned.y - corner.y)).toBeGreaterThan(5);
    expect((await viewer.state()).driving).toBe(false);
    await page.locator('#panel-view').getByRole('button', { name: 'First view' }).click();
  });

  it('is for researchers: Operate shows the whole tissue again, without a message', async () => {
    const { page } = viewer;
    const places: [number, number, number][] = [[0.03, 0.035, 0], [0.03, -0.035, 0]];
    await viewer.until(() => window.cautery.idle, null, 'the picture of the half');
    const half = await viewer.coloursAt(places);
    await page.getByRole('button', { name: 'Operate' }).click();
    await pointAt(places[1]);
    await viewer.until(() => window.cautery.idle, null, 'the picture of the whole');
    const whole = await viewer.coloursAt([places[0]]);
    expect(Math.hypot(...whole[0].map((value, c) => value - half[0][c]))).toBeGreaterThan(ANOTHER_COLOUR);
    expect(await page.locator('#inspected').isVisible()).toBe(false);
    await page.getByRole('button', { name: 'Research' }).click();
    expect(await page.getByLabel('Show what is under the pointer').isChecked()).toBe(false);
    expect(await page.getByLabel('Hide tissue').inputValue()).toBe('');
  });

  it('keeps views under a name, beside the standard ones', async () => {
    const { page } = viewer;
    await viewer.live('d1-fascia');
    const corner: [number, number, number] = [0.05, 0.03, 0];
    const apart = async (a: { x: number; y: number }): Promise<number> => {
      const b = await viewer.project(corner);
      return Math.hypot(a.x - b.x, a.y - b.y);
    };
    const views = page.locator('#panel-view fieldset', { hasText: 'Camera' });
    await views.getByRole('button', { name: 'From the left' }).click();
    const fromLeft = await viewer.project(corner);
    await page.getByLabel('Name of the view').fill('my corner');
    await views.getByRole('button', { name: 'Save this view' }).click();
    await views.getByRole('button', { name: 'First view' }).click();
    expect(await apart(fromLeft)).toBeGreaterThan(50);
    await page.reload();
    await viewer.live('d1-fascia');
    await page.getByRole('tab', { name: 'View' }).click();
    await views.getByRole('button', { name: 'my corner', exact: true }).click();
    expect(await apart(fromLeft)).toBeLessThan(3);
    await views.getByRole('button', { name: 'Delete the view my corner' }).click();
    expect(await views.getByRole('button', { name: 'my corner', exact: true }).count()).toBe(0);
    expect(viewer.complaints).toEqual([]);
  });
});
