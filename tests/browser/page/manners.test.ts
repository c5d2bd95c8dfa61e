// SPDX-License-Identifier: GPL-3.0-or-later
// No serious accessibility fault in any panel, dark or light, wide or on a phone; every control can be
// reached by keyboard; the bundle is small.
import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';

import AxeBuilder from '@axe-core/playwright';
import type { Browser } from 'playwright-core';

import { Daemon } from './daemon';
import { launch, ViewerPage } from './viewer_page';

const TABS = ['Sessions', 'Tools', 'Materials', 'View', 'Plots'];
const BUNDLE_BYTES_MAX = 1_000_000; // compressed
const PHONE = { viewport: { width: 390, height: 780 }, hasTouch: true, isMobile: true };
const distribution = fileURLToPath(new URL('../../../clients/web/dist', import.meta.url));

async function seriousFaults(viewer: ViewerPage): Promise<string[]> {
  const { violations } = await new AxeBuilder({ page: viewer.page }).analyze();
  return violations
    .filter(({ impact }) => impact === 'serious' || impact === 'critical')
    .map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.html.slice(0, 120)).join(' | ')}`);
}

describe('manners', () => {
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

  it.each([
    ['dark', { colorScheme: 'dark' as const }],
    ['light', { colorScheme: 'light' as const }],
    ['on a phone', { ...PHONE, colorScheme: 'dark' as const }],
  ])('has no serious accessibility fault, %s', async (name, options) => {
    const viewer = await ViewerPage.open(browser, daemon.url, options, 'no');
    await viewer.live('d1-layers');
    for (const tab of name === 'on a phone' ? ['Sessions', 'Tools'] : TABS) {
      await viewer.page.getByRole('tab', { name: tab }).click();
      expect(await seriousFaults(viewer), tab).toEqual([]);
    }
    await viewer.page.getByRole('tab', { name: 'Sessions' }).click();
    await viewer.screenshot(`layers-${name.replaceAll(' ', '-')}`);
    await viewer.close();
  });

  it('fits a phone in portrait', async () => {
    const viewer = await ViewerPage.open(browser, daemon.url, PHONE);
    await viewer.live('d1-layers');
    const overflow = await viewer.page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
    expect(overflow).toBeLessThanOrEqual(0);
    const picture = await viewer.page.locator('#picture').boundingBox();
    expect(picture?.height).toBeGreaterThan(250);
    await viewer.close();
  });

  it('reaches every control by Tab', async () => {
    const viewer = await ViewerPage.open(browser, daemon.url);
    await viewer.live('d1-layers');
    for (const tab of TABS) {
      await viewer.page.getByRole('tab', { name: tab }).click();
      const unreachable = await viewer.page.evaluate(() =>
        [...document.querySelectorAll<HTMLElement>('button, input, select, summary, canvas#picture')]
          .filter((control) => control.checkVisibility() && control.tabIndex < 0 && control.getAttribute('role') !== 'tab')
          .map((control) => control.outerHTML.slice(0, 100)),
      );
      expect(unreachable, tab).toEqual([]);
    }
    await viewer.close();
  });

  it('is a small bundle', () => {
    const files = readdirSync(distribution, { recursive: true, withFileTypes: true }).filter((entry) => entry.isFile());
    const bytes = files.reduce((sum, file) => sum + gzipSync(readFileSync(join(file.path, file.name))).byteLength, 0);
    process.stdout.write(`bundle: ${bytes} bytes compressed\n`);
    expect(bytes).toBeLessThan(BUNDLE_BYTES_MAX);
  });
});
