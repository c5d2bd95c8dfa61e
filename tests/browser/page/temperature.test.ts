// SPDX-License-Identifier: GPL-3.0-or-later
// Tests temperature as colour: hot around the energized hook and the body's temperature elsewhere, in the model and in
// the picture. A legend shows the range. The page stops requesting temperatures when they are not shown.
import AxeBuilder from '@axe-core/playwright';

import { Stage } from './stage';
import { ViewerPage, type Colour } from './viewer_page';

type Point = [number, number, number];

const BODY_C = 37; // ambient_c of deploy/scenes/fascia.json, by default
const SHADE_C = 0.6; // least difference that the picture can show: a 255th of the range from body to hook
const HOT_C = 70;
/** Number of places in front of the hook of which more must be hot. */
const ENOUGH = 5;
/** Distances of places in front of the hook's foot, which hides none of them: towards the camera, and along the
 * foot. */
const FRONT_M = [0.0035, 0.0045, 0.0055];
const ALONG_M = [-0.003, -0.002, -0.001, 0, 0.001, 0.002, 0.003];
const FAR: Point[] = [[-0.045, 0.035, 0], [0.045, 0.035, 0], [0.045, -0.035, 0], [-0.045, -0.035, 0], [0.045, 0, 0]];
/** Least redness: the excess of red over green, divided by red. It is 0 in the body's pale yellow and 0.4 in the
 * orange of half the range. */
const RED = 0.25;
const PALE = 0.1;

const redness = ([r, g]: Colour): number => (r - g) / Math.max(r, 1);
const median = (values: readonly number[]): number => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];

describe('temperature as colour', () => {
  const stage = new Stage(['--demo', 'fascia']);
  let viewer: ViewerPage;

  beforeAll(async () => {
    viewer = await stage.open();
    await viewer.live('d1-fascia');
  });

  const temperatures = (points: readonly Point[]): Promise<(number | null)[]> =>
    viewer.page.evaluate((all) => all.map((point) => window.cautery.temperatureAt(point)), [...points]);

  /** Makes the tissue take up no heat, so that it does not part, however long the test takes. */
  const takeNoHeatUp = async (): Promise<void> => {
    const { page } = viewer;
    await page.getByRole('tab', { name: 'Materials' }).click();
    const form = page.locator('#panel-materials form').first();
    await form.locator('input[name=absorption_per_s]').fill('0');
    await form.getByRole('button', { name: 'Apply' }).click();
    await viewer.until(() => /"absorption_per_s":0[,}]/.test(JSON.stringify(window.cautery.layer('fascia'))), null, 'the daemon has it');
    await page.getByRole('tab', { name: 'View' }).click();
  };

  it('is the body’s while nothing heats', async () => {
    const { page } = viewer;
    expect(await temperatures(FAR)).toEqual(FAR.map(() => null));
    await page.getByRole('tab', { name: 'View' }).click();
    await page.locator('#colouring').selectOption('temperature');
    await viewer.until(() => window.cautery.temperatureAt([0, 0, 0]) !== null, null, 'the stream brings temperature');
    for (const celsius of await temperatures([[0, 0, 0], ...FAR])) expect(celsius).toBe(BODY_C);
    expect(await page.locator('#legend > span').textContent()).toBe('Temperature');
    await viewer.until(
      () => [...document.querySelectorAll('#legend small')].map((end) => end.textContent).join() === '37 °C,100 °C',
      null,
      'the legend tells the body’s temperature and boiling water’s',
    );
  });

  it('is high around the energized hook and the body’s far away, in the model and in the picture', async () => {
    const { page } = viewer;
    await takeNoHeatUp();
    await viewer.grab([0, 0, 0]);
    await page.mouse.up(); // otherwise the hook would follow to the button below
    await page.keyboard.down('Space');
    // Waits for everything that is checked below, at the place where the hook has come to. The hook may still move when
    // the first place is hot.
    await viewer.until(
      ({ hot, enough, reaches, alongs }) => {
        const [x, y] = window.cautery.tip;
        const celsius = reaches.flatMap((reach) => alongs.map((along) => window.cautery.temperatureAt([x + along, y - reach, 0]) ?? 0));
        return celsius.filter((each) => each > hot).length > enough;
      },
      { hot: HOT_C, enough: ENOUGH, reaches: FRONT_M, alongs: ALONG_M },
      'tissue in front of the hook is hot',
    );
    // The heat stays where it is. The button is pressed by script, because a click would first take the focus and end
    // energy, and tissue cools in a few ticks.
    await page.getByRole('button', { name: 'Pause' }).evaluate((button: HTMLButtonElement) => { button.click(); });
    await viewer.until(() => window.cautery.paused, null, 'paused');
    await page.locator('#picture').focus();
    await page.keyboard.up('Space');
    await viewer.drawn();
    await viewer.until(() => window.cautery.idle, null, 'the picture of it');

    const [x, y] = (await viewer.state()).tip;
    const front = FRONT_M.flatMap((reach) => ALONG_M.map((along): Point => [x + along, y - reach, 0]));
    const near = await temperatures(front);
    const hot = front.filter((_, i) => (near[i] ?? 0) > HOT_C);
    const colours = await viewer.coloursAt([...hot, ...FAR]);
    await viewer.screenshot('temperature');
    expect(hot.length).toBeGreaterThan(ENOUGH);
    for (const celsius of await temperatures(FAR)) expect(Math.abs((celsius ?? 0) - BODY_C)).toBeLessThan(SHADE_C);
    expect(median(colours.slice(0, hot.length).map(redness))).toBeGreaterThan(RED);
    expect(Math.max(...colours.slice(hot.length).map(redness))).toBeLessThan(PALE);
  });

  it('tells the range in the legend, which assistive programs can read', async () => {
    const { page } = viewer;
    const [least, most] = await page.locator('#legend small').allTextContents();
    expect(least).toBe('37 °C');
    expect(most).toMatch(/^\d+ °C$/);
    expect(parseFloat(most)).toBeGreaterThanOrEqual(HOT_C);
    expect(parseFloat(most)).toBeLessThanOrEqual(170); // at most the hook's temperature
    const { violations } = await new AxeBuilder({ page }).analyze();
    expect(violations.filter(({ impact }) => impact === 'serious' || impact === 'critical').map(({ id }) => id)).toEqual([]);
  });

  it('is not asked for once tissue is shown as tissue', async () => {
    await viewer.page.locator('#colouring').selectOption('tissue');
    await viewer.until(() => window.cautery.temperatureAt([0, 0, 0]) === null, null, 'the stream without temperature');
    expect(await viewer.page.locator('#legend').isVisible()).toBe(false);
    expect(viewer.complaints).toEqual([]);
  });
});
