// SPDX-License-Identifier: GPL-3.0-or-later
// Tests against faults that the page once had: messages under the veil, numbers that are cut off, units among the
// words, and a tool that is taken from its driver without a question.
import { Stage } from './stage';
import { COARSE, ViewerPage } from './viewer_page';

/** In the page: returns the visible inputs of numbers that are narrower than their content. */
function clippedNumbers(): string[] {
  return [...document.querySelectorAll<HTMLInputElement>('input[type=number]')]
    .filter((input) => input.checkVisibility() && input.scrollWidth > input.clientWidth)
    .map((input) => `${input.name} ${input.value}`);
}

describe('the page', () => {
  const stage = new Stage(['--demo', 'layers'], COARSE);
  let viewer: ViewerPage;

  beforeAll(async () => {
    viewer = await stage.open({ viewport: { width: 1024, height: 720 } });
    await viewer.live('d1-layers');
  });

  it('shows numbers whole, with units that are no part of their names', async () => {
    const { page } = viewer;
    let numbers = 0;
    for (const tab of ['Tools', 'Materials']) {
      await page.getByRole('tab', { name: tab }).click();
      await page.evaluate(() => document.querySelectorAll('details').forEach((details) => (details.open = true)));
      expect(await page.evaluate(clippedNumbers), tab).toEqual([]);
      numbers += await page.locator('input[type=number]:visible').count();
      const labels = await page.locator('.panel:visible label.field > span').allTextContents();
      expect(labels.filter((words) => /_| (j|pa|m|c|w|v|n)( |$)|m2|m3/.test(words)), tab).toEqual([]);
      const units = await page.locator('.panel:visible label.field > small').allTextContents();
      expect(units.filter((unit) => unit.includes('^')), tab).toEqual([]);
    }
    expect(numbers).toBeGreaterThan(12);
  });

  it('says how many frames were skipped without punctuation before it, also when paused', async () => {
    const { page } = viewer;
    await page.getByRole('tab', { name: 'Plots' }).click();
    const counts = page.locator('#panel-plots output').filter({ hasText: 'skipped' });
    await viewer.pause();
    await counts.getByText(/^\w[^;]*, \d+ skipped$/).waitFor();
    await viewer.resume();
    await counts.getByText(/^\w[^;]*, \d+ skipped$/).waitFor();
  });

  it('asks an admin before a tool is taken from its driver', async () => {
    const driver = await ViewerPage.openFirst(stage.browser, `${stage.daemon.url}?session=d1-layers`, COARSE);
    await driver.live('d1-layers');
    await driver.page.getByRole('button', { name: 'Take the tool' }).click();
    await driver.until(() => window.cautery.driving, null, 'the tool is taken');
    const { page } = viewer;
    await page.getByRole('tab', { name: 'Tools' }).click();
    await page.locator('#panel-tools .take').click();
    await page.locator('dialog').getByText('Its energy goes off').waitFor();
    await page.keyboard.press('Escape');
    expect((await driver.state()).driving).toBe(true);
    await page.locator('#panel-tools .take').click();
    await page.locator('dialog').getByRole('button', { name: 'Take it' }).click();
    await viewer.until(() => window.cautery.driving, null, 'it is the admin’s');
    await driver.until(() => !window.cautery.driving, null, 'and no longer the driver’s');
    await driver.close();
  });

  it('shows messages over what covers the picture, and beside its buttons', async () => {
    const { page } = viewer;
    await page.getByRole('tab', { name: 'Sessions' }).click();
    await page.getByRole('button', { name: 'Destroy d1-layers' }).click();
    await page.locator('dialog').getByRole('button', { name: 'Destroy' }).click();
    await page.locator('#veil').getByText('No session is open').waitFor();
    const notice = page.locator('#notices').getByText('d1-layers no longer exists.');
    await notice.waitFor();
    const [box, handles] = [(await notice.boundingBox())!, (await page.locator('#handles').boundingBox())!];
    const onTop = await page.evaluate(([x, y]) => document.elementFromPoint(x, y)?.closest('#notices') !== null, [box.x + box.width / 2, box.y + box.height / 2]);
    expect(onTop).toBe(true);
    expect(box.y + box.height <= handles.y || box.x >= handles.x + handles.width).toBe(true);
    await viewer.close();
  });
});
