// SPDX-License-Identifier: GPL-3.0-or-later
// The layers scene is cut through its fascia; the picture is one that README.md can show.
import type { Browser } from 'playwright-core';

import { Daemon } from './daemon';
import { launch, ViewerPage } from './viewer_page';

const HOT_C = 1200;
const FASCIA_Z_M = 0.002;
const REACH_M = 0.025;
const STEP_M = 0.0005;
const DRAW_S = 4; // of simulated time: as hot as this, it does what half a minute does at 170 degC

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

  it('opens the fascia, leaves strands across it and the fat under it', async () => {
    const viewer = await ViewerPage.open(browser, daemon.url);
    await viewer.live('d1-layers');
    const { drawnFaces: whole } = await viewer.state();
    await viewer.heatTool(HOT_C);
    await viewer.grab([-REACH_M, 0, FASCIA_Z_M]);
    await viewer.draw(0, FASCIA_Z_M, -REACH_M, REACH_M, DRAW_S);
    const { drawnFaces: cut } = await viewer.state();
    expect(cut['fascia']).toBeLessThan(whole['fascia'] - 50);
    expect(cut['membrane']).toBeGreaterThan(0.8 * whole['membrane']);
    await viewer.page.keyboard.down('KeyS');
    await viewer.until(() => window.cautery.tip[2] > 0.03, null, 'the hook is lifted');
    await viewer.page.keyboard.up('KeyS');
    await viewer.page.getByRole('button', { name: 'Pause' }).click();
    await viewer.until(() => window.cautery.paused && window.cautery.idle, null, 'paused, and the sharp picture');
    expect(await strandsAcross(viewer)).toBeGreaterThan(1);
    await viewer.screenshot('layers-cut');
    await viewer.page.locator('#picture').hover();
    await viewer.zoom(6);
    await viewer.page.emulateMedia({ colorScheme: 'light' });
    await viewer.drawn();
    await viewer.until(() => window.cautery.idle, null, 'the light picture');
    await viewer.screenshot('layers-strands');
  });
});

/** Pieces of fascia on the line of the cut, between its ends, that gaps part from each other. */
function strandsAcross(viewer: ViewerPage): Promise<number> {
  return viewer.page.evaluate(([reach, step]) => {
    let strands = 0;
    let gap = false;
    let tissue = false;
    for (let x = -reach; x <= reach; x += step) {
      const here = window.cautery.drawnAt('fascia', x, 0);
      if (here && gap && !tissue) strands++; // as yet: it counts if another gap follows
      if (!here && tissue) gap = true;
      if (!here) gap = true;
      tissue = here;
    }
    return tissue && strands > 0 ? strands - 1 : strands;
  }, [REACH_M, STEP_M] as const);
}
