// SPDX-License-Identifier: GPL-3.0-or-later
// A foot pedal. Browsers see most pedals as a keyboard with one key. The browser stores which key it is.
import { text } from '../text/text';
import { takesTyping } from './hold_watch';
import { keyId, type HoldEvent } from './holds';
import { WORKING_KEYS } from './keys';

const KEPT = 'pedal';
/** Keys that every page needs for navigation. */
const EVERY_PAGES = /^(Arrow|Tab$|Enter$|NumpadEnter$|Escape$|Space$|Shift|Control|Alt|Meta)/;

/** "B" for KeyB, "F13", "Page Down". */
export function keyWords(code: string): string {
  return code.replace(/^(Key|Digit)/, '').replace(/([a-z])([A-Z])/g, '$1 $2');
}

export class Pedal {
  /** called with the result for the next key, which is not treated as a press */
  private asked: ((words: string | null) => void) | null = null;

  constructor(
    private readonly take: (event: HoldEvent) => void,
  ) {
    window.addEventListener('keydown', (event) => this.down(event), { capture: true });
  }

  /** KeyboardEvent.code of the pedal's key; null: no pedal */
  get code(): string | null {
    return localStorage.getItem(KEPT);
  }

  /** Uses the next key as the pedal's key. `told` is called with the reason why a key cannot be used, or null on success. */
  choose(told: (problem: string | null) => void): void {
    this.asked = told;
  }

  forget(): void {
    this.asked = null;
    if (this.code !== null) this.take({ type: 'release', id: keyId(this.code) });
    localStorage.removeItem(KEPT);
  }

  private down(event: KeyboardEvent): void {
    if (this.asked) {
      this.learn(event);
    } else if (event.code === this.code && !takesTyping(event.target)) {
      event.preventDefault();
      event.stopPropagation();
      if (!event.repeat) this.take({ type: 'press', by: 'pedal', id: keyId(event.code), place: null, ripe: true });
    }
  }

  private learn(event: KeyboardEvent): void {
    const told = this.asked!;
    event.preventDefault();
    event.stopPropagation();
    if (event.code === '' || EVERY_PAGES.test(event.code) || WORKING_KEYS.has(event.code)) {
      told(text.pedal.keyInUse(keyWords(event.code || event.key)));
      return;
    }
    this.asked = null;
    localStorage.setItem(KEPT, event.code);
    told(null);
  }
}
