// SPDX-License-Identifier: GPL-3.0-or-later
// Smoke and sound: there while tissue burns, gone afterwards, each turned off by its box, and no smoke for who wants less
// motion. The alarm comes where a page loses its daemon with energy on.
import { Stage } from './stage';
import { MOVING, ViewerPage } from './viewer_page';

const CUT_HZ = 660;

const burn = async (viewer: ViewerPage, at: [number, number, number]): Promise<void> => {
  await viewer.live('d1-fascia');
  await viewer.grab(at);
  await viewer.page.keyboard.down('Space');
  await viewer.until(() => window.cautery.energized, null, 'energy is on');
};
const stop = async (viewer: ViewerPage): Promise<void> => {
  await viewer.page.keyboard.up('Space');
  await viewer.page.mouse.up();
  await viewer.until(() => !window.cautery.energized, null, 'energy is off');
};

describe('smoke and sound', () => {
  const stage = new Stage(['--demo', 'fascia']);

  it('are there while tissue burns, and end', async () => {
    const viewer = await stage.openFirst(MOVING);
    await burn(viewer, [0.01, 0.01, 0]);
    await viewer.until((hz) => window.cautery.heard.toneHz === hz && window.cautery.heard.sizzle > 0, CUT_HZ, 'a tone and a sizzle');
    await viewer.until(() => window.cautery.puffs > 2, null, 'smoke');
    await viewer.page.getByRole('checkbox', { name: 'Activation tone' }).evaluate((box: HTMLInputElement) => box.click());
    await viewer.until(() => window.cautery.heard.toneHz === 0 && window.cautery.energized, null, 'no tone, with energy on');
    await stop(viewer);
    await viewer.until(() => window.cautery.heard.sizzle === 0 && window.cautery.puffs === 0, null, 'it is quiet and clear');
    expect((await viewer.state()).alarms).toBe(0);
    await viewer.page.reload();
    await viewer.live('d1-fascia');
    expect(await viewer.page.getByRole('checkbox', { name: 'Activation tone' }).isChecked()).toBe(false);
    expect(await viewer.page.getByRole('checkbox', { name: 'Smoke' }).isChecked()).toBe(true);
    expect(viewer.complaints).toEqual([]);
    await viewer.close();
  });
});

describe('smoke and sound of a page that loses its daemon', () => {
  const stage = new Stage(['--demo', 'fascia']);

  it('are without smoke for who wants less motion, and alarm when the daemon is lost with energy on', async () => {
    const viewer = await stage.openFirst();
    await burn(viewer, [0.01, 0.01, 0]);
    await viewer.until(() => window.cautery.heard.toneHz > 0, null, 'a tone');
    await viewer.page.evaluate(() => new Promise((resolve) => setTimeout(resolve, 500))); // smoke would be there
    expect((await viewer.state()).puffs).toBe(0);
    await stage.daemon.kill();
    await viewer.until(() => window.cautery.alarms === 1 && window.cautery.heard.toneHz === 0, null, 'the alarm');
    await viewer.close();
  });
});
