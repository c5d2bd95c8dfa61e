// SPDX-License-Identifier: GPL-3.0-or-later
// The layers scene is cut through its fascia; the picture is one that README.md can show.
import type { Browser } from 'playwright-core';

import { Daemon } from './daemon';
import { launch, ViewerPage } from './viewer_page';

const HOT_C = 700;
const FASCIA_Z_M = 0.002;

describe('a cut in the layers', () => {
  const daemon = new Daemon(['--demo', 'layers']);
  let browser: Browser;

  beforeAll(async () => {
    await daemon.start();
    browser = await launch();
  });
  afterAll(async () => {
    await browser.close();
    await daemon.end();
  });

  it('opens the fascia and leaves the fat under it', async () => {
    const viewer = await ViewerPage.open(browser, daemon.url);
    await viewer.live('d1-layers');
    const { drawnFaces: whole } = await viewer.state();
    await viewer.heatTool(HOT_C);
    await viewer.grab([-0.02, 0, FASCIA_Z_M]);
    await viewer.cut(0, FASCIA_Z_M, -0.02, 0.02, 8);
    await viewer.screenshot('layers-hot');
    const { drawnFaces: cut } = await viewer.state();
    expect(cut['fascia']).toBeLessThan(whole['fascia'] - 20);
    expect(cut['membrane']).toBeGreaterThan(0.8 * whole['membrane']);
    await viewer.page.keyboard.down('KeyS');
    await viewer.until(() => window.cautery.tip[2] > 0.03, null, 'the hook is lifted');
    await viewer.page.keyboard.up('KeyS');
    await viewer.page.getByRole('button', { name: 'Pause' }).click();
    await viewer.until(() => window.cautery.paused && window.cautery.idle, null, 'paused, and the sharp picture');
    await viewer.screenshot('layers-cut');
  });
});
