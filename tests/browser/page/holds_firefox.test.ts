// SPDX-License-Identifier: GPL-3.0-or-later
// Tests holds of energy in Debian's Firefox. Mouse, fingers and keys are real inputs by WebDriver BiDi. BiDi has no pen
// there, so pen, gamepad and 3D mouse are stubs.
import { Daemon } from './daemon';
import { Door } from './door';
import { Firefox } from './firefox';
import { prepareHolds, type HoldHands, type Point, type Pointing } from './hold_hands';
import { HoldStage, PAIRS } from './holds';

const PEN = 77; // the id of the pen's pointer
const KEYS: Readonly<Record<string, string>> = { Space: ' ', Enter: '\uE006', Escape: '\uE00C', F9: '\uE039' };

/** In the page: makes the focus and its events, which Firefox gives only to a window on a screen, and a pen that can
 * be captured. */
function prepareFirefox(): void {
  document.hasFocus = () => true;
  const ownFocus = Object.getOwnPropertyDescriptor(HTMLElement.prototype, 'focus')!.value as (this: HTMLElement, options?: FocusOptions) => void;
  HTMLElement.prototype.focus = function (options) {
    const before = document.activeElement;
    ownFocus.call(this, options);
    if (document.activeElement !== this || before === this) return;
    before?.dispatchEvent(new FocusEvent('focusout', { relatedTarget: this, bubbles: true }));
    this.dispatchEvent(new FocusEvent('focusin', { relatedTarget: before, bubbles: true }));
  };
  const PEN_ID = 77;
  const { prototype } = Element;
  const instead = (method: 'setPointerCapture' | 'releasePointerCapture', ofPen: (element: Element) => void): void => {
    const own = Object.getOwnPropertyDescriptor(prototype, method)!.value as (this: Element, id: number) => void;
    prototype[method] = function (id) {
      if (id === PEN_ID) ofPen(this);
      else own.call(this, id);
    };
  };
  instead('setPointerCapture', () => undefined);
  instead('releasePointerCapture', (element) => element.dispatchEvent(new PointerEvent('lostpointercapture', { pointerId: PEN_ID, bubbles: true })));
}

class FirefoxHands implements HoldHands {
  private readonly held = new Set<string>();
  private at: Point = { x: 0, y: 0 };
  private penButtons = 0;

  constructor(private readonly firefox: Firefox) {}

  evaluate<A, R>(work: (argument: A) => R, argument: A): Promise<R> {
    return this.firefox.evaluate(work, argument);
  }

  async down(kind: Pointing, at: Point, button: 0 | 2 = 0): Promise<void> {
    this.at = at;
    this.held.add(`${kind} ${button}`);
    if (kind === 'pen') await this.pen(this.penButtons === 0 ? 'pointerdown' : 'pointermove', button, this.penButtons | (button === 0 ? 1 : 2));
    else await this.act(kind, kind, { type: 'pointerMove', ...at }, { type: 'pointerDown', button });
  }

  async up(kind: Pointing, button: 0 | 2 = 0): Promise<void> {
    if (kind === 'touch' && this.held.delete('second')) await this.act('second', 'touch', { type: 'pointerUp', button: 0 });
    if (!this.held.delete(`${kind} ${button}`)) return;
    if (kind !== 'pen') {
      await this.act(kind, kind, { type: 'pointerUp', button });
      return;
    }
    const left = this.penButtons & ~(button === 0 ? 1 : 2);
    await this.pen(left === 0 ? 'pointerup' : 'pointermove', button, left);
  }

  async move(kind: Pointing): Promise<void> {
    this.at = { x: this.at.x + 1, y: this.at.y };
    if (kind === 'pen') await this.pen('pointermove', -1, this.penButtons);
    else await this.act(kind, kind, { type: 'pointerMove', ...this.at });
  }

  async cancel(): Promise<void> {
    await this.evaluate(() => {
      window.holds.at = performance.timeOrigin + performance.now();
      document.activeElement!.dispatchEvent(new PointerEvent('pointercancel', { pointerId: window.holds.pointerId, bubbles: true }));
    }, null);
  }

  async secondFinger(at: Point): Promise<void> {
    this.held.add('second');
    await this.act('second', 'touch', { type: 'pointerMove', ...at }, { type: 'pointerDown', button: 0 });
  }

  async keyDown(key: string): Promise<void> {
    this.held.add(key);
    await this.firefox.perform({ type: 'key', id: 'keys', actions: [{ type: 'keyDown', value: KEYS[key] ?? key }] });
  }

  async keyUp(key: string): Promise<void> {
    if (this.held.delete(key)) await this.firefox.perform({ type: 'key', id: 'keys', actions: [{ type: 'keyUp', value: KEYS[key] ?? key }] });
  }

  end(): Promise<void> {
    return this.firefox.end();
  }

  private act(id: string, pointerType: string, ...actions: object[]): Promise<void> {
    return this.firefox.perform({ type: 'pointer', id, parameters: { pointerType }, actions });
  }

  private async pen(type: string, button: number, buttons: number): Promise<void> {
    this.penButtons = buttons;
    await this.evaluate((init) => {
      const target = document.elementFromPoint(init.clientX, init.clientY)!;
      target.dispatchEvent(new PointerEvent(init.type, { ...init, pointerType: 'pen', isPrimary: true, bubbles: true, cancelable: true, composed: true }));
    }, { type, button, buttons, pointerId: PEN, clientX: this.at.x, clientY: this.at.y });
  }
}

describe('a hold of energy in Firefox', () => {
  const daemon = new Daemon(['--demo', 'fascia']);
  const firefox = new Firefox();
  let door: Door;
  let holds: HoldStage;

  beforeAll(async () => {
    await daemon.start();
    door = new Door(daemon.url);
    await firefox.start(900, 620);
    await firefox.prepare(prepareFirefox);
    await firefox.prepare(prepareHolds);
    await firefox.open(await door.start());
    holds = new HoldStage(new FirefoxHands(firefox), door);
    await holds.prepare();
  });
  afterAll(async () => {
    await firefox.end();
    await door.end();
    await daemon.end();
  });

  it.each(PAIRS)('%s, %s: %s', (_way, _loss, does, way, loss) => holds.pair(way, loss, does));

  it('was sent off in', () => holds.report('Firefox'));
});
