// SPDX-License-Identifier: GPL-3.0-or-later
// A page of the viewer in Chromium, under the daemon's own headers, and the actions of a user on it.
import { mkdirSync } from 'node:fs';
import { join } from 'node:path';

import { chromium, type Browser, type BrowserContextOptions, type Locator, type Page } from 'playwright-core';

import type { Inspection } from '../../../clients/web/src/main';

declare global {
  interface Window {
    cautery: Inspection;
  }
}

// Mesa's llvmpipe draws, which takes 0.2 core-seconds for a picture; SwiftShader takes 0.5.
const FLAGS = [
  '--no-sandbox', '--use-gl=angle', '--use-angle=gl-egl', '--ignore-gpu-blocklist', '--disable-quic', '--no-first-run',
  '--disable-background-networking', '--disable-component-update', '--disable-sync',
];
/**
 * How the layers of a page become one picture: by Mesa, or by the processor without it, which takes an eighth of the time where
 * little changes. WebGL is Mesa's in both.
 */
export type Composing = 'mesa' | 'processor';
const PATIENCE_MS = 120_000; // two processor cores may be busy with other tests
const PRESS_MS = 20_000; // time after which a press without effect is repeated
// Options of pages without animations. Software draws the whole page for each picture of an animation, as long as the
// cue is shown. Tests that do not need animations use these options.
const STILL = { viewport: { width: 1100, height: 720 }, colorScheme: 'dark', reducedMotion: 'reduce' } as const;
/** Options of pages with animations, as most users see them. */
export const MOVING = { reducedMotion: 'no-preference' } as const;
/** Options of pages whose picture no test looks at: software draws it with a sixteenth of the pixels. */
export const COARSE = { coarse: true } as const;

export interface PageOptions extends BrowserContextOptions {
  coarse?: boolean;
  /** runs in the page before its scripts, each time that it loads */
  before?: () => void;
}

export function launch(composing: Composing = 'mesa'): Promise<Browser> {
  const args = composing === 'processor' ? [...FLAGS, '--disable-gpu-compositing'] : FLAGS;
  return chromium.launch({ executablePath: '/usr/bin/chromium-headless-shell', headless: true, args });
}

export class ViewerPage {
  /** console errors, uncaught errors and failed requests */
  readonly complaints: string[] = [];
  readonly hosts = new Set<string>();
  readonly schemes = new Set<string>();

  private constructor(readonly page: Page) {}

  /** Opens a page in the state of a first visit, for trainees. Tests of the panels open it for researchers. */
  static openFirst(browser: Browser, url: string, options: PageOptions = {}): Promise<ViewerPage> {
    return ViewerPage.open(browser, url, options, 'operate');
  }

  static async open(browser: Browser, url: string, options: PageOptions = {}, mode = 'research'): Promise<ViewerPage> {
    const { coarse, before, ...others } = options;
    const context = await browser.newContext({ ...STILL, ...others });
    const page = await context.newPage();
    const viewer = new ViewerPage(page);
    page.on('console', (message) => {
      if (message.type() === 'error') viewer.complaints.push(message.text());
    });
    page.on('pageerror', (error) => viewer.complaints.push(String(error)));
    const note = (url: string): void => {
      const { host, protocol } = new URL(url);
      viewer.hosts.add(host);
      if (protocol !== 'blob:' && protocol !== 'data:') viewer.schemes.add(protocol);
    };
    page.on('request', (request) => note(request.url()));
    page.on('websocket', (socket) => note(socket.url()));
    await page.addInitScript((kept) => localStorage.setItem('mode', kept), mode);
    // the layout stays the same
    if (coarse) await page.addInitScript(() => Object.defineProperty(window, 'devicePixelRatio', { value: 0.25 }));
    if (before) await page.addInitScript(before);
    await page.goto(url);
    return viewer;
  }

  async close(): Promise<void> {
    await this.page.context().close();
  }

  /** Checks the condition once per animation frame. Playwright's own waiting needs evaluations that the page's
   * headers forbid. */
  async until<A>(condition: (argument: A) => boolean, argument: A, what: string): Promise<void> {
    const end = Date.now() + PATIENCE_MS;
    while (!(await this.page.evaluate(condition as never, argument))) {
      if (Date.now() > end) throw new Error(`never came true: ${what}; ${await this.problems()}${JSON.stringify(await this.state())}`);
      await this.page.evaluate(() => new Promise(requestAnimationFrame));
    }
  }

  /** Returns the problems that the page reports. */
  async problems(): Promise<string> {
    const said = await this.page.locator('.problem:visible, #notices:visible, #said:visible').allTextContents();
    return said.filter((words) => words !== '').map((words) => `${words}; `).join('');
  }

  state(): Promise<Omit<Inspection, 'project'>> {
    return this.page.evaluate(() => JSON.parse(JSON.stringify(window.cautery)) as Omit<Inspection, 'project'>);
  }

  async faces(): Promise<number> {
    return Object.values((await this.state()).drawnFaces).reduce((sum, count) => sum + count, 0);
  }

  /** Waits until frames of a session are drawn. */
  async live(session: string): Promise<void> {
    await this.until((wanted) => window.cautery.session === wanted && window.cautery.tick > 0, session, `${session} is live`);
    await this.drawn();
    await this.until(() => document.querySelector('#veil')?.checkVisibility() === false, null, 'the picture is uncovered');
  }

  /** Waits until the newest frame is in the picture. */
  async drawn(): Promise<void> {
    const { picturesDrawn } = await this.state();
    await this.until((count) => window.cautery.idle || window.cautery.picturesDrawn > count + 1, picturesDrawn, 'a new picture');
  }

  /** Makes pictures in full detail, even if they move and are slow; with `held` false, in the detail that the
   * machine allows. */
  async full(held: boolean): Promise<void> {
    await this.page.evaluate((on) => window.cautery.holdFull(on), held);
    await this.drawn();
  }

  async pause(): Promise<void> {
    await this.page.getByRole('button', { name: 'Pause' }).click();
    await this.until(() => window.cautery.paused, null, 'paused');
  }

  async resume(): Promise<void> {
    await this.page.getByRole('button', { name: 'Resume' }).click();
    await this.until(() => !window.cautery.paused, null, 'running');
  }

  project(point: [number, number, number]): Promise<{ x: number; y: number }> {
    return this.page.evaluate((p) => window.cautery.project(p), point);
  }

  /**
   * Presses on a point of the tissue, which takes a free tool, until the tip is there. A page that stood still for too long
   * loses its energy, and its tool rises until the next press.
   */
  async grab(point: [number, number, number]): Promise<void> {
    const end = Date.now() + PATIENCE_MS;
    const there = ([px, py]: [number, number, number]): boolean => Math.hypot(window.cautery.tip[0] - px, window.cautery.tip[1] - py) < 0.003;
    for (;;) {
      const { x, y } = await this.project(point);
      await this.page.mouse.move(x, y);
      await this.page.mouse.down();
      await this.until(() => window.cautery.driving, null, 'the tool is taken');
      await this.page.mouse.move(x + 1, y);
      const again = Date.now() + PRESS_MS;
      while (Date.now() < again) {
        if (await this.page.evaluate(there, point)) return;
        await this.page.evaluate(() => new Promise(requestAnimationFrame));
      }
      if (Date.now() > end) throw new Error(`the tip is not where the hand is; ${await this.problems()}${JSON.stringify(await this.state())}`);
      await this.page.mouse.up();
    }
  }

  /** Moves the tool along x with energy on, each time as soon as a part of the way is cut and gone. */
  async cut(y: number, z: number, from: number, to: number, stepsTo: number): Promise<void> {
    await this.page.keyboard.down('Space');
    await this.until(() => window.cautery.energized, null, 'energy is on');
    for (let i = 1; i <= stepsTo; i++) {
      const before = await this.faces();
      const x = from + ((to - from) * i) / stepsTo;
      const at = await this.project([x, y, z]);
      await this.page.mouse.move(at.x, at.y);
      await this.until(
        (count) => Object.values(window.cautery.drawnFaces).reduce((sum, n) => sum + n, 0) !== count,
        before,
        `faces go at part ${i} of the way`,
      );
      await this.until((there) => Math.abs(window.cautery.tip[0] - there) < 0.002, x, `the hot tool has gone part ${i} of the way`);
    }
    await this.page.keyboard.up('Space');
    await this.page.mouse.up();
    await this.until(() => !window.cautery.energized, null, 'energy is off');
  }

  /** Turns the wheel with Ctrl: zooms in by `notches`. */
  async zoom(notches: number): Promise<void> {
    const { picturesDrawn } = await this.state();
    await this.page.keyboard.down('Control');
    for (let i = 0; i < notches; i++) await this.page.mouse.wheel(0, -100);
    await this.page.keyboard.up('Control');
    await this.until((before) => window.cautery.picturesDrawn > before && window.cautery.idle, picturesDrawn, 'the nearer picture');
  }

  toolInput(name: string): Locator {
    return this.page.locator(`#panel-tools input[name=${name}]`);
  }

  /** Sets a number of the tool, which this page drives. */
  async setTool(name: 'temperature_c' | 'friction', value: number): Promise<void> {
    const { page } = this;
    await page.getByRole('tab', { name: 'Tools' }).click();
    await this.toolInput(name).fill(String(value));
    await page.locator('#panel-tools button', { hasText: 'Apply' }).click();
    await this.until(([member, wanted]) => window.cautery.tool?.[member] === wanted, [name, value] as const, `the daemon has ${name}`);
    await page.getByRole('tab', { name: 'Sessions' }).click();
  }

  /** Takes the tool and makes it hotter, so that tests need not wait for tissue to heat up. */
  async heatTool(celsius: number): Promise<void> {
    await this.page.getByRole('tab', { name: 'Tools' }).click();
    await this.page.locator('#panel-tools .take').click();
    await this.until(() => window.cautery.driving, null, 'the tool is taken');
    await this.setTool('temperature_c', celsius);
  }

  async screenshot(name: string): Promise<void> {
    const folder = process.env['CAUTERY_SCREENSHOTS'] ?? '/tmp/cautery-screenshots';
    mkdirSync(folder, { recursive: true });
    await this.page.screenshot({ path: join(folder, `${name}.png`) });
  }

  /**
   * Between two corners of the tissue at home: the share of pixels that are nearly white, and of those that
   * are brighter than all around them by so much that they would sparkle.
   */
  async shine(near: [number, number, number], far: [number, number, number]): Promise<{ wet: number; sparks: number }> {
    const [from, to] = [await this.project(near), await this.project(far)];
    await this.page.evaluate(() => (document.querySelector<HTMLElement>('#cue')!.style.display = 'none'));
    const png = (await this.page.screenshot({ clip: { x: from.x, y: to.y, width: to.x - from.x, height: from.y - to.y } })).toString('base64');
    await this.page.evaluate(() => (document.querySelector<HTMLElement>('#cue')!.style.display = ''));
    return this.page.evaluate(async (data) => {
      const image = new Image();
      image.src = `data:image/png;base64,${data}`;
      await image.decode();
      const { width, height } = image;
      const context = new OffscreenCanvas(width, height).getContext('2d')!;
      context.drawImage(image, 0, 0);
      const bytes = context.getImageData(0, 0, width, height).data;
      const at = (x: number, y: number): number => Math.min(...bytes.subarray(4 * (y * width + x), 4 * (y * width + x) + 3));
      const WHITE = 205, SPARK = 30;
      let [wet, sparks] = [0, 0];
      for (let y = 1; y < height - 1; y++) {
        for (let x = 1; x < width - 1; x++) {
          const here = at(x, y);
          if (here > WHITE) wet++;
          let around = 0;
          for (let i = 0; i < 9; i++) if (i !== 4) around = Math.max(around, at(x + (i % 3) - 1, y + Math.floor(i / 3) - 1));
          if (here > around + SPARK) sparks++;
        }
      }
      return { wet: wet / (width * height), sparks: sparks / (width * height) };
    }, png);
  }

  /** Returns mean colours, 0 to 255, of small squares of the page at points of the tissue, all from one picture. */
  async coloursAt(points: readonly [number, number, number][], half = 2): Promise<Colour[]> {
    return this.coloursOf(await Promise.all(points.map((point) => this.project(point))), half);
  }

  /** Returns mean colours of small squares of the page at places in CSS pixels, all from one picture. */
  async coloursOf(places: readonly { x: number; y: number }[], half = 2): Promise<Colour[]> {
    const png = (await this.page.screenshot()).toString('base64');
    return this.page.evaluate(async ({ data, places, half }) => {
      const image = new Image();
      image.src = `data:image/png;base64,${data}`;
      await image.decode();
      const canvas = new OffscreenCanvas(image.width, image.height);
      const context = canvas.getContext('2d', { willReadFrequently: true })!;
      context.drawImage(image, 0, 0);
      return places.map(({ x, y }) => {
        const { data: bytes } = context.getImageData(Math.round(x) - half, Math.round(y) - half, 2 * half, 2 * half);
        const sum = [0, 0, 0];
        for (let i = 0; i < bytes.length; i++) if (i % 4 < 3) sum[i % 4] += bytes[i];
        return sum.map((value) => (4 * value) / bytes.length) as [number, number, number];
      });
    }, { data: png, places, half });
  }
}

export type Colour = [number, number, number];

/** Returns the share of the colours that differ in another picture. */
export function shareChanged(before: readonly Colour[], after: readonly Colour[], distance: number): number {
  const changed = before.filter((colour, i) => Math.hypot(...colour.map((value, c) => value - after[i][c])) > distance);
  return changed.length / before.length;
}
