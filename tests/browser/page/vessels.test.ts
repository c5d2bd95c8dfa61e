// SPDX-License-Identifier: GPL-3.0-or-later
// Tests vessels. A needle divides the strip of `pedicle`. The page shows how much the artery bleeds, and the picture
// shows blood where the daemon has it. Forceps seal the artery in another session, and the page shows its burst
// pressure. Steps are taken one by one, so that the load of the machine has no effect.
import AxeBuilder from '@axe-core/playwright';

import { PROTOCOL } from './door';
import { MessageSocket } from './socket';
import { Stage } from './stage';
import type { Colour, ViewerPage } from './viewer_page';

interface Wet {
  at: [number, number, number];
  depthM: number;
}

const BLEEDING = 'd1-bleeding';
const SEALING = 'd1-sealing';
const CUT_X_M = 0.004;
const DEEP_M = -0.007; // height of the tip: below the strip
const ABOVE_M = 0.04;
const SEAL_X_M = -0.005;
const SEAL_S = 3;
const ON_ITS_WAY = 40; // ticks for the tool's way to the strip
const CUT_S = 2;
const PARTS = 20; // number of parts of the way through the strip, and of a second of energy
const POOLS = 30; // ticks in which blood continues to flow
const TICKS_A_SECOND = 60;
const OPAQUE_M = 0.0005; // depth from which blood is opaque
const ENOUGH = 20; // least number of vertices under opaque blood
/** Least share of dark vertices among those under opaque blood, of which it is 0.32; among dry vertices it is 0.01.
 * Most vertices under blood are on the far sides and the underside of the stumps, behind the cloth or dry tissue. */
const DARK_SHARE = 0.2;
const DRY_SHARE = 0.05;
/** DARK: largest red of blood in the light, of 255. SHARE: largest share of green and blue in it. Tissue has red of
 * 120 and more, and green of two thirds of that. */
const DARK = 130;
const SHARE = 0.45;

const dark = ([r, g, b]: Colour): boolean => r > 15 && r < DARK && g < SHARE * r && b < SHARE * r;
/** Sends requests to the daemon, one after the other. */
class Commander {
  private last = 0;

  private constructor(private readonly socket: MessageSocket, readonly session: string) {}

  /** Connects, and creates a session of its own. */
  static async connect(url: string, session: string): Promise<Commander> {
    const made = new Commander(await MessageSocket.connect(new URL('v1', url), PROTOCOL), session);
    await made.call('hello', { version: 1, client: 'surgeon' });
    await made.call('session.create', { scene: 'pedicle', name: session.replace(/^d1-/, ''), paused: true, ephemeral: true });
    await made.advance(2);
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
    return this.call('session.advance', { session: this.session, ticks, commands });
  }

  close(): void {
    this.socket.close();
  }
}

const move = (y: number, z: number): object => ({ method: 'tool.move', tool: 'needle', position_m: [CUT_X_M, y, z], rotation: [1, 0, 0, 0] });
const energize = (energized: boolean): object => ({ method: 'tool.energize', tool: 'needle', energized });

/** Moves the needle through the strip with energy on, and away. */
async function divide(commander: Commander): Promise<void> {
  await commander.call('tool.take_over', { session: commander.session, tool: 'needle' });
  await commander.advance(ON_ITS_WAY, move(-0.008, ABOVE_M));
  await commander.advance(ON_ITS_WAY, move(-0.008, DEEP_M));
  for (let part = 0; part <= PARTS; part++)
    await commander.advance((CUT_S * TICKS_A_SECOND) / PARTS, move(-0.006 + (0.012 * part) / PARTS, DEEP_M), energize(true));
  await commander.advance(ON_ITS_WAY, energize(false), move(0.008, ABOVE_M));
  await commander.advance(POOLS);
}

/** Closes the forceps on the vessel, and turns energy on. */
async function seal(commander: Commander): Promise<void> {
  const tool = 'forceps';
  await commander.call('tool.take_over', { session: commander.session, tool });
  await commander.advance(ON_ITS_WAY, { method: 'tool.move', tool, position_m: [SEAL_X_M, 0, DEEP_M], rotation: [Math.SQRT1_2, 0, 0, Math.SQRT1_2], jaw: 1 });
  await commander.advance(ON_ITS_WAY, { method: 'tool.grasp', tool });
  for (let part = 0; part < SEAL_S * PARTS; part++) await commander.advance(TICKS_A_SECOND / PARTS, { method: 'tool.energize', tool, energized: true });
  await commander.advance(1, { method: 'tool.energize', tool, energized: false });
}

describe('a session with a blood vessel', () => {
  const stage = new Stage([]);
  let viewer: ViewerPage;
  let commander: Commander;

  beforeAll(async () => {
    commander = await Commander.connect(stage.daemon.url, BLEEDING);
    viewer = await stage.open();
    await viewer.live(BLEEDING);
    await viewer.page.getByRole('tab', { name: 'Tools' }).click();
  });
  afterAll(() => commander.close());

  const list = (): Promise<string | null> => viewer.page.locator('#panel-tools .vessels').textContent();
  const blood = async (): Promise<Wet[]> => (await viewer.page.evaluate(() => window.cautery.blood())) as Wet[];
  /** Returns the share of vertices that are dark red in the picture. */
  const darkShare = async (vertices: readonly Wet[]): Promise<number> => {
    const colours = await viewer.coloursAt(vertices.map(({ at }) => at), 1);
    return colours.filter(dark).length / colours.length;
  };

  it('lists the vessel, which is open and has no blood around it', async () => {
    expect(await list()).toBe('artery: open');
    const whole = await blood();
    expect(whole.length).toBeGreaterThan(ENOUGH);
    expect(whole.filter(({ depthM }) => depthM > 0)).toEqual([]);
    await viewer.full(true);
    await viewer.screenshot('vessels-whole');
    expect(await darkShare(whole)).toBeLessThan(DRY_SHARE);
    await viewer.full(false);
  });

  it('says that the vessel bleeds, how much, and shows the blood', async () => {
    await divide(commander);
    await viewer.until(() => /artery bleeds: [1-9][\d.]* ml\/s, [\d.]+ ml lost/.test(document.querySelector('#said')?.textContent ?? ''), null, 'a warning');
    await viewer.until(() => /^artery: parted, bleeding; [1-9][\d.]* ml\/s, [\d.]+ ml lost/.test(document.querySelector('#panel-tools .vessels')?.textContent ?? ''), null, 'the list');
    // the message may lie over the cut
    await viewer.page.evaluate(() => (document.querySelector<HTMLElement>('#said')!.style.visibility = 'hidden'));
    await viewer.full(true);
    await viewer.until(() => window.cautery.idle, null, 'the picture of it');
    await viewer.screenshot('vessels-bleeding');
    const all = await blood();
    const deep = all.filter(({ depthM }) => depthM >= OPAQUE_M);
    const dry = all.filter(({ depthM }) => depthM === 0);
    const shares = [await darkShare(deep), await darkShare(dry)];
    process.stdout.write(`${deep.length} vertices under blood, dark red: ${shares.map((share) => share.toFixed(2)).join(' of them, and of dry ones ')}\n`);
    expect(deep.length).toBeGreaterThan(ENOUGH);
    expect(shares[0]).toBeGreaterThan(DARK_SHARE);
    expect(shares[1]).toBeLessThan(DRY_SHARE);
    await viewer.full(false);
    await viewer.page.evaluate(() => (document.querySelector<HTMLElement>('#said')!.style.visibility = ''));
  });

  it('has it on the timeline, and is readable for assistive programs', async () => {
    await viewer.until(() => /: bleeding, artery/.test(document.querySelector('#moments')?.textContent ?? ''), null, 'the event');
    const { violations } = await new AxeBuilder({ page: viewer.page }).include('#panel-tools').include('#said').analyze();
    expect(violations.map(({ id }) => id)).toEqual([]);
  });

  it('no longer says so after a reset', async () => {
    await commander.call('session.reset', { session: BLEEDING });
    await commander.advance(1);
    await viewer.until(() => !/bleeds/.test(document.querySelector('#said')?.textContent ?? ''), null, 'no warning');
    await viewer.until(() => document.querySelector('#panel-tools .vessels')?.textContent === 'artery: open', null, 'the list');
  });

  it('says that a vessel is sealed, and which pressure the seal bears', async () => {
    const sealer = await Commander.connect(stage.daemon.url, SEALING);
    await viewer.page.goto(`${stage.daemon.url}?session=${SEALING}`);
    await viewer.live(SEALING);
    await viewer.page.getByRole('tab', { name: 'Tools' }).click();
    const sealing = seal(sealer); // the notice disappears after some seconds
    await viewer.until(() => /artery is sealed: bursts at [1-9]\d* mmHg/.test(document.querySelector('#said')?.textContent ?? ''), null, 'news of the seal');
    await sealing;
    sealer.close();
    await viewer.until(() => /^artery: sealed, pressed shut; bursts at [1-9]\d+ mmHg$/.test(document.querySelector('#panel-tools .vessels')?.textContent ?? ''), null, 'the list');
    await viewer.drawn();
    await viewer.screenshot('vessels-sealed');
    expect(viewer.complaints).toEqual([]);
  });
});
