// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that a refused action is reported at once, at the tool, where the user looks.

import { Stage } from './stage';
import { COARSE, ViewerPage } from './viewer_page';

const DEADLINE_S = 1;
const BUSY_MS = 2000;

describe('energy that a busy machine cuts', () => {
  const stage = new Stage(['--demo', 'fascia', '--browser-deadline-s', String(DEADLINE_S)], COARSE);
  let viewer: ViewerPage;

  beforeAll(async () => {
    viewer = await stage.open();
    await viewer.live('d1-fascia');
  });

  it('explains why energy is off, and a fresh press brings it back', async () => {
    const { page } = viewer;
    await page.keyboard.down('Space');
    await viewer.until(() => window.cautery.energized, null, 'energy is on');
    await page.evaluate((ms) => {
      const end = performance.now() + ms;
      while (performance.now() < end); // the page hangs while the key is held
    }, BUSY_MS);
    await viewer.until(() => document.querySelector('#said')?.textContent?.includes('Energy is off') === true, null, 'it is said');
    const said = await page.locator('#said').textContent();
    expect(said).toContain('the server did not hear from this page in time');
    expect(said).toContain('Release Space and press it again.');
    expect((await viewer.state()).energized).toBe(false);
    const { tick } = await viewer.state();
    await viewer.until((later) => window.cautery.tick > later, tick + 60, 'a second later');
    expect(await page.locator('#said').textContent()).toContain('Energy is off'); // the message stays as long as the key is held
    await page.keyboard.up('Space');
    expect(await page.locator('#said').textContent()).not.toContain('Energy is off');
    await page.keyboard.down('Space');
    await viewer.until(() => window.cautery.energized, null, 'energy is on again');
    await page.keyboard.up('Space');
    await viewer.until(() => !window.cautery.energized, null, 'energy is off');
  });
});
