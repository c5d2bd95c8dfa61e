// SPDX-License-Identifier: GPL-3.0-or-later
// Decides whether energy is held, and by what. No other module decides this. Its input are events, which hold_watch.ts
// makes of the browser's events. In doubt energy goes off: an event that could mean the end of a hold ends it, and only
// a new press begins a hold.
// The table in tests/browser/page/holds.ts names each way to hold and each way to lose a hold.

/** Kinds of holds. */
export type Held = 'space' | 'button' | 'trigger' | 'pointer' | 'pedal' | 'cap' | 'latch';

/** Parts of the page on which something can be held. */
export type Place = 'picture' | 'energy' | 'latch';

/** Target of the focus: such a part, a text field, or any other element. */
export type FocusTarget = Place | 'field' | 'other';

/** Reasons why nothing is held any more. */
export type Lost =
  | 'released' | 'buttons' | 'cancelled' | 'second' | 'focus' | 'typing' | 'menu' | 'dialog' | 'blur' | 'hidden' | 'gone' | 'unplugged' | 'past';

export interface Press {
  type: 'press';
  by: Held;
  /** the pointer, key or device that is pressed */
  id: string;
  place: Place | null;
  /** false: the press counts only after the event `ripe`, because a second finger may still touch */
  ripe: boolean;
}

export type HoldEvent =
  | Press
  | { type: 'ripe'; id: string }
  | { type: 'release'; id: string; why?: Lost }
  /** the pressed buttons of a pointer, as PointerEvent.buttons has them */
  | { type: 'buttons'; id: string; buttons: number }
  /** a pointer was pressed on a place; `first`: no other pointer of its kind is down */
  | { type: 'down'; id: string; place: Place; kind: string; first: boolean }
  | { type: 'focus'; to: FocusTarget }
  /** a part was removed from the page, or can no longer be pressed */
  | { type: 'gone'; place: Place }
  /** all holds end, because their state is no longer known */
  | { type: 'leave'; why: Lost };

/** PointerEvent.buttons while the left button, the pen's tip or a finger is down, and nothing else. */
const FIRST_BUTTON_ALONE = 1;

/** The id of a pointer's hold. */
export const pointerId = (id: number): string => `pointer ${id}`;
/** The id of a key's hold; `code` as in KeyboardEvent.code. */
export const keyId = (code: string): string => `key ${code}`;
export const LATCH = 'latch';

export class Holds {
  private readonly holds = new Map<string, Press>();
  /** pointers that are down, whether they hold something or not */
  private readonly down = new Map<string, { place: Place; kind: string }>();

  /** Whether something is held that should keep energy on. */
  get held(): boolean {
    return this.by.length > 0;
  }

  /** Returns the present holds, the oldest first. */
  get by(): Held[] {
    return [...this.holds.values()].filter(({ ripe }) => ripe).map(({ by }) => by);
  }

  get latched(): boolean {
    return this.holds.has(LATCH);
  }

  /** Whether something is held, or is pressed and does not count yet. */
  get pressed(): boolean {
    return this.holds.size > 0;
  }

  /** Takes an event. Returns why the last hold ended, if this event ended it; otherwise null. */
  take(event: HoldEvent): Lost | null {
    const before = this.held;
    const why = this.apply(event);
    return before && !this.held ? why : null;
  }

  private apply(event: HoldEvent): Lost {
    switch (event.type) {
      case 'press':
        if (!this.crowded(event)) this.holds.set(event.id, event);
        return 'released';
      case 'ripe':
        this.ripen(event.id);
        return 'released';
      case 'release':
        return this.release(event.id, event.why ?? 'released');
      case 'buttons':
        if (event.buttons !== FIRST_BUTTON_ALONE) this.holds.delete(event.id);
        if (event.buttons === 0) this.down.delete(event.id);
        return event.buttons === 0 ? 'released' : 'buttons';
      case 'down':
        this.pressDown(event);
        return 'second';
      case 'focus':
        this.end((hold) => losesFocus(hold, event.to));
        return event.to === 'field' ? 'typing' : 'focus';
      case 'gone':
        this.end((hold) => hold.place === event.place || event.place === 'picture');
        return 'gone';
      case 'leave':
        this.holds.clear();
        this.down.clear();
        return event.why;
    }
  }

  /** Notes a pointer that was pressed. Two pointers on one part hold nothing. */
  private pressDown({ id, place, kind, first }: HoldEvent & { type: 'down' }): void {
    if (first) for (const [other, one] of this.down) if (one.kind === kind) this.forget(other); // the release of that pointer was missed
    this.down.set(id, { place, kind });
    this.end((hold) => isPointer(hold) && hold.place === place);
  }

  private forget(pointer: string): void {
    this.down.delete(pointer);
    this.holds.delete(pointer);
  }

  /** Ends a hold. The end of the latch ends all holds, because a user who presses Escape wants no energy. */
  private release(id: string, why: Lost): Lost {
    const hold = this.holds.get(id);
    this.forget(id);
    if (hold?.by === 'latch') this.holds.clear();
    return why;
  }

  private ripen(id: string): void {
    const hold = this.holds.get(id);
    if (hold) this.holds.set(id, { ...hold, ripe: true });
  }

  private crowded(press: Press): boolean {
    return isPointer(press) && [...this.down].some(([id, { place }]) => id !== press.id && place === press.place);
  }

  private end(which: (hold: Press) => boolean): void {
    for (const [id, hold] of this.holds) if (which(hold)) this.holds.delete(id);
  }
}

function isPointer({ id }: Press): boolean {
  return id.startsWith('pointer ');
}

/** Returns whether a change of focus ends a hold. Pointers keep holding when the focus moves from the picture to Energy,
 * because two hands can use both. */
function losesFocus(hold: Press, to: FocusTarget): boolean {
  if (to === 'field') return true;
  if (isPointer(hold)) return to !== 'picture' && to !== 'energy';
  return (hold.by === 'space' || hold.by === 'button') && to !== hold.place;
}
