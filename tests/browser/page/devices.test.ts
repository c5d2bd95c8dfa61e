// SPDX-License-Identifier: GPL-3.0-or-later
// Tests a foot pedal, which is a keyboard with one key, and a 3D mouse by WebHID. The browser's chooser cannot be
// automated, so a fake answers it. On the page, only a person can answer it.

import { Stage } from './stage';
import { COARSE, ViewerPage } from './viewer_page';

/** In the page, before its scripts: installs a WebHID with one 3D mouse that tests control. */
function holdSpaceMouse(): void {
  const device = Object.assign(new EventTarget(), {
    productName: 'Test SpaceMouse', opened: false,
    open(this: { opened: boolean }) {
      this.opened = true;
      return Promise.resolve();
    },
  });
  const report = (reportId: number, values: number[]): void => {
    const data = new DataView(new ArrayBuffer(2 * values.length));
    values.forEach((value, i) => data.setInt16(2 * i, value, true));
    device.dispatchEvent(Object.assign(new Event('inputreport'), { reportId, data }));
  };
  const hid = Object.assign(new EventTarget(), { getDevices: () => Promise.resolve([]), requestDevice: () => Promise.resolve([device]) });
  Object.defineProperty(navigator, 'hid', { value: hid });
  const tell = (what: string): boolean => hid.dispatchEvent(Object.assign(new Event(what), { device }));
  Object.assign(window, { capReports: report, unplug: () => tell('disconnect'), plugIn: () => tell('connect') });
}

describe('devices beside mouse and keys', () => {
  const stage = new Stage(['--demo', 'fascia'], COARSE);
  let viewer: ViewerPage;

  const report = (id: number, values: number[]): Promise<void> =>
    viewer.page.evaluate(([number, axes]) => (window as unknown as { capReports(id: number, values: number[]): void }).capReports(number, axes), [id, values] as const);

  beforeAll(async () => {
    viewer = await stage.openFirst({ before: holdSpaceMouse });
    await viewer.live('d1-fascia');
    await viewer.page.locator('#devices > summary').click();
  });

  it('a pedal reaches the page once, and is energy while it is down, wherever the focus is', async () => {
    const { page } = viewer;
    await page.getByRole('button', { name: 'Choose the pedal’s key' }).click();
    await page.keyboard.press('w');
    expect(await page.locator('#pedal').textContent()).toContain('W is already used');
    await page.keyboard.press('F9');
    expect(await page.locator('#pedal').textContent()).toContain('The pedal is the key F9');
    await page.reload();
    await viewer.live('d1-fascia');
    await page.locator('#devices > summary').click(); // this click gives the focus to the summary
    await page.keyboard.down('F9');
    await viewer.until(() => window.cautery.energized, null, 'energy is on');
    await page.keyboard.up('F9');
    await viewer.until(() => !window.cautery.energized, null, 'energy is off');
  });

  it('a 3D mouse leads the tool with its cap and heats with its button, as long as it is plugged in', async () => {
    const { page } = viewer;
    expect(await page.locator('#space-mouse').textContent()).toContain('Choose the mouse there');
    await page.getByRole('button', { name: 'Choose the 3D mouse' }).click();
    await page.locator('#space-mouse').getByText('Test SpaceMouse moves the tool').waitFor();
    const [x] = (await viewer.state()).tip;
    await report(1, [350, 0, 0]);
    await viewer.until((from) => window.cautery.driving && window.cautery.tip[0] > from, x + 0.02, 'the cap leads it to the right');
    await report(1, [0, 0, 0]);
    await report(3, [1]);
    await viewer.until(() => window.cautery.energized, null, 'energy is on');
    await page.evaluate(() => (window as unknown as { unplug(): void }).unplug());
    await viewer.until(() => !window.cautery.energized, null, 'energy is off without it');
    expect(await page.locator('#space-mouse').textContent()).toContain('The cap of a 3D mouse moves');
    await page.evaluate(() => (window as unknown as { plugIn(): void }).plugIn()); // the user need not choose the device again
    await page.locator('#space-mouse').getByText('Test SpaceMouse moves the tool').waitFor();
    await report(3, [1]); // the button is still down from before, so this is not a new press
    const { tick } = await viewer.state();
    await viewer.until((from) => window.cautery.tick > from + 30, tick, 'half a second passes');
    expect((await viewer.state()).energized).toBe(false);
    await report(3, [0]);
    await report(3, [1]);
    await viewer.until(() => window.cautery.energized, null, 'energy is on again');
    await report(3, [0]);
    await viewer.until(() => !window.cautery.energized, null, 'energy is off');
    expect(viewer.complaints).toEqual([]);
  });
});
