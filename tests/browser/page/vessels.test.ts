// SPDX-License-Identifier: GPL-3.0-or-later
// A needle divides the strip of `pedicle`: the page says that the artery bleeds and how much, lists it, and the picture
// has blood where the daemon has it. The session takes its steps one by one, whatever the machine's load.
import AxeBuilder from '@axe-core/playwright';

import { PROTOCOL } from './door';
import { MessageSocket } from './socket';
import { Stage } from './stage';
import type { Colour, ViewerPage } from './viewer_page';

type Point = [number, number, number];

const SESSION = 'd1-bleeding';
const CUT_X_M = 0.004;
const DEEP_M = -0.007; // of the tip: below the strip
const ABOVE_M = 0.04;
const ON_ITS_WAY = 40; // ticks
const CUT_S = 2;
const PARTS = 40; // of the way through the strip
const POOLS = 30; // ticks in which blood flows on
const TICKS_A_SECOND = 60;
const OPAQUE_M = 0.0005; // of blood
const ENOUGH = 5; // points of the surface under so much blood
/** Of 255: red of blood in the light, green and blue in comparison. Tissue has 120 and more, and two thirds of it in green. */
const DARK = 130;
const SHARE = 0.45;

const dark = ([r, g, b]: Colour): boolean => r > 15 && r < DARK && g < SHARE * r && b < SHARE * r;
/** The surface beside the cut, and far from it. */
const grid = (from: number, to: number): Point[] =>
  Array.from({ length: 17 * 7 }, (_, i): Point => [from + ((to - from) * (i % 17)) / 16, -0.0018 + 0.0006 * Math.floor(i / 17), 0]);

/** Requests to the daemon, one after the other. */
class Commander {
  private last = 0;

  private constructor(private readonly socket: MessageSocket) {}

  static async connect(url: string): Promise<Commander> {
    const made = new Commander(await MessageSocket.connect(new URL('v1', url), PROTOCOL));
    await made.call('hello', { version: 1, client: 'surgeon' });
    return made;
  }

  call(method: string, params: object): Promise<unknown> {
    const id = ++this.last;
    return new Promise((resolve, reject) => {
      this.socket.onText = (text) => {
        const answer = JSON.parse(text) as { id?: number; result?: unknown; error?: { message: string } };
        if (answer.id !== id) return;
        if (answer.error) reject(new Error(`${method}: ${answer.error.message}`));
        else resolve(answer.result);
      };
      this.socket.sendText(JSON.stringify({ jsonrpc: '2.0', id, method, params }));
    });
  }

  advance(ticks: number, ...commands: object[]): Promise<unknown> {
    return this.call('session.advance', { session: SESSION, ticks, commands });
  }

  close(): void {
    this.socket.close();
  }
}

const move = (y: number, z: number): object => ({ method: 'tool.move', tool: 'needle', position_m: [CUT_X_M, y, z], rotation: [1, 0, 0, 0] });
const energize = (energized: boolean): object => ({ method: 'tool.energize', tool: 'needle', energized });

/** Draws the needle through the strip with energy on, and away. */
async function divide(commander: Commander): Promise<void> {
  await commander.call('tool.take_over', { session: SESSION, tool: 'needle' });
  await commander.advance(ON_ITS_WAY, move(-0.008, ABOVE_M));
  await commander.advance(ON_ITS_WAY, move(-0.008, DEEP_M));
  for (let part = 0; part <= PARTS; part++)
    await commander.advance((CUT_S * TICKS_A_SECOND) / PARTS, move(-0.006 + (0.012 * part) / PARTS, DEEP_M), energize(true));
  await commander.advance(ON_ITS_WAY, energize(false), move(0.008, ABOVE_M));
  await commander.advance(POOLS);
}

describe('a session with a blood vessel', () => {
  const stage = new Stage([]);
  let viewer: ViewerPage;
  let commander: Commander;

  beforeAll(async () => {
    commander = await Commander.connect(stage.daemon.url);
    await commander.call('session.create', { scene: 'pedicle', name: 'bleeding', paused: true, ephemeral: true });
    await commander.advance(2);
    viewer = await stage.open();
    await viewer.live(SESSION);
    await viewer.page.getByRole('tab', { name: 'Tools' }).click();
  });
  afterAll(() => commander.close());

  const list = (): Promise<string | null> => viewer.page.locator('#panel-tools .vessels').textContent();
  const blood = (points: readonly Point[]): Promise<number[]> =>
    viewer.page.evaluate((all) => all.map((point) => window.cautery.bloodAt(point) ?? NaN), [...points]);

  it('lists the vessel, which is open and has no blood around it', async () => {
    expect(await list()).toBe('artery: open');
    expect(await blood(grid(-0.01, 0.01))).toEqual(grid(-0.01, 0.01).map(() => 0));
    await viewer.full(true);
    await viewer.screenshot('vessels-whole');
    expect((await viewer.coloursAt(grid(-0.01, 0.01), 1)).filter(dark)).toEqual([]);
  });

  it('says that the vessel bleeds, how much, and shows the blood', async () => {
    await divide(commander);
    await viewer.until(() => /artery bleeds: [1-9][\d.]* ml\/s, [\d.]+ ml lost/.test(document.querySelector('#said')?.textContent ?? ''), null, 'a warning');
    await viewer.until(() => /^artery: parted, bleeding; [1-9][\d.]* ml\/s, [\d.]+ ml lost/.test(document.querySelector('#panel-tools .vessels')?.textContent ?? ''), null, 'the list');
    await viewer.page.evaluate(() => (document.querySelector<HTMLElement>('#said')!.style.visibility = 'hidden')); // it may lie over the cut
    await viewer.drawn();
    await viewer.until(() => window.cautery.idle, null, 'the picture of it');
    await viewer.screenshot('vessels-bleeding');
    const near = grid(CUT_X_M - 0.008, CUT_X_M + 0.008);
    const depths = await blood(near);
    const colours = await viewer.coloursAt(near, 1);
    const deep = colours.filter((_, i) => depths[i] >= OPAQUE_M);
    process.stdout.write(`${deep.length} points under blood, ${deep.filter(dark).length} of them dark red; depths up to ${(1000 * Math.max(...depths)).toFixed(2)} mm\n`);
    expect(deep.length).toBeGreaterThan(ENOUGH);
    expect(deep.filter(dark).length).toBeGreaterThan(0.5 * deep.length); // the others mirror the lamp, or are hidden by a lip
    await viewer.page.evaluate(() => (document.querySelector<HTMLElement>('#said')!.style.visibility = ''));
  });

  it('has it on the timeline, and is readable for assistive programs', async () => {
    await viewer.until(() => /: bleeding, artery/.test(document.querySelector('#moments')?.textContent ?? ''), null, 'the event');
    const { violations } = await new AxeBuilder({ page: viewer.page }).include('#panel-tools').include('#said').analyze();
    expect(violations.map(({ id }) => id)).toEqual([]);
    expect(viewer.complaints).toEqual([]);
  });
});
