// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that no panel has an accessibility fault, dark or light, wide or on a phone. Every control can be reached by
// keyboard and hit by a finger. Text may be twice as large. The bundle is small.
import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';

import AxeBuilder from '@axe-core/playwright';

import { Stage } from './stage';
import { COARSE, MOVING, ViewerPage } from './viewer_page';

const TABS = ['Sessions', 'Tools', 'Materials', 'View', 'Plots'];
const BUNDLE_BYTES_MAX = 1_000_000; // size after compression
const LAYOUT_SHIFT_MAX = 0.1; // the limit of "good" by web.dev/cls
const COLOUR_RULES = ['color-contrast', 'link-in-text-block']; // the only rules whose result differs between dark and light
const DESK = { width: 1100, height: 720 };
const PHONE = { viewport: { width: 390, height: 780 }, hasTouch: true, isMobile: true };
const distribution = fileURLToPath(new URL('../../../clients/web/dist', import.meta.url));

/** Common sizes of screens of desks, tablets and phones. */
const COMMON_SIZES = [[1920, 1080], [1366, 768], [1024, 768], [820, 1180], [390, 780], [360, 640], [780, 390]] as const;
const TARGET_PX = 44; // least size of a target for a finger

/** Opens everything that a panel can show. */
async function openAll(viewer: ViewerPage): Promise<void> {
  await viewer.page.evaluate(() => document.querySelectorAll('details').forEach((details) => (details.open = true)));
}

/** In the page: presses a tab, and waits until the page has laid out the tab's panel. */
async function showNow(tab: Element): Promise<void> {
  (tab as HTMLElement).click();
  for (let i = 0; i < 2; i++) await new Promise(requestAnimationFrame);
}

/** In the page: returns elements that are narrower than their text, and selections that do not show all of their
 * text. */
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
    .filter((one) => getComputedStyle(one).clipPath === 'none' && wide(one)) // clipped elements are only for screen readers
    .map((one) => one.outerHTML.slice(0, 100));
}

/** Returns all faults that axe finds in a part of the page, best practices included. An analysis of the whole page
 * takes seconds. */
async function faults(viewer: ViewerPage, part: string, rules: string[] = []): Promise<string[]> {
  // Details of passed rules would take half of the time. So would a second page, which only frames of other hosts need.
  const axe = new AxeBuilder({ page: viewer.page }).options({ resultTypes: ['violations'] }).setLegacyMode().include(part);
  if (rules.length > 0) axe.withRules(rules);
  const { violations } = await axe.analyze();
  return violations.map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.html.slice(0, 120)).join(' | ')}`);
}

/** Sizes of text: the browser's default, and twice that. */
const TEXT = [{ standard: 16, rootPx: 14 }, { standard: 32, rootPx: 28 }] as const;

/** In the page: returns how much wider its content is than the window. */
const overflow = (): number => document.documentElement.scrollWidth - window.innerWidth;

async function sizeText(viewer: ViewerPage, { standard, rootPx }: (typeof TEXT)[number]): Promise<void> {
  const session = await viewer.page.context().newCDPSession(viewer.page);
  await session.send('Page.setFontSizes', { fontSizes: { standard } });
  await viewer.until((px) => parseFloat(getComputedStyle(document.documentElement).fontSize) === px, rootPx, `the text is ${rootPx} px`);
  await session.detach();
}

async function holdsLargeText(viewer: ViewerPage, name: string): Promise<void> {
  await sizeText(viewer, TEXT[1]);
  for (const mode of ['Operate', 'Research']) {
    await viewer.page.getByRole('button', { name: mode }).click();
    const clipped = await viewer.page.evaluate(() =>
      [...document.querySelectorAll<HTMLElement>('button, h2, label span, summary, output, .about')]
        .filter((one) => one.checkVisibility() && one.scrollWidth > one.clientWidth + 1 && getComputedStyle(one).display !== 'inline')
        .map((one) => one.outerHTML.slice(0, 90)),
    );
    expect.soft(clipped, mode).toEqual([]);
    const outside = await viewer.page.evaluate(() =>
      [...document.querySelectorAll<HTMLElement>('.bar button, .time button')]
        .filter((one) => one.checkVisibility() && (one.getBoundingClientRect().right > window.innerWidth || one.getBoundingClientRect().bottom > document.documentElement.scrollHeight))
        .map((one) => one.outerHTML.slice(0, 90)),
    );
    expect.soft(outside, mode).toEqual([]);
    expect.soft(await viewer.page.evaluate(overflow), mode).toBeLessThanOrEqual(0);
  }
  await viewer.screenshot(`text-200-${name.replace('a ', '')}`);
}

/** Analyses Operate with its help, then Research, as a whole and panel by panel. */
async function findsNoFault(viewer: ViewerPage, tabs: readonly string[], rules: string[] = []): Promise<void> {
  await viewer.page.getByRole('button', { name: 'Operate' }).click();
  await viewer.page.getByRole('button', { name: 'Help' }).click();
  await viewer.page.locator('#hint').waitFor();
  expect.soft(await faults(viewer, 'html'), 'Operate').toEqual([]);
  await viewer.page.getByRole('button', { name: 'Research' }).click();
  await viewer.page.getByRole('tab', { name: tabs[0] }).click();
  expect.soft(await faults(viewer, 'html', rules), 'Research').toEqual([]);
  for (const tab of tabs) {
    await viewer.page.getByRole('tab', { name: tab }).click();
    await openAll(viewer);
    expect.soft(await faults(viewer, `#panel-${tab.toLowerCase()}`, rules), tab).toEqual([]);
  }
  await viewer.page.getByRole('button', { name: 'Understood' }).click();
}

// One page on a desk and one on a phone, which the tests use in turn: opening a page takes longer than most tests.
// Tests that need panels in their first state come first, because `openAll` cannot be undone.
describe('manners', () => {
  const stage = new Stage(['--demo', 'layers'], COARSE, 'processor');
  let viewer: ViewerPage;

  describe('on a desk', () => {
    beforeAll(async () => {
      viewer = await stage.open();
      await viewer.live('d1-layers');
      await viewer.pause(); // from here on, only the browser uses the processor
    });
    afterAll(() => viewer.close());

    it.each([['a desktop', { width: 1280, height: 800 }], ['a small window', { width: 1000, height: 620 }]])('holds text twice as large on %s', async (name, size) => {
      await viewer.page.setViewportSize(size);
      await holdsLargeText(viewer, name);
    });

    describe('with text as large as ever', () => {
      beforeAll(async () => {
        await viewer.page.setViewportSize(DESK);
        await sizeText(viewer, TEXT[0]);
      });

      it.each(['dark', 'light'] as const)('has no accessibility fault, %s', async (colorScheme) => {
        await viewer.page.emulateMedia({ colorScheme });
        await viewer.until((theme) => document.documentElement.dataset['theme'] === theme, colorScheme, `the page is ${colorScheme}`);
        await findsNoFault(viewer, TABS, colorScheme === 'light' ? COLOUR_RULES : []);
      });

      it('reaches every control by Tab, and hits each slider', async () => {
        await viewer.page.getByRole('tab', { name: TABS[0] }).click();
        const low = await viewer.page.evaluate(() =>
          [...document.querySelectorAll('input[type=range]')].filter((one) => one.checkVisibility() && one.getBoundingClientRect().height < 24).map((one) => one.outerHTML.slice(0, 90)));
        expect.soft(low).toEqual([]); // rule 2.5.8 of WCAG 2.2
        for (const tab of TABS) {
          await viewer.page.getByRole('tab', { name: tab }).click();
          await openAll(viewer);
          const unreachable = await viewer.page.evaluate(() =>
            [...document.querySelectorAll<HTMLElement>('button, input, select, summary, canvas#picture')]
              .filter((control) => control.checkVisibility() && control.tabIndex < 0 && control.getAttribute('role') !== 'tab')
              .map((control) => control.outerHTML.slice(0, 100)),
          );
          expect.soft(unreachable, tab).toEqual([]);
        }
      });

      it('clips no words at common sizes', async () => {
        const { page } = viewer;
        for (const [width, height] of COMMON_SIZES) {
          await page.setViewportSize({ width, height });
          await page.getByRole('button', { name: 'Operate' }).click();
          await openAll(viewer);
          expect.soft(await page.evaluate(clippedWords), `${width} x ${height}, Operate`).toEqual([]);
          await page.getByRole('button', { name: 'Research' }).click();
          for (const tab of TABS) {
            // A click of the mouse would make the browser draw the page, which takes half a second.
            await page.getByRole('tab', { name: tab }).evaluate(showNow);
            await openAll(viewer);
            expect.soft(await page.evaluate(clippedWords), `${width} x ${height}, Research ${tab}`).toEqual([]);
          }
        }
      });
    });
  });

  describe('on a phone', () => {
    beforeAll(async () => {
      viewer = await stage.openFirst({ ...PHONE, colorScheme: 'dark' });
      await viewer.live('d1-layers');
    });
    afterAll(() => viewer.close());

    it('fits a phone in portrait', async () => {
      expect.soft(await viewer.page.evaluate(overflow)).toBeLessThanOrEqual(0);
      const picture = await viewer.page.locator('#picture').boundingBox();
      expect.soft(picture?.height).toBeGreaterThan(250);
      await viewer.until(() => window.cautery.idle, null, 'the sharp picture');
    });

    it('rewinds along the timeline by finger', async () => {
      const box = (await viewer.page.locator('#tick').boundingBox())!;
      await viewer.page.touchscreen.tap(box.x + box.width / 2, box.y + box.height / 2);
      await viewer.until(() => document.querySelector('#rewind')?.checkVisibility() === true, null, 'the moment is offered');
      expect(await viewer.page.evaluate(overflow)).toBeLessThanOrEqual(0);
      await viewer.page.getByRole('button', { name: 'Return to live' }).tap();
      await viewer.until(() => window.cautery.past === null, null, 'the present is shown');
    });

    it.each(['a phone'])('holds text twice as large on %s', (name) => holdsLargeText(viewer, name));

    describe('with text as large as ever', () => {
      beforeAll(() => sizeText(viewer, TEXT[0]));

      it.each([['portrait', { width: 390, height: 780 }], ['landscape', { width: 780, height: 390 }]])('has targets that a finger hits, on a phone in %s', async (_name, size) => {
        await viewer.page.setViewportSize(size);
        for (const mode of ['Operate', 'Research']) {
          await viewer.page.getByRole('button', { name: mode }).tap();
          await openAll(viewer);
          const small = await viewer.page.evaluate((least) =>
            [...document.querySelectorAll<HTMLElement>('button, select, summary, label.check, input:not([type=checkbox])')]
              .filter((control) => control.checkVisibility() && !control.matches('.unseen, dialog *'))
              .map((control) => ({ box: control.getBoundingClientRect(), html: control.outerHTML.slice(0, 90) }))
              .filter(({ box }) => box.width < least || box.height < least)
              .map(({ box, html }) => `${box.width.toFixed(0)} x ${box.height.toFixed(0)}: ${html}`), TARGET_PX - 0.5);
          expect.soft(small, mode).toEqual([]);
        }
      });

      it('has no accessibility fault', async () => {
        await viewer.page.setViewportSize(PHONE.viewport);
        await findsNoFault(viewer, ['Sessions', 'Tools']);
      });
    });
  });

  it('does not jump about while it comes up', async () => {
    const early = await stage.openFirst(MOVING);
    await early.live('d1-layers');
    const shift = await early.page.evaluate(
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
    const paint = await early.page.evaluate(() => performance.getEntriesByName('first-contentful-paint')[0].startTime);
    process.stdout.write(`first paint after ${paint.toFixed(0)} ms, layout shift ${shift.toFixed(3)}\n`);
    expect(shift).toBeLessThan(LAYOUT_SHIFT_MAX);
    await early.close();
  });

  it('is a small bundle', () => {
    const files = readdirSync(distribution, { recursive: true, withFileTypes: true }).filter((entry) => entry.isFile());
    const bytes = files.reduce((sum, file) => sum + gzipSync(readFileSync(join(file.parentPath, file.name))).byteLength, 0);
    process.stdout.write(`bundle: ${bytes} bytes compressed\n`);
    expect(bytes).toBeLessThan(BUNDLE_BYTES_MAX);
  });
});
