// SPDX-License-Identifier: GPL-3.0-or-later
// Tests inputs other than a mouse: fingers, a gamepad, keys. Also tests a hidden page, which loses its energy.
import type { CDPSession } from 'playwright-core';

import { A, holdGamepad, RIGHT_TRIGGER, setPad } from './gamepad';
import { Stage } from './stage';
import { COARSE, ViewerPage } from './viewer_page';

const TABLET = { viewport: { width: 900, height: 700 }, hasTouch: true };
const NEAR_M = 0.004;
const REST_M = 1e-5; // largest motion in REST_TICKS of a tool that is not led any more
const REST_TICKS = 15;
const LIFT_M = 0.006; // least lift of the tool by a pinch that requests 10 mm
const LOWER_M = 0.002;

interface Finger {
  x: number;
  y: number;
  id: number;
}

// One daemon and two pages, one after the other: the first has fingers, the second a pointer.
const stage = new Stage(['--demo', 'fascia'], COARSE);

describe('hands', () => {
  let viewer: ViewerPage;
  let fingers: CDPSession;

  const touch = async (type: 'touchStart' | 'touchMove' | 'touchEnd', touchPoints: Finger[]): Promise<void> => {
    await fingers.send('Input.dispatchTouchEvent', { type, touchPoints });
  };
  const letGo = async (): Promise<void> => {
    await viewer.page.getByRole('tab', { name: 'Tools' }).click();
    await viewer.page.locator('#panel-tools .give').click();
    await viewer.until(() => !window.cautery.driving, null, 'the tool is free');
  };

  beforeAll(async () => {
    viewer = await stage.open(TABLET);
    await viewer.live('d1-fascia');
    fingers = await viewer.page.context().newCDPSession(viewer.page);
  });
  afterAll(() => viewer.close());

  it('a finger leads the tool, which follows', async () => {
    const from = await viewer.project([-0.02, 0, 0]);
    const to = await viewer.project([-0.008, 0.006, 0]); // the finger moves at the pace of a cut, which heat limits
    await touch('touchStart', [{ ...from, id: 1 }]);
    await viewer.until(() => window.cautery.driving, null, 'the tool is taken');
    await touch('touchMove', [{ ...to, id: 1 }]);
    await viewer.until(
      ([x, y, near]) => Math.hypot(window.cautery.tip[0] - x, window.cautery.tip[1] - y) < near,
      [-0.008, 0.006, NEAR_M] as const,
      'the tip is under the finger',
    );
    await touch('touchEnd', []);
  });

  it('two fingers that close lift it, and that open press it down', async () => {
    const { x, y } = await viewer.project([0, 0, 0]);
    const pinch = async (from: number, to: number): Promise<void> => {
      const pair = (half: number): Finger[] => [{ x: x - half, y, id: 1 }, { x: x + half, y, id: 2 }];
      await touch('touchStart', [pair(from)[0]]);
      await touch('touchStart', pair(from));
      await touch('touchMove', pair(to));
      await touch('touchEnd', []);
    };
    // The first of the two fingers may lead the tool to its place. Depth counts from there.
    await pinch(250, 250);
    const height = async (): Promise<number> => {
      // The loop waits until the tool has come to where the finger led it.
      for (let last = NaN; ; ) {
        const { tip, tick } = await viewer.state();
        if (Math.abs(tip[2] - last) < REST_M) return tip[2];
        last = tip[2];
        await viewer.until((then) => window.cautery.tick >= then, tick + REST_TICKS, 'ticks go by');
      }
    };
    const before = await height();
    await pinch(250, 30);
    await viewer.until((low) => window.cautery.tip[2] > low, before + LIFT_M, 'the tool is lifted');
    const lifted = await height();
    await pinch(30, 250);
    await viewer.until((high) => window.cautery.tip[2] < high, lifted - LOWER_M, 'the tool is lower');
  });

  it('the Energy button heats while a finger holds it', async () => {
    const box = (await viewer.page.locator('#energy').boundingBox())!;
    const at = { x: box.x + box.width / 2, y: box.y + box.height / 2, id: 3 };
    await touch('touchStart', [at]);
    await viewer.until(() => window.cautery.energized, null, 'energy is on');
    await touch('touchEnd', []);
    await viewer.until(() => !window.cautery.energized, null, 'energy is off');
    await letGo();
  });
});

describe('hands that need a page in front', () => {
  let viewer: ViewerPage;

  beforeAll(async () => {
    viewer = await stage.open();
    await viewer.live('d1-fascia');
    await viewer.page.evaluate(holdGamepad);
    await viewer.page.getByRole('tab', { name: 'Tools' }).click();
    await viewer.page.locator('#panel-tools .take').click();
    await viewer.until(() => window.cautery.driving, null, 'the tool is taken');
  });

  it('a gamepad moves the tool and heats with its trigger', async () => {
    const [x] = (await viewer.state()).tip;
    await setPad(viewer, [1, 0, 0, 0], []);
    await viewer.until((from) => window.cautery.tip[0] > from, x + 0.01, 'the stick moves it to the right');
    await setPad(viewer, [0, 0, 0, 0], [RIGHT_TRIGGER]);
    await viewer.until(() => window.cautery.energized, null, 'energy is on');
    await setPad(viewer, [0, 0, 0, 0], []);
    await viewer.until(() => !window.cautery.energized, null, 'energy is off');
  });

  it('a gamepad closes and opens a grasper', async () => {
    const { page } = viewer;
    await page.getByText('Add a tool').click();
    await page.locator('#panel-tools details').getByRole('button', { name: 'Add', exact: true }).click();
    await viewer.until(() => window.cautery.tool?.name === 'grasper' && window.cautery.driving, null, 'a grasper is in hand');
    const { jaw: open } = await viewer.state();
    await setPad(viewer, [0, 0, 0, 0], [A]);
    await viewer.until((before) => window.cautery.jaw < before, open, 'it closes');
    await setPad(viewer, [0, 0, 0, 0], []);
    await page.locator('#held').selectOption('hook');
    await viewer.until(() => window.cautery.tool?.name === 'hook' && window.cautery.driving, null, 'the hook is in hand');
  });

  it('keys move, turn and heat, and the page says where the tool is', async () => {
    const { page } = viewer;
    await page.locator('#picture').focus();
    const before = (await viewer.state()).tip;
    await page.keyboard.down('ArrowLeft');
    await viewer.until((from) => window.cautery.tip[0] < from, before[0] - 0.01, 'the key moves it to the left');
    await page.keyboard.up('ArrowLeft');
    await page.keyboard.down('Space');
    await viewer.until(() => window.cautery.energized, null, 'energy is on');
    await page.keyboard.up('Space');
    await viewer.until(() => !window.cautery.energized, null, 'energy is off');
    await viewer.until(() => /hook at .* mm/.test(document.querySelector('#reading')?.textContent ?? ''), null, 'the reading tells it');
  });

  it('a page that is hidden loses its energy, which does not come back by itself', async () => {
    const { page } = viewer;
    await page.locator('#picture').focus();
    await page.keyboard.down('Space');
    await viewer.until(() => window.cautery.energized, null, 'energy is on');
    const said = await page.evaluate(() => {
      Object.defineProperty(document, 'hidden', { configurable: true, get: () => true });
      document.dispatchEvent(new Event('visibilitychange'));
      return document.querySelector('#said')?.textContent; // the message is shown for some seconds
    });
    expect(said).toContain('Energy is off');
    await viewer.until(() => !window.cautery.energized, null, 'energy is off');
    await page.evaluate(() => {
      Reflect.deleteProperty(document, 'hidden');
      document.dispatchEvent(new Event('visibilitychange'));
    });
    const { tick } = await viewer.state();
    await viewer.until((later) => window.cautery.tick > later, tick + 30, 'half a second later');
    expect((await viewer.state()).energized).toBe(false);
    await page.keyboard.up('Space');
  });
});
