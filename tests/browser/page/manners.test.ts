// SPDX-License-Identifier: GPL-3.0-or-later
// No accessibility fault in any panel, dark or light, wide or on a phone; every control can be reached by
// keyboard and hit by a finger; text may be twice as large; the bundle is small.
import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';

import AxeBuilder from '@axe-core/playwright';

import { Stage } from './stage';
import { COARSE, MOVING, ViewerPage } from './viewer_page';

const TABS = ['Sessions', 'Tools', 'Materials', 'View', 'Plots'];
const BUNDLE_BYTES_MAX = 1_000_000; // compressed
const LAYOUT_SHIFT_MAX = 0.1; // "good" by the web's own measure, web.dev/cls
const COLOUR_RULES = ['color-contrast', 'link-in-text-block']; // all that differs between dark and light
const PHONE = { viewport: { width: 390, height: 780 }, hasTouch: true, isMobile: true };
const distribution = fileURLToPath(new URL('../../../clients/web/dist', import.meta.url));

/** Screens of desks, tablets and phones. */
const COMMON_SIZES = [[1920, 1080], [1366, 768], [1024, 768], [820, 1180], [390, 780], [360, 640], [780, 390]] as const;
const TARGET_PX = 44; // what a finger hits

/** All that a panel can show is shown. */
async function openAll(viewer: ViewerPage): Promise<void> {
  await viewer.page.evaluate(() => document.querySelectorAll('details').forEach((details) => (details.open = true)));
}

/** In the page: elements whose own words are wider than they are, and choices that do not show all of theirs. */
function clippedWords(): string[] {
  const pen = document.createElement('canvas').getContext('2d')!;
  const ownWords = (one: Element): boolean => [...one.childNodes].some((node) => node.nodeType === Node.TEXT_NODE && node.textContent!.trim() !== '');
  const wide = (one: HTMLElement): boolean => {
    const style = getComputedStyle(one);
    if (one instanceof HTMLSelectElement) {
      pen.font = style.font;
      return pen.measureText(one.selectedOptions[0]?.text ?? '').width > one.clientWidth - parseFloat(style.paddingLeft) - parseFloat(style.paddingRight);
    }
    return style.display !== 'inline' && one.scrollWidth > one.clientWidth + 1;
  };
  return [...document.body.querySelectorAll<HTMLElement>('*')]
    .filter((one) => (ownWords(one) || one instanceof HTMLSelectElement) && one.checkVisibility() && !one.matches('.reading, .unseen, option, noscript, script'))
    .filter((one) => getComputedStyle(one).clipPath === 'none' && wide(one)) // clipped away are words for screen readers alone
    .map((one) => one.outerHTML.slice(0, 100));
}

/** All that axe finds in a part of the page, its best practices included. An analysis of the whole page takes seconds. */
async function faults(viewer: ViewerPage, part: string, rules: string[] = []): Promise<string[]> {
  // Details of what passes would take half of the time, and so would a second page, which only frames of other hosts need.
  const axe = new AxeBuilder({ page: viewer.page }).options({ resultTypes: ['violations'] }).setLegacyMode().include(part);
  if (rules.length > 0) axe.withRules(rules);
  const { violations } = await axe.analyze();
  return violations.map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.html.slice(0, 120)).join(' | ')}`);
}

describe('manners', () => {
  const stage = new Stage(['--demo', 'layers'], COARSE);

  beforeAll(async () => {
    const first = await stage.open();
    await first.live('d1-layers');
    await first.pause(); // the processor is the browser's from here on
    await first.close();
  });

  it.each([
    ['dark', { colorScheme: 'dark' as const }],
    ['light', { colorScheme: 'light' as const }],
    ['on a phone', { ...PHONE, colorScheme: 'dark' as const }],
  ])('has no accessibility fault, %s', async (name, options) => {
    const viewer = await stage.open(options);
    await viewer.live('d1-layers');
    await viewer.page.getByRole('button', { name: 'Operate' }).click();
    await viewer.page.getByRole('button', { name: 'Help' }).click();
    expect(await faults(viewer, 'html'), 'Operate').toEqual([]);
    await viewer.page.getByRole('button', { name: 'Research' }).click();
    const rules = name === 'light' ? COLOUR_RULES : [];
    expect(await faults(viewer, 'html', rules), 'Research').toEqual([]);
    for (const tab of name === 'on a phone' ? ['Sessions', 'Tools'] : TABS) {
      await viewer.page.getByRole('tab', { name: tab }).click();
      await openAll(viewer);
      expect(await faults(viewer, `#panel-${tab.toLowerCase()}`, rules), tab).toEqual([]);
    }
    await viewer.close();
  });

  it('does not jump about while it comes up', async () => {
    const viewer = await stage.openFirst(MOVING);
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
    const viewer = await stage.openFirst(PHONE);
    await viewer.live('d1-layers');
    const overflow = await viewer.page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
    expect(overflow).toBeLessThanOrEqual(0);
    const picture = await viewer.page.locator('#picture').boundingBox();
    expect(picture?.height).toBeGreaterThan(250);
    await viewer.until(() => window.cautery.idle, null, 'the sharp picture');
    await viewer.close();
  });

  it.each([['portrait', { width: 390, height: 780 }], ['landscape', { width: 780, height: 390 }]])(
    'has targets that a finger hits, on a phone in %s',
    async (_name, viewport) => {
      const viewer = await stage.openFirst({ ...PHONE, viewport });
      await viewer.live('d1-layers');
      for (const mode of ['Operate', 'Research']) {
        await viewer.page.getByRole('button', { name: mode }).tap();
        await openAll(viewer);
        const small = await viewer.page.evaluate((least) =>
          [...document.querySelectorAll<HTMLElement>('button, select, summary, label.check, input:not([type=checkbox])')]
            .filter((control) => control.checkVisibility() && !control.matches('.unseen, dialog *'))
            .map((control) => ({ box: control.getBoundingClientRect(), html: control.outerHTML.slice(0, 90) }))
            .filter(({ box }) => box.width < least || box.height < least)
            .map(({ box, html }) => `${box.width.toFixed(0)} x ${box.height.toFixed(0)}: ${html}`), TARGET_PX - 0.5);
        expect(small, mode).toEqual([]);
      }
      await viewer.close();
    },
  );

  it('rewinds along the timeline by finger', async () => {
    const viewer = await stage.openFirst(PHONE);
    await viewer.live('d1-layers');
    const box = (await viewer.page.locator('#tick').boundingBox())!;
    await viewer.page.touchscreen.tap(box.x + box.width / 2, box.y + box.height / 2);
    await viewer.until(() => document.querySelector('#rewind')?.checkVisibility() === true, null, 'the moment is offered');
    const overflow = await viewer.page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
    expect(overflow).toBeLessThanOrEqual(0);
    await viewer.close();
  });

  it.each([['a desktop', { viewport: { width: 1280, height: 800 } }], ['a small window', { viewport: { width: 1000, height: 620 } }], ['a phone', PHONE]])('holds text twice as large on %s', async (_name, options) => {
    const viewer = await stage.openFirst(options);
    const session = await viewer.page.context().newCDPSession(viewer.page);
    await session.send('Page.setFontSizes', { fontSizes: { standard: 32 } });
    await viewer.live('d1-layers');
    await viewer.until(() => parseFloat(getComputedStyle(document.documentElement).fontSize) === 28, null, 'the text is twice as large');
    for (const mode of ['Operate', 'Research']) {
      await viewer.page.getByRole('button', { name: mode }).click();
      const clipped = await viewer.page.evaluate(() =>
        [...document.querySelectorAll<HTMLElement>('button, h2, label span, summary, output, .about')]
          .filter((one) => one.checkVisibility() && one.scrollWidth > one.clientWidth + 1 && getComputedStyle(one).display !== 'inline')
          .map((one) => one.outerHTML.slice(0, 90)),
      );
      expect(clipped, mode).toEqual([]);
      const outside = await viewer.page.evaluate(() =>
        [...document.querySelectorAll<HTMLElement>('.bar button, .time button')]
          .filter((one) => one.checkVisibility() && (one.getBoundingClientRect().right > window.innerWidth || one.getBoundingClientRect().bottom > document.documentElement.scrollHeight))
          .map((one) => one.outerHTML.slice(0, 90)),
      );
      expect(outside, mode).toEqual([]);
      expect(await viewer.page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth), mode).toBeLessThanOrEqual(0);
    }
    await viewer.screenshot(`text-200-${_name.replace('a ', '')}`);
    await viewer.close();
  });

  it('clips no words at common sizes', async () => {
    const viewer = await stage.openFirst();
    await viewer.live('d1-layers');
    const clipped: string[] = [];
    const shown = [{ mode: 'Operate', tab: null }, ...TABS.map((tab) => ({ mode: 'Research', tab }))];
    for (const [width, height] of COMMON_SIZES) {
      await viewer.page.setViewportSize({ width, height });
      for (const { mode, tab } of shown) {
        await viewer.page.getByRole('button', { name: mode }).click();
        if (tab !== null) await viewer.page.getByRole('tab', { name: tab }).click();
        await openAll(viewer);
        const words = await viewer.page.evaluate(clippedWords);
        clipped.push(...words.map((one) => `${width} x ${height}, ${mode} ${tab ?? ''}: ${one}`));
      }
    }
    expect(clipped).toEqual([]);
    await viewer.close();
  });

  it('reaches every control by Tab, and hits each slider', async () => {
    const viewer = await stage.open();
    await viewer.live('d1-layers');
    const low = await viewer.page.evaluate(() =>
      [...document.querySelectorAll('input[type=range]')].filter((one) => one.checkVisibility() && one.getBoundingClientRect().height < 24).map((one) => one.outerHTML.slice(0, 90)));
    expect(low).toEqual([]); // WCAG 2.2, 2.5.8
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
    const bytes = files.reduce((sum, file) => sum + gzipSync(readFileSync(join(file.parentPath, file.name))).byteLength, 0);
    process.stdout.write(`bundle: ${bytes} bytes compressed\n`);
    expect(bytes).toBeLessThan(BUNDLE_BYTES_MAX);
  });
});
