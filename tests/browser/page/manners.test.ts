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
const LAYOUT_SHIFT_MAX = 0.1; // "good" by the web's own measure, web.dev/cls
const COLOUR_RULES = ['color-contrast', 'link-in-text-block']; // all that differs between dark and light
const PHONE = { viewport: { width: 390, height: 780 }, hasTouch: true, isMobile: true };
const distribution = fileURLToPath(new URL('../../../clients/web/dist', import.meta.url));

/** All that a panel can show is shown. */
async function openAll(viewer: ViewerPage): Promise<void> {
  await viewer.page.evaluate(() => document.querySelectorAll('details').forEach((details) => (details.open = true)));
}

async function seriousFaults(viewer: ViewerPage, rules: string[] = []): Promise<string[]> {
  const axe = new AxeBuilder({ page: viewer.page });
  if (rules.length > 0) axe.withRules(rules);
  const { violations } = await axe.analyze();
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
    const first = await ViewerPage.open(browser, daemon.url);
    await first.live('d1-layers');
    await first.page.getByRole('button', { name: 'Pause' }).click(); // the processor is the browser's from here on
    await first.until(() => window.cautery.paused, null, 'paused');
    await first.close();
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
      await openAll(viewer);
      expect(await seriousFaults(viewer, name === 'light' ? COLOUR_RULES : []), tab).toEqual([]);
    }
    await viewer.close();
  });

  it('does not jump about while it comes up', async () => {
    const viewer = await ViewerPage.open(browser, daemon.url, {}, 'no');
    await viewer.live('d1-layers');
    const shift = await viewer.page.evaluate(
      () =>
        new Promise<number>((resolve) => {
          let sum = 0;
          const add = (entries: PerformanceEntry[]): void => {
            for (const entry of entries) sum += (entry as PerformanceEntry & { value: number }).value;
          };
          const observer = new PerformanceObserver((list) => add(list.getEntries()));
          observer.observe({ type: 'layout-shift', buffered: true });
          requestAnimationFrame(() =>
            requestAnimationFrame(() => {
              add(observer.takeRecords());
              resolve(sum);
            }),
          );
        }),
    );
    const paint = await viewer.page.evaluate(() => performance.getEntriesByName('first-contentful-paint')[0].startTime);
    process.stdout.write(`first paint after ${paint.toFixed(0)} ms, layout shift ${shift.toFixed(3)}\n`);
    expect(shift).toBeLessThan(LAYOUT_SHIFT_MAX);
    await viewer.close();
  });

  it('fits a phone in portrait', async () => {
    const viewer = await ViewerPage.open(browser, daemon.url, PHONE);
    await viewer.live('d1-layers');
    const overflow = await viewer.page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
    expect(overflow).toBeLessThanOrEqual(0);
    const picture = await viewer.page.locator('#picture').boundingBox();
    expect(picture?.height).toBeGreaterThan(250);
    await viewer.until(() => window.cautery.idle, null, 'the sharp picture');
    await viewer.screenshot('layers-on-a-phone');
    await viewer.close();
  });

  it('reaches every control by Tab', async () => {
    const viewer = await ViewerPage.open(browser, daemon.url);
    await viewer.live('d1-layers');
    for (const tab of TABS) {
      await viewer.page.getByRole('tab', { name: tab }).click();
      await openAll(viewer);
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
