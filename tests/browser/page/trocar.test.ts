// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the field through a trocar: a round picture, tissue up to its edge, and a dark surround in which nothing is
// picked. The open field is a choice that the browser stores, made by keyboard.
import { Stage } from './stage';
import type { Colour, ViewerPage } from './viewer_page';

const DARK = 12; // largest channel of a dark colour, of 255
const RED_LEAST = 40; // least red of flesh in the weakest light, of 255
const INSIDE = 0.93; // distance of places within the circle, as a share of its radius
const WIDTH_SHARE = 0.93; // the circle's width as a share of the picture's shorter side, as in scene/scope.ts
const PLACES = 24;

interface Round {
  /** colours just within the circle, all around, as far as the picture and its buttons do not hide them */
  edge: Colour[];
  corners: Colour[];
}

/** Returns colours of the picture, without the elements over it. */
async function look(viewer: ViewerPage): Promise<Round> {
  await viewer.until(() => window.cautery.idle, null, 'the sharp picture');
  await viewer.page.evaluate(() => document.querySelectorAll<HTMLElement>('#cue, #handles').forEach((one) => (one.style.visibility = 'hidden')));
  const box = (await viewer.page.locator('#picture').boundingBox())!;
  const radius = (WIDTH_SHARE * Math.min(box.width, box.height)) / 2;
  const around = Array.from({ length: PLACES }, (_, i) => (2 * Math.PI * i) / PLACES)
    .map((angle) => ({ x: box.width / 2 + INSIDE * radius * Math.cos(angle), y: box.height / 2 + INSIDE * radius * Math.sin(angle) }))
    .filter(({ x, y }) => x > 4 && x < box.width - 4 && y > 4 && y < box.height - 4);
  const corners = [[8, 8], [box.width - 8, 8], [8, box.height - 8], [box.width - 8, box.height - 8]].map(([x, y]) => ({ x, y }));
  const places = [...around, ...corners].map(({ x, y }) => ({ x: x + box.x, y: y + box.y }));
  const colours = await viewer.coloursOf(places);
  await viewer.page.evaluate(() => document.querySelectorAll<HTMLElement>('#cue, #handles').forEach((one) => (one.style.visibility = '')));
  return { edge: colours.slice(0, around.length), corners: colours.slice(around.length) };
}

const dark = ([r, g, b]: Colour): boolean => Math.max(r, g, b) < DARK;
const flesh = ([r, g, b]: Colour): boolean => r > RED_LEAST && r >= g && g >= b;

describe('the field', () => {
  const stage = new Stage(['--demo', 'layers']);
  let viewer: ViewerPage;

  beforeAll(async () => {
    viewer = await stage.openFirst();
    await viewer.live('d1-layers');
  });

  it('is seen through a trocar: round, with tissue up to the edge from every side, and black outside', async () => {
    for (const side of ['First view', 'From above', 'Along', 'From the left']) {
      await viewer.page.getByRole('button', { name: side }).click();
      await viewer.drawn();
      const { edge, corners } = await look(viewer);
      expect(edge.length, side).toBeGreaterThan(8);
      expect(corners.filter((colour) => !dark(colour)), side).toEqual([]);
      const other = edge.filter((colour) => !flesh(colour));
      expect(other.length, `${side}: ${JSON.stringify(other)}`).toBeLessThanOrEqual(3); // the tool hides some of the places
    }
    await viewer.page.getByRole('button', { name: 'First view' }).click();
  });

  it('is neither pointed at nor cut where it is black', async () => {
    const box = (await viewer.page.locator('#picture').boundingBox())!;
    await viewer.page.getByRole('region', { name: 'Camera' }).getByRole('button', { name: 'Nearer' }).click({ clickCount: 4 });
    await viewer.drawn();
    const before = await viewer.project([0, 0.03, 0.002]);
    await viewer.page.mouse.move(box.x + 40, box.y + box.height / 2);
    await viewer.page.mouse.down();
    await viewer.page.mouse.move(box.x + 60, box.y + box.height / 2 + 30, { steps: 3 });
    await viewer.page.mouse.up();
    const { driving, energized } = await viewer.state();
    expect([driving, energized]).toEqual([false, false]);
    const after = await viewer.project([0, 0.03, 0.002]);
    expect(Math.hypot(after.x - before.x, after.y - before.y)).toBeGreaterThan(5); // the drag turned the camera
    await viewer.page.getByRole('button', { name: 'First view' }).click();
  });

  it('is open for who chooses so by keyboard, and when the page comes up again', async () => {
    const { page } = viewer;
    const choice = page.locator('#operate').getByRole('combobox', { name: 'View' });
    expect(await choice.inputValue()).toBe('trocar');
    await choice.focus();
    await page.keyboard.press('ArrowDown');
    expect(await choice.inputValue()).toBe('open');
    await viewer.drawn();
    expect((await look(viewer)).corners.filter(dark)).toEqual([]);
    await page.reload();
    await viewer.live('d1-layers');
    expect(await choice.inputValue()).toBe('open');
    expect((await look(viewer)).corners.filter(dark)).toEqual([]);
    await choice.selectOption('trocar');
    await viewer.drawn();
    expect((await look(viewer)).corners.every(dark)).toBe(true);
    await page.getByRole('button', { name: 'Research' }).click();
    await page.getByRole('tab', { name: 'View' }).click();
    expect(await page.locator('#panel-view').getByRole('combobox', { name: 'View' }).inputValue()).toBe('trocar');
    expect(viewer.complaints).toEqual([]);
    await viewer.close();
  });
});
