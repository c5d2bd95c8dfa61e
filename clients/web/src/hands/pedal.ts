// SPDX-License-Identifier: GPL-3.0-or-later
// A foot pedal: most of them are keyboards with one key to a browser. Which key is kept by the browser.
import { takesTyping } from './hold_watch';
import { keyId, type HoldEvent } from './holds';
import { WORKING_KEYS } from './keys';

const KEPT = 'pedal';
/** Keys with which people go through a page, whatever it is. */
const EVERY_PAGES = /^(Arrow|Tab$|Enter$|NumpadEnter$|Escape$|Space$|Shift|Control|Alt|Meta)/;

/** "B" for KeyB, "F13", "Page Down". */
export function keyWords(code: string): string {
  return code.replace(/^(Key|Digit)/, '').replace(/([a-z])([A-Z])/g, '$1 $2');
}

export class Pedal {
  /** told the next key instead of having it pressed */
  private asked: ((words: string | null) => void) | null = null;

  constructor(
    private readonly take: (event: HoldEvent) => void,
  ) {
    window.addEventListener('keydown', (event) => this.down(event), { capture: true });
  }

  /** the key's place on a keyboard, as browsers name it; null: there is no pedal */
  get code(): string | null {
    return localStorage.getItem(KEPT);
  }

  /** Takes the next key for the pedal's; `told`: why it cannot be that one, or null when it is. */
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
      told(`${keyWords(event.code || event.key)} is already used by this page. Give the pedal another key with the program that came with the pedal.`);
      return;
    }
    this.asked = null;
    localStorage.setItem(KEPT, event.code);
    told(null);
  }
}
