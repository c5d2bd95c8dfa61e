// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the manual as a daemon serves it: complete, within the strict Content-Security-Policy, and with a search that
// works.
import { fileURLToPath } from 'node:url';

import { Stage } from './stage';
import { COARSE } from './viewer_page';

const MANUAL = fileURLToPath(new URL('../../../clients/web/dist-manual', import.meta.url));
const BEYOND = /^(https?|mailto):/;
/** Matches everything that the policy `default-src 'none'; script-src 'self'; style-src 'self'` refuses. */
const INLINE = /<script(?![^>]*\bsrc=)[^>]*>|<style\b|\sstyle="|\son[a-z]+="/;
const TYPES: [RegExp, RegExp][] = [[/\.html$|\/$/, /^text\/html/], [/\.css$/, /^text\/css/], [/\.js$/, /^text\/javascript/],
  [/\.svg$/, /^image\/svg/], [/\.png$/, /^image\/png/], [/\.jpg$/, /^image\/jpeg/],
  [/\.json$/, /^application\/json/]];

/** Returns every address that pages link or load, beginning with the first page, and its text. */
async function follow(first: string): Promise<Map<string, string>> {
  const [found, wanted] = [new Map<string, string>(), [first]];
  for (let url = wanted.pop(); url !== undefined; url = wanted.pop()) {
    if (found.has(url)) continue;
    const answer = await fetch(url);
    expect([url, answer.status]).toEqual([url, 200]);
    expect(answer.headers.get('content-security-policy')).toMatch(/default-src 'none'.*style-src 'self'/);
    expect(answer.headers.get('content-type')).toMatch(TYPES.find(([name]) => name.test(url))![1]);
    const isPage = /\.html$|\/$/.test(url);
    const text = isPage ? await answer.text() : '';
    found.set(url, text);
    for (const [, link] of text.matchAll(/\b(?:href|src|data-index)="([^"]+)"/g)) {
      if (!BEYOND.test(link)) wanted.push(new URL(link, url).href.split('#')[0]);
    }
  }
  return found;
}

describe('the manual', () => {
  const stage = new Stage(['--manual', MANUAL], COARSE);
  const complaints: string[] = [];
  const open = async (path: string) => {
    const page = await stage.browser.newPage({ reducedMotion: 'reduce' });
    page.on('console', (message) => message.type() === 'error' && complaints.push(message.text()));
    page.on('pageerror', (error) => complaints.push(String(error)));
    page.on('requestfailed', (request) => complaints.push(request.url()));
    await page.goto(`${stage.daemon.url}manual/${path}`);
    return page;
  };

  it('is whole: every page, picture and script that it links is there, and nothing is inline', async () => {
    const found = await follow(`${stage.daemon.url}manual/`);
    expect(found.size).toBeGreaterThan(60);
    const pages = [...found].filter(([, text]) => text !== '');
    expect(pages.filter(([, text]) => INLINE.test(text)).map(([url]) => url)).toEqual([]);
    for (const [url, text] of pages) { // links within and between pages must lead to headings that exist
      for (const [, link] of text.matchAll(/\bhref="([^"]*#[^"]+)"/g)) {
        if (BEYOND.test(link)) continue;
        const { href, hash } = new URL(link, url);
        const target = found.get(href.slice(0, -hash.length))!;
        expect(target.includes(` id="${decodeURIComponent(hash.slice(1))}"`), `${url}: ${link}`).toBe(true);
      }
    }
  });

  it('finds a term, and leads to its section', async () => {
    const page = await open('');
    await page.getByLabel('Search').fill('virtual coup');
    await page.locator('#found li a').first().waitFor();
    expect(await page.locator('article').isHidden()).toBe(true);
    expect(await page.locator('#found li').count()).toBeGreaterThan(1);
    expect(await page.locator('#found').innerText()).toMatch(/virtual coupling/i);
    await page.getByLabel('Search').press('Enter'); // opens the first result
    await page.waitForURL(/\/manual\/.+/);
    expect(await page.locator('article').innerText()).toMatch(/virtual coupling/i);
    await page.getByLabel('Search').fill('qqqqq');
    await page.getByText('Nothing found for').waitFor();
    await page.getByLabel('Search').fill('');
    expect(await page.locator('article').isVisible()).toBe(true);
    await page.close();
  });

  it('is a step from the viewer’s help', async () => {
    const viewer = await stage.openFirst();
    await viewer.page.locator('#help').click();
    const [page] = await Promise.all([viewer.page.waitForEvent('popup'), viewer.page.getByRole('link', { name: 'Manual' }).click()]);
    await page.getByRole('heading', { name: 'Cautery manual' }).waitFor();
    expect(viewer.complaints).toEqual([]);
  });

  it('draws its formulas and its picture', async () => {
    const page = await open('computation.html');
    const heights = await page.locator('.equation math').evaluateAll((all) => all.map((each) => each.getBoundingClientRect().height));
    expect(heights.length).toBeGreaterThan(20);
    expect(Math.min(...heights)).toBeGreaterThan(12); // px: at least one line of text
    await page.goto(`${stage.daemon.url}manual/architecture.html`);
    expect(await page.locator('article img').evaluate((img) => (img as HTMLImageElement).naturalWidth)).toBe(860);
    await page.close();
  });

  it('is drawn without a complaint of the browser', () => {
    expect(complaints).toEqual([]);
  });
});
