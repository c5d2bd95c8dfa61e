// SPDX-License-Identifier: GPL-3.0-or-later
// Tests each input alone, from a new page until faces are gone: a mouse, a keyboard, a gamepad, one finger, two
// fingers. No input presses a button of the page first.
import type { CDPSession } from 'playwright-core';

import { holdGamepad, RIGHT_TRIGGER, setPad } from './gamepad';
import { BrowserStage, daemonForTest } from './stage';
import { COARSE, ViewerPage } from './viewer_page';

const FACES = 6000; // number of faces in deploy/scenes/fascia.json
const CUT_FACES = 8;
const FROM: [number, number, number] = [-0.01, 0.005, 0];
const TO: [number, number, number] = [0.01, 0.005, 0];
const TABLET = { viewport: { width: 900, height: 700 }, hasTouch: true };

interface Finger {
  x: number;
  y: number;
  id: number;
}

class Fingers {
  private constructor(private readonly session: CDPSession) {}

  static async of(viewer: ViewerPage): Promise<Fingers> {
    return new Fingers(await viewer.page.context().newCDPSession(viewer.page));
  }

  async touch(type: 'touchStart' | 'touchMove' | 'touchEnd', touchPoints: Finger[]): Promise<void> {
    await this.session.send('Input.dispatchTouchEvent', { type, touchPoints });
  }
}

const cut = (viewer: ViewerPage): Promise<void> =>
  viewer.until(
    (left) => Object.values(window.cautery.drawnFaces).reduce((sum, n) => sum + n, 0) <= left,
    FACES - CUT_FACES,
    'faces are gone',
  );
const lit = (viewer: ViewerPage): Promise<void> => viewer.until(() => window.cautery.energized, null, 'energy is on');
const dark = (viewer: ViewerPage): Promise<void> => viewer.until(() => !window.cautery.energized, null, 'energy is off');

const INPUTS: readonly (readonly [string, (viewer: ViewerPage) => Promise<void>])[] = [
  ['a mouse alone', async (viewer) => {
    const { mouse } = viewer.page;
    const [from, to] = [await viewer.project(FROM), await viewer.project(TO)];
    await mouse.move(from.x, from.y);
    await mouse.down();
    await lit(viewer);
    await mouse.move(to.x, to.y, { steps: 10 });
    await cut(viewer);
    await mouse.up();
    await dark(viewer);
    await mouse.move(to.x, to.y); // without a button the tool follows, with energy off
    await viewer.until(() => window.cautery.tip[0] > 0.005, null, 'the tool follows the mouse');
    await mouse.move(from.x, from.y); // the tissue is gone at this place
    await viewer.until(() => window.cautery.tip[0] < -0.005, null, 'the tool follows the mouse over the gap');
    expect((await viewer.state()).energized).toBe(false);
  }],
  ['a keyboard alone', async (viewer) => {
    const { keyboard } = viewer.page;
    await keyboard.down('ArrowRight');
    await viewer.until(() => window.cautery.driving && window.cautery.tip[0] > -0.02, null, 'the arrow leads it over the tissue');
    await keyboard.up('ArrowRight');
    await keyboard.down('Space');
    await lit(viewer);
    await keyboard.down('ArrowRight');
    await cut(viewer);
    await keyboard.up('ArrowRight');
    await keyboard.up('Space');
    await dark(viewer);
  }],
  ['a gamepad alone', async (viewer) => {
    await viewer.page.evaluate(holdGamepad);
    await setPad(viewer, [1, 0, 0, 0], []);
    await viewer.until(() => window.cautery.driving && window.cautery.tip[0] > -0.02, null, 'the stick leads it over the tissue');
    await setPad(viewer, [0.3, 0, 0, 0], [RIGHT_TRIGGER]);
    await lit(viewer);
    await cut(viewer);
    await setPad(viewer, [0, 0, 0, 0], []);
    await dark(viewer);
  }],
  ['one finger', async (viewer) => {
    const fingers = await Fingers.of(viewer);
    const [from, to] = [await viewer.project(FROM), await viewer.project(TO)];
    await fingers.touch('touchStart', [{ ...from, id: 1 }]);
    await lit(viewer);
    await fingers.touch('touchMove', [{ ...to, id: 1 }]);
    await cut(viewer);
    await fingers.touch('touchEnd', []);
    await dark(viewer);
  }],
  ['two fingers, one leading and one on Energy', async (viewer) => {
    const fingers = await Fingers.of(viewer);
    await viewer.page.getByRole('button', { name: 'Move', exact: true }).tap();
    const [from, to] = [await viewer.project(FROM), await viewer.project(TO)];
    const box = (await viewer.page.locator('#energy').boundingBox())!;
    const onEnergy = { x: box.x + box.width / 2, y: box.y + box.height / 2, id: 2 };
    await fingers.touch('touchStart', [{ ...from, id: 1 }]);
    await viewer.until(() => window.cautery.driving, null, 'the finger takes the tool');
    await fingers.touch('touchStart', [{ ...from, id: 1 }, onEnergy]);
    await lit(viewer);
    await fingers.touch('touchMove', [{ ...to, id: 1 }, onEnergy]);
    await cut(viewer);
    await fingers.touch('touchEnd', []);
    await dark(viewer);
  }],
];

describe('each input alone takes a free tool, moves it and cuts', () => {
  const stage = new BrowserStage();

  it.each(INPUTS)('%s', async (name, play) => {
    const daemon = await daemonForTest(['--demo', 'fascia']);
    const viewer = await ViewerPage.openFirst(stage.browser, daemon.url, name.includes('finger') ? { ...TABLET, ...COARSE } : COARSE);
    await viewer.live('d1-fascia');
    expect((await viewer.state()).driving).toBe(false);
    const begun = Date.now();
    await play(viewer);
    process.stdout.write(`${name}: cut after ${((Date.now() - begun) / 1000).toFixed(1)} s\n`);
    expect(viewer.complaints).toEqual([]);
    await viewer.close();
  });
});
