// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that a picture that is not live says so: no WebGL, a lost context, a lost daemon. The address restores the
// view. The token dialog shows the error and lets the user try again.
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

import { HoldingDoor } from './door';
import { Stage } from './stage';
import { COARSE, ViewerPage, type Colour } from './viewer_page';

const SAME_COLOUR = 30; // largest distance of two colours that count as the same, of 441

const veil = (viewer: ViewerPage, words: string): Promise<void> =>
  viewer.until((wanted) => document.querySelector('#veil')?.textContent?.includes(wanted) === true && document.querySelector('#veil')!.checkVisibility(), words, words);
const unveiled = (viewer: ViewerPage): Promise<void> =>
  viewer.until(() => document.querySelector('#veil')?.checkVisibility() === false, null, 'the picture is live again');

/** In the page, before its scripts: makes a browser without WebGL. */
function withoutWebGl(): void {
  // eslint-disable-next-line @typescript-eslint/unbound-method -- called with its canvas below
  const real = HTMLCanvasElement.prototype.getContext as (this: HTMLCanvasElement, kind: string, ...rest: unknown[]) => unknown;
  HTMLCanvasElement.prototype.getContext = function (this: HTMLCanvasElement, kind: string, ...rest: unknown[]) {
    return kind.startsWith('webgl') ? null : real.call(this, kind, ...rest);
  } as typeof HTMLCanvasElement.prototype.getContext;
}

// One page goes through all states, from its first moment to the loss of its daemon. Another page has no WebGL.
describe('a picture that is not live, and its address', () => {
  const stage = new Stage(['--demo', 'fascia'], {}, 'processor');
  let viewer: ViewerPage;
  const place = async (): Promise<Colour> => (await viewer.coloursAt([[0.02, 0.02, 0]]))[0];
  const apart = (a: Colour, b: Colour): number => Math.hypot(...a.map((value, c) => value - b[c]));

  beforeAll(async () => {
    viewer = await stage.openFirst();
  });

  it('is covered until tissue is drawn', async () => {
    await viewer.until(() => document.querySelector('.veil-card') !== null, null, 'the page has begun');
    await unveiled(viewer);
    const early = await place();
    await viewer.live('d1-fascia');
    expect(apart(await place(), early)).toBeLessThan(SAME_COLOUR);
  });

  it('whose graphics are lost says so, and is drawn again when they are back', async () => {
    const before = await place();
    await viewer.page.evaluate(() => {
      const loser = document.querySelector<HTMLCanvasElement>('#picture')!.getContext('webgl2')!.getExtension('WEBGL_lose_context')!;
      Object.assign(window, { loser });
      loser.loseContext();
    });
    await veil(viewer, 'lost the picture');
    await viewer.page.evaluate(() => (window as unknown as { loser: WEBGL_lose_context }).loser.restoreContext());
    await unveiled(viewer);
    await viewer.until(() => window.cautery.idle, null, 'drawn again');
    expect(apart(await place(), before)).toBeLessThan(SAME_COLOUR);
  });

  it('has session, tick and camera, and comes back to them', async () => {
    await viewer.page.getByRole('button', { name: 'From above' }).click();
    await viewer.until(() => /session=d1-fascia&tick=\d+&camera=-90.0,85.9,/.test(window.location.search), null, 'the address tells it');
    const shared = viewer.page.url();
    const corner = await viewer.project([0.05, 0.03, 0]);
    await viewer.page.reload();
    await viewer.live('d1-fascia');
    await viewer.drawn();
    const again = await viewer.project([0.05, 0.03, 0]);
    expect.soft(Math.hypot(again.x - corner.x, again.y - corner.y)).toBeLessThan(2);
    expect.soft(await viewer.page.locator('#rewind').isVisible()).toBe(false); // a reload is not a request to rewind

    const tick = Number(new URL(shared).searchParams.get('tick'));
    await viewer.until((then) => window.cautery.tick > then + 30, tick, 'time goes on');
    const { epoch } = await viewer.state();
    // The timeline may appear before the first frame, which follows the topology.
    const door = new HoldingDoor(stage.daemon.url);
    onTestFinished(() => door.end());
    door.hold('frames');
    const other = await ViewerPage.openFirst(stage.browser, (await door.start()) + new URL(shared).search);
    await door.letOnePass();
    await other.until(() => document.querySelector('#time .track svg') !== null, null, 'the timeline');
    expect.soft(await other.page.locator('#rewind').isVisible()).toBe(false);
    door.letGo();
    await other.until(() => document.querySelector('#rewind')?.checkVisibility() === true, null, 'the moment is offered');
    expect(await other.page.locator('#rewind').textContent()).toMatch(/^Rewind to \d+\.\d\d s$/);
    await other.live('d1-fascia');
    expect((await other.state()).epoch).toBe(epoch); // the other viewer stays in its epoch
    await other.close();
  });

  it('without WebGL says so, and everything else works', async () => {
    const without = await stage.openFirst({ before: withoutWebGl });
    await veil(without, 'needs WebGL 2');
    await without.until(() => window.cautery.tick > 0, null, 'frames come in');
    await without.pause();
    await without.resume();
    await without.close();
  });

  it('of a daemon that is gone says so until it is back', async () => {
    await stage.daemon.kill();
    await veil(viewer, 'No connection');
    expect(await viewer.page.locator('#veil progress').isVisible()).toBe(true);
    await stage.daemon.start();
    await unveiled(viewer);
    await viewer.live('d1-fascia');
  });
});

describe('a daemon with tokens', () => {
  const folder = mkdtempSync(join(tmpdir(), 'cautery-tokens-'));
  const tokens = join(folder, 'tokens');
  beforeAll(() => writeFileSync(tokens, 'operate open-sesame-0123456789abcdef\nview only-looking-0123456789abcdef\n', { mode: 0o600 }));
  afterAll(() => rmSync(folder, { recursive: true }));
  const stage = new Stage(['--demo', 'fascia', '--tokens', tokens], COARSE, 'processor'); // the daemon reads the tokens from a file
  let viewer: ViewerPage;

  beforeAll(async () => {
    viewer = await stage.openFirst();
  });

  it('asks for one, can be asked again, and says what is wrong where one types', async () => {
    const { page } = viewer;
    const input = page.locator('#token input[type=password]');
    await input.waitFor();
    expect(await input.getAttribute('autocomplete')).toBe('current-password');
    expect(await page.locator('#token input[autocomplete=username]').count()).toBe(1);
    await page.keyboard.press('Escape');
    await veil(viewer, 'needs an access token');
    await page.getByRole('button', { name: 'Enter the token' }).click();
    await input.fill('wrong');
    await page.getByRole('button', { name: 'Connect' }).click();
    await page.locator('#token .problem').getByText('was not accepted').waitFor();
    await input.fill('only-looking-0123456789abcdef');
    await page.getByRole('button', { name: 'Connect' }).click();
    await viewer.live('d1-fascia');
    expect(await page.locator('dialog[open]').count()).toBe(0);
  });

  it('asks once in a tab, and never with a link that holds the token', async () => {
    const { page } = viewer;
    await page.reload();
    await viewer.live('d1-fascia');
    expect(await page.locator('#token[open]').count()).toBe(0);
    await page.getByRole('button', { name: 'Operate' }).click();
    expect(await page.locator('#operate').getByText('Your access allows you to watch only').count()).toBe(1);
    await page.getByRole('button', { name: 'Invite others' }).click();
    const link = await page.getByLabel('Link to this session').inputValue();
    expect(link).toMatch(/\?session=d1-fascia#token=only-looking-0123456789abcdef$/);
    expect(await page.locator('#invite .code').isVisible()).toBe(true);
    await viewer.screenshot('invite');
    await page.getByRole('button', { name: 'Close' }).click();
    const guest = await ViewerPage.openFirst(stage.browser, link, COARSE);
    await guest.live('d1-fascia');
    expect(guest.page.url()).not.toContain('token');
    await guest.close();
    const stranger = await stage.openFirst();
    await stranger.page.locator('#token input[type=password]').waitFor();
    expect(await stranger.page.locator('#link').textContent()).toBe('An access token is needed');
    expect(await stranger.page.locator('#token .problem').isVisible()).toBe(false);
    await stranger.close();
  });

  it('a client that may only view sees so where it presses', async () => {
    const at = await viewer.project([0, 0, 0]);
    await viewer.page.mouse.move(at.x, at.y);
    await viewer.page.mouse.down();
    await viewer.until(() => document.querySelector('#said')?.textContent?.includes('You can only watch') === true, null, 'it is said');
    await viewer.page.mouse.up();
    expect((await viewer.state()).driving).toBe(false);
    expect(await viewer.page.locator('#cue').isVisible()).toBe(false);
  });
});
