// SPDX-License-Identifier: GPL-3.0-or-later
// A plane that hides tissue in the picture, to look inside. It does not change the simulation.
import type { Control } from '../model/control';
import type { Viewport } from '../scene/viewport';
import { text } from '../text/text';
import { element, field } from './dom';

const AXES = [['', text.clip.nothing], ['0', text.clip.right], ['1', text.clip.behind], ['2', text.clip.above]] as const;
const STEPS = 200;
const MM = 1000;

/** Returns the fields, and a function that shows the whole tissue again. */
export function clipFields(control: Control, viewport: Viewport): { fields: HTMLElement; off: () => void } {
  const axis = element('select', { name: 'clip' }, ...AXES.map(([value, words]) => element('option', { value }, words)));
  const share = element('input', { type: 'range', name: 'clip-at', min: '0', max: String(STEPS), value: String(STEPS / 2) });
  const shown = element('small');
  const where = element('label', { class: 'field' }, element('span', {}, text.clip.upTo), share, shown);
  const apply = (): void => {
    where.hidden = axis.value === '';
    const all = control.model.joined?.surroundings?.all;
    if (axis.value === '' || !all) {
      viewport.clip.set(null);
      viewport.invalidate();
      return;
    }
    const along = Number(axis.value) as 0 | 1 | 2;
    const [least, most] = [all.least[along], all.most[along]];
    const atM = least + ((most - least) * share.valueAsNumber) / STEPS;
    shown.textContent = `${(MM * atM).toFixed(1)} mm`;
    viewport.clip.set({ axis: along, atM });
    viewport.invalidate();
  };
  axis.addEventListener('change', apply);
  share.addEventListener('input', apply);
  control.model.on('joined', apply);
  apply();
  const off = (): void => {
    axis.value = '';
    apply();
  };
  return { fields: element('div', { class: 'form' }, field(text.clip.hide, axis), where), off };
}
