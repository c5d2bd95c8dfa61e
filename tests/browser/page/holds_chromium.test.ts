// SPDX-License-Identifier: GPL-3.0-or-later
// Tests holds of energy in Chromium. Mouse, pen, fingers and keys are real inputs of the browser; gamepad and 3D mouse
// are stubs.
import type { CDPSession, Page } from 'playwright-core';

import { Door } from './door';
import { prepareHolds, type HoldHands, type Point, type Pointing } from './hold_hands';
import { HoldStage, PAIRS } from './holds';
import { Stage } from './stage';

const SMALL = { viewport: { width: 900, height: 620 }, hasTouch: true };

class ChromiumHands implements HoldHands {
  private readonly at: Record<Pointing, Point> = { mouse: { x: 0, y: 0 }, pen: { x: 0, y: 0 }, touch: { x: 0, y: 0 } };
  private readonly buttons = { mouse: 0, pen: 0 };
  private fingers: (Point & { id: number })[] = [];

  constructor(
    private readonly page: Page,
    private readonly session: CDPSession,
  ) {}

  evaluate<A, R>(work: (argument: A) => R, argument: A): Promise<R> {
    return this.page.evaluate<R>(work as never, argument);
  }

  async down(kind: Pointing, at: Point, button: 0 | 2 = 0): Promise<void> {
    this.at[kind] = at;
    if (kind === 'touch') await this.touch('touchStart', [{ ...at, id: 1 }]);
    else await this.press(kind, 'mousePressed', button, this.buttons[kind] | maskOf(button));
  }

  async up(kind: Pointing, button: 0 | 2 = 0): Promise<void> {
    if (kind === 'touch' && this.fingers.length > 0) await this.touch('touchEnd', []);
    if (kind !== 'touch' && this.buttons[kind] & maskOf(button)) await this.press(kind, 'mouseReleased', button, this.buttons[kind] & ~maskOf(button));
  }

  async move(kind: Pointing): Promise<void> {
    this.at[kind] = { x: this.at[kind].x + 1, y: this.at[kind].y };
    if (kind === 'touch') {
      await this.touch('touchMove', this.fingers.map((finger) => ({ ...finger, ...this.at.touch })));
      return;
    }
    const button = this.buttons[kind] & 1 ? 'left' : 'none';
    await this.session.send('Input.dispatchMouseEvent', { type: 'mouseMoved', ...this.at[kind], button, buttons: this.buttons[kind], pointerType: kind });
  }

  async cancel(kind: Pointing): Promise<void> {
    if (kind === 'touch') {
      await this.touch('touchCancel', []);
      return;
    }
    await this.evaluate(() => {
      window.holds.at = performance.timeOrigin + performance.now();
      document.activeElement!.dispatchEvent(new PointerEvent('pointercancel', { pointerId: window.holds.pointerId, bubbles: true }));
    }, null);
  }

  secondFinger(at: Point): Promise<void> {
    return this.touch('touchStart', [...this.fingers, { ...at, id: 2 }]);
  }

  keyDown(key: string): Promise<void> {
    return this.page.keyboard.down(key);
  }

  keyUp(key: string): Promise<void> {
    return this.page.keyboard.up(key);
  }

  end(): Promise<void> {
    return this.page.context().close();
  }

  private async press(kind: 'mouse' | 'pen', type: 'mousePressed' | 'mouseReleased', button: 0 | 2, buttons: number): Promise<void> {
    this.buttons[kind] = buttons;
    const { x, y } = this.at[kind];
    await this.session.send('Input.dispatchMouseEvent', { type, x, y, button: button === 0 ? 'left' : 'right', buttons, clickCount: 1, pointerType: kind });
  }

  private async touch(type: 'touchStart' | 'touchMove' | 'touchEnd' | 'touchCancel', touchPoints: (Point & { id: number })[]): Promise<void> {
    this.fingers = touchPoints;
    await this.session.send('Input.dispatchTouchEvent', { type, touchPoints });
  }
}

/** Returns the button's bit in PointerEvent.buttons. */
function maskOf(button: 0 | 2): number {
  return button === 0 ? 1 : 2;
}

describe('a hold of energy in Chromium', () => {
  const stage = new Stage(['--demo', 'fascia'], {}, 'processor'); // its page has no WebGL
  let door: Door;
  let holds: HoldStage;

  beforeAll(async () => {
    door = new Door(stage.daemon.url);
    const context = await stage.browser.newContext(SMALL);
    const page = await context.newPage();
    await page.addInitScript(prepareHolds);
    await page.goto(await door.start());
    holds = new HoldStage(new ChromiumHands(page, await context.newCDPSession(page)), door);
    await holds.prepare();
  });
  afterAll(async () => {
    await holds.hands.end();
    await door.end();
  });

  it.each(PAIRS)('%s, %s: %s', (_way, _loss, does, way, loss) => holds.pair(way, loss, does));

  it('was sent off in', () => holds.report('Chromium'));
});
