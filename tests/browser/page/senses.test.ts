// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that smoke and sound exist while tissue burns, and end afterwards. Each has a box that turns it off. With
// reduced motion there is no smoke. The alarm sounds if a page loses its daemon with energy on.
import { Stage } from './stage';
import { COARSE, MOVING, ViewerPage } from './viewer_page';

const CUT_HZ = 660;
const PLACE: [number, number, number] = [0.01, 0.01, 0];
const ELSEWHERE: [number, number, number] = [0.01, -0.005, 0]; // a place where tissue is still whole
const ON_M = 0.0005; // length of a part of the way
const PARTS = 60;
const TICKS = 6; // least number of ticks for each part
const PICTURES = 2; // least number of pictures for each part: smoke and sound follow the contact that a picture shows

declare global {
  interface Window {
    senses: { together: boolean; puffs: number };
  }
}

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

/** From now on, notes in the page whether tone and sizzle ever exist together, and the largest amount of smoke. */
const watch = (viewer: ViewerPage): Promise<void> => viewer.page.evaluate((hz) => {
  window.senses = { together: false, puffs: 0 };
  setInterval(() => {
    const { heard, puffs } = window.cautery;
    window.senses.together ||= heard.toneHz === hz && heard.sizzle > 0;
    window.senses.puffs = Math.max(window.senses.puffs, puffs);
  }, 5);
}, CUT_HZ);
/** Leads the hot tool through tissue until the page has noted both. The tool must move, because the tissue that it
 * touches is soon gone. */
const leadOn = async (viewer: ViewerPage, [x, y, z]: [number, number, number]): Promise<void> => {
  const noted = (): Promise<boolean> => viewer.page.evaluate(() => window.senses.together && window.senses.puffs > 2);
  for (let part = 1; part <= PARTS && !(await noted()); part++) {
    const at = await viewer.project([x - ON_M * part, y, z]);
    await viewer.page.mouse.move(at.x, at.y);
    const { tick, picturesDrawn } = await viewer.state();
    await viewer.until((then) => window.cautery.tick >= then.tick && window.cautery.picturesDrawn >= then.picture,
      { tick: tick + TICKS, picture: picturesDrawn + PICTURES }, 'time passes in the picture');
  }
};

describe('smoke and sound', () => {
  const stage = new Stage(['--demo', 'fascia'], COARSE);

  it('are there while tissue burns, and end', async () => {
    const viewer = await stage.openFirst(MOVING);
    await watch(viewer);
    await burn(viewer, PLACE);
    await leadOn(viewer, PLACE);
    await viewer.until(() => window.senses.together, null, 'a tone and a sizzle');
    await viewer.until(() => window.senses.puffs > 2, null, 'smoke');
    await viewer.page.getByRole('checkbox', { name: 'Activation tone' }).evaluate((box: HTMLInputElement) => box.click());
    await viewer.until(() => window.cautery.heard.toneHz === 0 && window.cautery.energized, null, 'no tone, with energy on');
    await stop(viewer);
    await viewer.until(() => window.cautery.heard.sizzle === 0 && window.cautery.puffs === 0, null, 'it is quiet and clear');
    expect((await viewer.state()).alarms).toBe(0);
    await viewer.page.getByRole('button', { name: 'Release the tool' }).click();
    await viewer.until(() => !window.cautery.driving, null, 'the tool is free for the next page');
    await viewer.page.reload();
    await viewer.live('d1-fascia');
    expect(await viewer.page.getByRole('checkbox', { name: 'Activation tone' }).isChecked()).toBe(false);
    expect(await viewer.page.getByRole('checkbox', { name: 'Smoke' }).isChecked()).toBe(true);
    expect(viewer.complaints).toEqual([]);
    await viewer.close();
  });

  it('are without smoke for who wants less motion, and alarm when the daemon is lost with energy on', async () => {
    const viewer = await stage.openFirst();
    await burn(viewer, ELSEWHERE);
    await viewer.until(() => window.cautery.heard.toneHz > 0, null, 'a tone');
    await viewer.page.evaluate(() => new Promise((resolve) => setTimeout(resolve, 500))); // smoke would appear within this time
    expect((await viewer.state()).puffs).toBe(0);
    await stage.daemon.kill();
    await viewer.until(() => window.cautery.alarms === 1 && window.cautery.heard.toneHz === 0, null, 'the alarm');
    await viewer.close();
  });
});
