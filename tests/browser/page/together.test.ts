// SPDX-License-Identifier: GPL-3.0-or-later
// Tests two pages on one session. They agree. Only the driver's controls are live, and other users can ask for the
// tool. A page that is hidden loses its energy. After a kill, the daemon and the pages come back.

import { Stage } from './stage';
import { COARSE, ViewerPage } from './viewer_page';

const HOT_C = 900;
const HOTTER_C = 950;
const NEAR_PX = 120; // largest distance of a message that is read without looking elsewhere

describe('two pages on one session', () => {
  const stage = new Stage(['--demo', 'fascia'], COARSE);
  let driver: ViewerPage;
  let watcher: ViewerPage;

  beforeAll(async () => {
    driver = await stage.open();
    await driver.live('d1-fascia');
    watcher = await ViewerPage.open(stage.browser, `${stage.daemon.url}?session=d1-fascia`, COARSE);
    await watcher.live('d1-fascia');
  });

  it('keeps what one is typing while the driver changes the tool', async () => {
    await driver.page.bringToFront();
    await driver.heatTool(HOT_C);
    await watcher.page.getByRole('tab', { name: 'Tools' }).click();
    await watcher.toolInput('friction').fill('0.35');
    await driver.setTool('temperature_c', HOTTER_C);
    await watcher.until((wanted) => window.cautery.tool?.temperature_c === wanted, HOTTER_C, 'the watcher knows');
    expect(await watcher.toolInput('temperature_c').inputValue()).toBe(String(HOTTER_C));
    expect(await watcher.toolInput('friction').inputValue()).toBe('0.35');
  });

  it('lets only the driver heat', async () => {
    await driver.grab([0, 0, 0]);
    expect(await driver.page.locator('#energy').isEnabled()).toBe(true);
    expect(await watcher.page.locator('#energy').isDisabled()).toBe(true);
    expect((await watcher.state()).driving).toBe(false);
  });

  it('names the driver at the tool, and offers to ask', async () => {
    const { page } = watcher;
    const at = await watcher.project([0.01, 0.01, 0]);
    await page.mouse.move(at.x, at.y);
    await page.mouse.down();
    await watcher.until(() => /^[A-Z][a-z]+ \d\d is using the hook\./.test(document.querySelector('#said')?.textContent ?? ''), null, 'who has it');
    const box = (await page.locator('#said').boundingBox())!;
    expect(Math.abs(box.y + box.height / 2 - at.y)).toBeLessThan(NEAR_PX);
    expect(await page.locator('#said button').textContent()).toContain('Ask');
    await page.mouse.up();
    const names = await Promise.all([driver, watcher].map(({ page: of }) => of.evaluate(() => sessionStorage.getItem('guest'))));
    expect(names[0]).not.toBe(names[1]);
    expect(await page.locator('#said').textContent()).toContain(names[0]);
  });

  it('agrees on what is cut and where the tool is', async () => {
    await driver.cut(0, 0, 0, 0.012, 4);
    await driver.page.getByRole('button', { name: 'Pause' }).click();
    for (const page of [driver, watcher]) await page.until(() => window.cautery.paused, null, 'paused');
    const { tick } = await driver.state();
    await watcher.until((wanted) => window.cautery.tick === wanted, tick, 'the same tick');
    const [one, other] = [await driver.state(), await watcher.state()];
    expect(other.drawnFaces).toEqual(one.drawnFaces);
    expect(other.tip).toEqual(one.tip);
    expect(other.epoch).toBe(one.epoch);
    await driver.resume();
  });

  it('asks the driver, who hands the tool over', async () => {
    await watcher.page.getByRole('tab', { name: 'Tools' }).click();
    await watcher.page.getByRole('button', { name: 'Ask its driver' }).click();
    await driver.page.getByRole('button', { name: 'Hand over' }).click();
    await watcher.until(() => window.cautery.driving, null, 'the watcher drives');
    await driver.until(() => !window.cautery.driving, null, 'the driver no longer does');
  });

  it('cuts energy when the page loses the focus', async () => {
    await watcher.page.bringToFront();
    await watcher.grab([-0.04, 0.03, 0]); // the place is beside the cut, which gapes beyond its ends
    await watcher.page.keyboard.down('Space');
    await watcher.until(() => window.cautery.energized, null, 'energy is on');
    const said = await watcher.page.evaluate(() => {
      window.dispatchEvent(new Event('blur'));
      return document.querySelector('#said')?.textContent; // the message is shown for some seconds
    });
    expect(said).toContain('Energy is off');
    await watcher.until(() => !window.cautery.energized, null, 'energy is off');
    await watcher.page.keyboard.up('Space');
    await watcher.page.mouse.up();
  });

  it('says that the daemon is lost, and comes back to the same tissue', async () => {
    await watcher.page.getByRole('button', { name: 'Pause' }).click();
    for (const page of [driver, watcher]) await page.until(() => window.cautery.paused, null, 'paused');
    const { tick } = await watcher.state();
    await driver.until((wanted) => window.cautery.tick === wanted, tick, 'the same tick');
    // Frames may be ahead of the store. The answer to the button's request comes when the store has the pause.
    await watcher.until(() => document.querySelector('[aria-busy=true]') === null, null, 'the pause is stored');
    const before = await driver.state();
    await stage.daemon.kill();
    await driver.until(() => window.cautery.link === 'lost', null, 'lost');
    // The test waits for the time between two attempts to connect, in which the page reports this.
    await driver.until(() => document.querySelector('#link')?.textContent?.includes('No connection') === true, null, 'the page says so');
    await stage.daemon.start();
    for (const page of [driver, watcher]) {
      await page.until((epoch) => window.cautery.link === 'online' && window.cautery.epoch !== epoch, before.epoch, 'a new epoch');
      const after = await page.state();
      expect(after.tick).toBe(before.tick);
      expect(after.drawnFaces).toEqual(before.drawnFaces);
      expect(after.tip).toEqual(before.tip);
      expect(after.energized).toBe(false);
    }
  });
});
