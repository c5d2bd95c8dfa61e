// SPDX-License-Identifier: GPL-3.0-or-later
// Lists every way to hold energy, every way to lose the hold, and what each pair of them does.
import type { HoldHands, Point, Pointing } from './hold_hands';

export interface Places {
  tissue: Point;
  energy: Point;
  latch: Point;
}

export interface Way {
  name: string;
  kind: Pointing | 'key' | 'device' | 'latch';
  on: 'picture' | 'energy' | 'latch' | null;
  begin(hands: HoldHands, places: Places): Promise<void>;
  /** releases the hold as a person does */
  readonly release: (hands: HoldHands, places: Places) => Promise<void>;
}

const focus = (hands: HoldHands, id: string): Promise<void> => hands.evaluate((wanted) => document.getElementById(wanted)!.focus(), id);

function pointing(kind: Pointing, on: 'picture' | 'energy'): Way {
  const place = on === 'picture' ? 'tissue' : 'energy';
  return {
    name: `${{ mouse: 'left button', pen: 'pen', touch: 'finger' }[kind]} on ${place === 'tissue' ? 'the tissue' : 'Energy'}`,
    kind, on,
    begin: (hands, places) => hands.down(kind, places[place]),
    release: (hands) => hands.up(kind),
  };
}

function key(name: string, pressed: string, on: 'picture' | 'energy' | null, before: (hands: HoldHands) => Promise<void>): Way {
  return {
    name, on, kind: name === 'pedal' ? 'device' : 'key',
    begin: async (hands) => {
      await before(hands);
      await hands.keyDown(pressed);
    },
    release: (hands) => hands.keyUp(pressed),
  };
}

const pull = (hands: HoldHands, value: number): Promise<void> =>
  hands.evaluate((share) => {
    window.holds.at ??= performance.timeOrigin + performance.now();
    Object.assign(window.holds.pad!.buttons[7], { value: share, pressed: share > 0 });
  }, value);
const cap = (hands: HoldHands, value: number): Promise<void> =>
  hands.evaluate((button) => {
    window.holds.at ??= performance.timeOrigin + performance.now();
    window.holds.cap([button]);
  }, value);

export const WAYS: readonly Way[] = [
  ...(['mouse', 'pen', 'touch'] as const).flatMap((kind) => [pointing(kind, 'picture'), pointing(kind, 'energy')]),
  key('Space on Energy', 'Space', 'energy', (hands) => focus(hands, 'energy')),
  key('Enter on Energy', 'Enter', 'energy', (hands) => focus(hands, 'energy')),
  key('Space on the picture', 'Space', 'picture', (hands) => focus(hands, 'picture')),
  key('Space with the focus nowhere', 'Space', 'picture', (hands) => hands.evaluate(() => (document.activeElement as HTMLElement).blur(), null)),
  key('pedal', 'F9', null, (hands) => focus(hands, 'picture')),
  {
    name: 'gamepad’s trigger', kind: 'device', on: null,
    begin: async (hands) => {
      await hands.evaluate(async () => {
        const { holds } = window;
        const axes = [0, 0, 0, 0];
        const buttons = Array.from({ length: 17 }, () => ({ pressed: false, touched: false, value: 0 }));
        const reads = { count: 0 };
        const pad = { id: 'test', index: 0, connected: true, mapping: 'standard', timestamp: 0, axes, buttons };
        Object.defineProperty(pad, 'buttons', { get: () => (reads.count++, buttons) });
        holds.pad = pad;
        while (reads.count < 4) await new Promise(requestAnimationFrame); // the page has seen the gamepad at rest
      }, null);
      await pull(hands, 1);
    },
    release: (hands) => pull(hands, 0),
  },
  { name: '3D mouse’s button', kind: 'device', on: null, begin: (hands) => cap(hands, 1), release: (hands) => cap(hands, 0) },
  {
    name: 'Keep on, pressed', kind: 'latch', on: 'latch',
    begin: async (hands, { latch }) => {
      await hands.down('mouse', latch);
      await hands.up('mouse');
    },
    release: (hands) => hands.keyDown('Escape').then(() => hands.keyUp('Escape')),
  },
  {
    name: 'Keep on by L', kind: 'latch', on: 'latch',
    begin: async (hands) => {
      await focus(hands, 'picture');
      await hands.keyDown('l');
      await hands.keyUp('l');
    },
    release: (hands) => hands.keyDown('l').then(() => hands.keyUp('l')),
  },
];

export interface Loss {
  name: string;
  /** off: energy ends; stays: energy must not end, because the hold continues; null: the pair does not exist */
  does(way: Way): 'off' | 'stays' | null;
  happen(hands: HoldHands, way: Way, places: Places): Promise<void>;
  /** restores the page */
  undo?(hands: HoldHands, way: Way): Promise<void>;
}

const isPointer = ({ kind }: Way): boolean => kind === 'mouse' || kind === 'pen' || kind === 'touch';
const hasButtons = ({ kind }: Way): boolean => kind === 'mouse' || kind === 'pen';
const always = (): 'off' => 'off';
/** Makes a loss that happens in the page. */
const inPage = (work: () => void) => (hands: HoldHands): Promise<void> => hands.evaluate(work, null);
/** Makes a loss that happens in the page, with an argument for an element or an event. */
const inPageTo = (work: (argument: string) => void) => (hands: HoldHands, argument: string): Promise<void> => hands.evaluate(work, argument);
const undo = (hands: HoldHands): Promise<void> =>
  hands.evaluate(() => {
    window.holds.undo?.();
    window.holds.undo = null;
  }, null);

const focusOn = inPageTo((selector) => {
  window.holds.at = performance.timeOrigin + performance.now();
  document.querySelector<HTMLElement>(selector)!.focus();
});
const send = inPageTo((type) => {
  window.holds.at = performance.timeOrigin + performance.now();
  if (type === 'contextmenu') document.querySelector('h1')!.dispatchEvent(new MouseEvent(type, { bubbles: true, cancelable: true }));
  else if (type === 'freeze') document.dispatchEvent(new Event(type));
  else window.dispatchEvent(new Event(type));
});
const takeOut = inPageTo((id) => {
  const element = document.getElementById(id)!;
  const mark = document.createComment('');
  window.holds.undo = () => mark.replaceWith(element);
  window.holds.at = performance.timeOrigin + performance.now();
  element.replaceWith(mark);
});
const disable = inPageTo((id) => {
  const element = document.getElementById(id) as HTMLButtonElement;
  window.holds.undo = () => (element.disabled = false);
  window.holds.at = performance.timeOrigin + performance.now();
  element.disabled = true;
});
const hide = inPageTo((id) => {
  const element = document.getElementById(id)!;
  window.holds.undo = () => (element.hidden = false);
  window.holds.at = performance.timeOrigin + performance.now();
  element.hidden = true;
});

const goes = (what: 'picture' | 'energy' | 'latch') => (way: Way): 'off' | 'stays' =>
  what === 'picture' || way.on === what ? 'off' : 'stays';
const losses = (what: 'picture' | 'energy' | 'latch', words: string): Loss[] => [
  { name: `${words} removed`, does: goes(what), happen: (hands) => takeOut(hands, what), undo },
  { name: `${words} hidden`, does: goes(what), happen: (hands) => hide(hands, what), undo },
  ...(what === 'picture' ? [] : [{ name: `${words} disabled`, does: goes(what), happen: (hands: HoldHands) => disable(hands, what), undo }]),
];

export const LOSSES: readonly Loss[] = [
  { name: 'let go', does: always, happen: (hands, way, places) => way.release(hands, places) },
  {
    name: 'a second button pressed, the first released', does: (way) => (hasButtons(way) ? 'off' : null),
    happen: async (hands, { kind, on }, places) => {
      await hands.down(kind as Pointing, on === 'energy' ? places.energy : places.tissue, 2);
      await hands.up(kind as Pointing, 0);
    },
    undo: (hands, { kind }) => hands.up(kind as Pointing, 2),
  },
  {
    name: 'a move that reports no button', does: (way) => (hasButtons(way) ? 'off' : null),
    happen: (hands) => hands.evaluate(() => {
      window.holds.at = performance.timeOrigin + performance.now();
      document.body.dispatchEvent(new PointerEvent('pointermove', { pointerId: window.holds.pointerId, buttons: 0, bubbles: true }));
    }, null),
  },
  { name: 'pointer cancelled', does: (way) => (isPointer(way) ? 'off' : null), happen: (hands, { kind }) => hands.cancel(kind as Pointing) },
  {
    name: 'pointer capture lost', does: (way) => (isPointer(way) ? 'off' : null),
    happen: async (hands, { kind, on }) => { // browsers begin a capture, and report its loss, with the next motion
      await hands.move(kind as Pointing);
      await hands.evaluate((id) => {
        window.holds.at = null;
        document.getElementById(id)!.releasePointerCapture(window.holds.pointerId);
      }, on ?? '');
      await hands.move(kind as Pointing);
    },
  },
  {
    name: 'a second finger on the same place', does: ({ kind }) => (kind === 'touch' ? 'off' : null),
    happen: (hands, { on }, { tissue, energy }) => hands.secondFinger(on === 'picture' ? { x: tissue.x + 30, y: tissue.y } : { x: energy.x + 8, y: energy.y }),
  },
  {
    name: 'the other hand’s finger on the tissue', does: ({ kind, on }) => (kind === 'touch' && on === 'energy' ? 'stays' : null),
    happen: (hands, _way, { tissue }) => hands.secondFinger(tissue),
  },
  { name: 'a context menu', does: always, happen: (hands) => send(hands, 'contextmenu') },
  {
    name: 'a dialog', does: always,
    happen: inPage(() => {
      window.holds.at = performance.timeOrigin + performance.now();
      document.querySelector<HTMLElement>('#reset')!.click();
    }),
    undo: inPage(() => document.querySelector<HTMLElement>('dialog[open] button')!.click()),
  },
  { name: 'window blur', does: always, happen: (hands) => send(hands, 'blur'), undo: (hands) => send(hands, 'focus') },
  {
    name: 'released while another window has the focus', does: ({ kind }) => (kind === 'latch' ? null : 'off'),
    happen: async (hands) => {
      await send(hands, 'blur');
      await send(hands, 'focus');
    },
  },
  {
    name: 'focus moved to another control', does: (way) => (isPointer(way) || way.kind === 'key' ? 'off' : 'stays'),
    happen: (hands) => focusOn(hands, '#pause'),
  },
  {
    // The focus leaves the field again afterwards, because a repeated pair has to move it there again.
    name: 'focus moved to a field', does: always, happen: (hands) => focusOn(hands, 'input[name=person]'),
    undo: (hands) => hands.evaluate(() => document.querySelector<HTMLElement>('input[name=person]')!.blur(), null),
  },
  {
    name: 'page hidden', does: always,
    happen: inPage(() => {
      window.holds.undo = () => Reflect.deleteProperty(document, 'hidden');
      Object.defineProperty(document, 'hidden', { configurable: true, get: () => true });
      window.holds.at = performance.timeOrigin + performance.now();
      document.dispatchEvent(new Event('visibilitychange'));
    }),
    undo,
  },
  { name: 'pagehide', does: always, happen: (hands) => send(hands, 'pagehide'), undo: (hands) => send(hands, 'focus') },
  { name: 'page frozen', does: always, happen: (hands) => send(hands, 'freeze') },
  ...losses('picture', 'the picture'),
  ...losses('energy', 'Energy'),
  ...losses('latch', 'Keep on'),
  { name: 'gamepad disconnected', does: ({ name }) => (name.startsWith('gamepad') ? 'off' : null), happen: (hands) => send(hands, 'gamepaddisconnected') },
  {
    name: 'gamepad gone without an event', does: ({ name }) => (name.startsWith('gamepad') ? 'off' : null),
    happen: inPage(() => {
      const { pad } = window.holds;
      window.holds.undo = () => (window.holds.pad = pad);
      window.holds.at = performance.timeOrigin + performance.now();
      window.holds.pad = null;
    }),
    undo,
  },
  {
    name: 'gamepad reports that it is not connected', does: ({ name }) => (name.startsWith('gamepad') ? 'off' : null),
    happen: inPage(() => {
      window.holds.at = performance.timeOrigin + performance.now();
      window.holds.pad!.connected = false;
    }),
  },
  {
    name: '3D mouse unplugged, and plugged in with its button down', does: ({ name }) => (name.startsWith('3D') ? 'off' : null),
    happen: inPage(() => {
      window.holds.at = performance.timeOrigin + performance.now();
      window.holds.unplug();
    }),
  },
  { name: 'Escape', does: ({ kind }) => (kind === 'latch' ? 'off' : null), happen: (hands) => hands.keyDown('Escape').then(() => hands.keyUp('Escape')) },
];
