// SPDX-License-Identifier: GPL-3.0-or-later
// Tests whether energy is held, and why it is not held any more: every hold with every event that can end it, and the
// rule that only a press begins a hold.
import { Holds, keyId, LATCH, pointerId, type Held, type HoldEvent, type Lost, type Place, type Press } from '../../../../clients/web/src/hands/holds';

const press = (by: Held, id: string, place: Place | null): Press => ({ type: 'press', by, id, place, ripe: true });

const HOLDS: readonly Press[] = [
  press('pointer', pointerId(1), 'picture'),
  press('button', pointerId(1), 'energy'),
  press('button', keyId('Space'), 'energy'),
  press('button', keyId('Enter'), 'energy'),
  press('space', keyId('Space'), 'picture'),
  press('pedal', keyId('F9'), null),
  press('trigger', 'trigger', null),
  press('cap', 'cap', null),
  press('latch', LATCH, 'latch'),
];
const isPointer = ({ id }: Press): boolean => id.startsWith('pointer');
const isKey = ({ by, id }: Press): boolean => (by === 'space' || by === 'button') && id.startsWith('key');

/** Events, and for which holds each event is the end. */
const ENDS: readonly (readonly [string, (hold: Press) => HoldEvent, (hold: Press) => boolean, Lost])[] = [
  ['its own release', ({ id }) => ({ type: 'release', id }), () => true, 'released'],
  ['a browser that takes it', ({ id }) => ({ type: 'release', id, why: 'cancelled' }), () => true, 'cancelled'],
  ['another’s release', () => ({ type: 'release', id: keyId('KeyB') }), () => false, 'released'],
  ['a second button', () => ({ type: 'buttons', id: pointerId(1), buttons: 3 }), isPointer, 'buttons'],
  ['the first of two buttons released', () => ({ type: 'buttons', id: pointerId(1), buttons: 2 }), isPointer, 'buttons'],
  ['a move without buttons', () => ({ type: 'buttons', id: pointerId(1), buttons: 0 }), isPointer, 'released'],
  ['a move with the one button', () => ({ type: 'buttons', id: pointerId(1), buttons: 1 }), () => false, 'released'],
  ['another pointer that hovers', () => ({ type: 'buttons', id: pointerId(9), buttons: 0 }), () => false, 'released'],
  ['a second pointer on the place', ({ place }) => ({ type: 'down', id: pointerId(2), place: place ?? 'picture', kind: 'touch', first: false }), isPointer, 'second'],
  ['focus on the picture', () => ({ type: 'focus', to: 'picture' }), (hold) => isKey(hold) && hold.place !== 'picture', 'focus'],
  ['focus on Energy', () => ({ type: 'focus', to: 'energy' }), (hold) => isKey(hold) && hold.place !== 'energy', 'focus'],
  ['focus elsewhere', () => ({ type: 'focus', to: 'other' }), (hold) => isPointer(hold) || isKey(hold), 'focus'],
  ['focus in a field', () => ({ type: 'focus', to: 'field' }), () => true, 'typing'],
  ['the picture gone', () => ({ type: 'gone', place: 'picture' }), () => true, 'gone'],
  ['Energy gone', () => ({ type: 'gone', place: 'energy' }), ({ place }) => place === 'energy', 'gone'],
  ['Keep on gone', () => ({ type: 'gone', place: 'latch' }), ({ place }) => place === 'latch', 'gone'],
  ...(['menu', 'dialog', 'blur', 'hidden', 'past'] as const).map((why) => [why, (): HoldEvent => ({ type: 'leave', why }), () => true, why] as const),
];

describe('what is held', () => {
  const pairs = HOLDS.flatMap((hold) => ENDS.map(([name, event, ends, why]) => [`${hold.by} ${hold.id}`, name, hold, event, ends, why] as const));

  it.each(pairs)('%s: %s', (_hold, _name, hold, event, ends, why) => {
    const holds = new Holds();
    expect(holds.held).toBe(false);
    expect(holds.take(hold)).toBe(null);
    expect([holds.held, holds.by]).toEqual([true, [hold.by]]);
    const ended = holds.take(event(hold));
    expect([holds.held, ended]).toEqual(ends(hold) ? [false, why] : [true, null]);
  });

  it('is held until the last hold ends, and says what held it, the oldest first', () => {
    const holds = new Holds();
    holds.take(press('space', keyId('Space'), 'picture'));
    holds.take(press('trigger', 'trigger', null));
    expect(holds.by).toEqual(['space', 'trigger']);
    expect(holds.take({ type: 'release', id: keyId('Space') })).toBe(null);
    expect(holds.by).toEqual(['trigger']);
    expect(holds.take({ type: 'release', id: 'trigger' })).toBe('released');
  });

  it('ends whole with a latch, which only somebody who wants no energy ends', () => {
    const holds = new Holds();
    holds.take(press('pointer', pointerId(1), 'picture'));
    holds.take(press('latch', LATCH, 'latch'));
    expect(holds.take({ type: 'release', id: LATCH })).toBe('released');
  });

  it.each(['release', 'buttons', 'leave', 'down', 'focus'] as const)('of a finger counts only when it is ripe, and not after %s', (type) => {
    const id = pointerId(4);
    const ends: Record<typeof type, HoldEvent> = {
      release: { type: 'release', id },
      buttons: { type: 'buttons', id, buttons: 0 },
      leave: { type: 'leave', why: 'blur' },
      down: { type: 'down', id: pointerId(5), place: 'picture', kind: 'touch', first: false },
      focus: { type: 'focus', to: 'field' },
    };
    const holds = new Holds();
    holds.take({ type: 'down', id, place: 'picture', kind: 'touch', first: true });
    holds.take({ ...press('pointer', id, 'picture'), ripe: false });
    expect([holds.held, holds.pressed]).toEqual([false, true]);
    expect(holds.take(ends[type])).toBe(null);
    holds.take({ type: 'ripe', id });
    expect([holds.held, holds.pressed]).toEqual([false, false]);
  });

  it('is nothing while two fingers are on the place, until the next first finger', () => {
    const holds = new Holds();
    const down = (id: string, first: boolean): void => void holds.take({ type: 'down', id, place: 'energy', kind: 'touch', first });
    down(pointerId(1), true);
    holds.take(press('button', pointerId(1), 'energy'));
    down(pointerId(2), false);
    holds.take(press('button', pointerId(2), 'energy'));
    expect(holds.held).toBe(false);
    down(pointerId(3), true); // the end of neither press was seen
    holds.take(press('button', pointerId(3), 'energy'));
    expect(holds.held).toBe(true);
  });

  it('stays while another hand uses the other place', () => {
    const holds = new Holds();
    holds.take({ type: 'down', id: pointerId(1), place: 'energy', kind: 'touch', first: true });
    holds.take(press('button', pointerId(1), 'energy'));
    holds.take({ type: 'down', id: pointerId(2), place: 'picture', kind: 'touch', first: false });
    holds.take({ type: 'focus', to: 'picture' });
    holds.take({ type: 'buttons', id: pointerId(2), buttons: 0 });
    expect(holds.held).toBe(true);
  });

  it('begins by a press alone, whatever 100,000 random events come', () => {
    const holds = new Holds();
    let seed = 1;
    const random = (n: number): number => (seed = (seed * 48271) % 2147483647) % n;
    const randomEvent = (): HoldEvent => {
      const hold = HOLDS[random(HOLDS.length)];
      if (random(4) === 0) return { ...hold, ripe: random(2) === 0 };
      return random(9) === 0 ? { type: 'ripe', id: hold.id } : ENDS[random(ENDS.length)][1](hold);
    };
    const wrong: HoldEvent[] = [];
    let begun = 0;
    for (let i = 0; i < 100_000; i++) {
      const before = holds.held;
      const event = randomEvent();
      const ended = holds.take(event);
      const begins = holds.held && !before;
      begun += Number(begins);
      const byPress = event.type === 'press' || event.type === 'ripe';
      const saysEnd = (ended !== null) === (before && !holds.held);
      if ((begins && !byPress) || !saysEnd || (event.type === 'leave' && holds.pressed)) wrong.push(event);
    }
    expect(wrong).toEqual([]);
    expect(begun).toBeGreaterThan(1000);
  });
});
