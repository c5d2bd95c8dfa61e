// SPDX-License-Identifier: GPL-3.0-or-later
// The two modes of the page. Operate has instrument, power, time and camera, for trainees. Research also has sessions,
// materials, limits and plots. The browser stores the choice.
import { text } from '../text/text';
import { button, byId } from './dom';

export type Mode = 'operate' | 'research';

const MODES = ['operate', 'research'] as const satisfies readonly Mode[];
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
  for (const mode of MODES) {
    const { name, title } = text.mode.modes[mode];
    place.append(button(name, () => choose(mode), { title, data: { mode } }));
  }
  show(localStorage.getItem(KEPT) === 'research' ? 'research' : 'operate');
  return choose;
}
