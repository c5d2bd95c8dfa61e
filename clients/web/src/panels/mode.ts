// SPDX-License-Identifier: GPL-3.0-or-later
// The two modes of the page. Operate has instrument, power, time and camera, for trainees. Research also has sessions,
// materials, limits and plots. The browser stores the choice.
import { button, byId } from './dom';

export type Mode = 'operate' | 'research';

const MODES: readonly (readonly [Mode, string, string])[] = [
  ['operate', 'Operate', 'Instrument, power, time and camera'],
  ['research', 'Research', 'All of Operate, and sessions, tools, materials, view and plots'],
];
const KEPT = 'mode';

/** Returns a function that chooses a mode. */
export function modeSwitch(changed: (mode: Mode) => void): (mode: Mode) => void {
  const place = byId('mode');
  const show = (mode: Mode): void => {
    document.body.dataset['mode'] = mode;
    for (const press of place.children) press.setAttribute('aria-pressed', String((press as HTMLElement).dataset['mode'] === mode));
    changed(mode);
  };
  const choose = (mode: Mode): void => {
    localStorage.setItem(KEPT, mode);
    show(mode);
  };
  for (const [mode, words, title] of MODES) {
    place.append(button(words, () => choose(mode), { title, data: { mode } }));
  }
  show(localStorage.getItem(KEPT) === 'research' ? 'research' : 'operate');
  return choose;
}
