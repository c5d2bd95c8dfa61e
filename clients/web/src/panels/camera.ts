// SPDX-License-Identifier: GPL-3.0-or-later
// Views of the camera: standard views, and views that the user has saved under a name.
import type { CameraPose } from '../scene/orbit';
import type { Viewport } from '../scene/viewport';
import { cameraText, readCamera } from './address';
import { button, element, field } from './dom';

const FROM_ABOVE = 1.5; // rad
const ALONG = 0.25;
const ASIDE = 0.6;
const QUARTER = Math.PI / 2;
const NEARER = 1 / 1.25;
const KEPT = 'views';
const VIEWS_MAX = 12;
const NAME_MAX = 24;

const FIELDS = [['trocar', 'trocar'], ['open', 'open field']] as const;
const FIELD_KEPT = 'field';

/** The round picture of an endoscope, or the open field; the browser keeps the choice. One for each place that shows it. */
function fieldChoice(viewport: Viewport): HTMLElement {
  const choose = element('select', { name: 'field' }, ...FIELDS.map(([value, words]) => element('option', { value }, words)));
  choose.value = localStorage.getItem(FIELD_KEPT) === 'open' ? 'open' : 'trocar';
  choose.addEventListener('change', () => {
    localStorage.setItem(FIELD_KEPT, choose.value);
    viewport.setTrocar(choose.value === 'trocar');
    for (const other of document.querySelectorAll<HTMLSelectElement>('select[name=field]')) other.value = choose.value;
  });
  viewport.setTrocar(choose.value === 'trocar');
  return field('View', choose);
}

/** Standard views. */
export function cameraButtons(viewport: Viewport): HTMLElement {
  const { orbit } = viewport;
  const to = (words: string, move: () => void): HTMLButtonElement =>
    button(words, () => {
      move();
      viewport.invalidate();
    });
  const buttons = element(
    'div',
    { class: 'buttons' },
    to('First view', () => orbit.reset()),
    to('From above', () => orbit.look(FROM_ABOVE)),
    to('Low, along the tissue', () => orbit.look(ALONG)),
    to('From the left', () => orbit.look(ASIDE, -QUARTER)),
    to('From the right', () => orbit.look(ASIDE, QUARTER)),
    to('Nearer', () => orbit.zoom(NEARER)),
    to('Farther', () => orbit.zoom(1 / NEARER)),
  );
  return element('div', { class: 'form' }, fieldChoice(viewport), buttons);
}

interface View {
  name: string;
  /** as in the address */
  camera: string;
}

function keptViews(): View[] {
  try {
    const kept = JSON.parse(localStorage.getItem(KEPT) ?? '[]') as unknown;
    if (!Array.isArray(kept)) return [];
    return (kept as Partial<View>[]).filter((view): view is View => typeof view.name === 'string' && typeof view.camera === 'string');
  } catch {
    return []; // stored by another program, or damaged
  }
}

/** Standard views, and those that this browser keeps. */
export function cameraViews(viewport: Viewport): HTMLElement {
  const list = element('div', { class: 'buttons', id: 'views' });
  const name = element('input', { name: 'view', maxLength: NAME_MAX, placeholder: 'name', aria: { label: 'Name of the view' } });
  const put = (views: View[]): void => {
    localStorage.setItem(KEPT, JSON.stringify(views));
    show();
  };
  const show = (): void => {
    list.replaceChildren(...keptViews().flatMap((view) => {
      const pose: CameraPose | null = readCamera(view.camera);
      if (!pose) return [];
      const go = button(view.name, () => {
        viewport.orbit.restore(pose);
        viewport.invalidate();
      });
      const forget = button('×', () => put(keptViews().filter(({ name: other }) => other !== view.name)), { aria: { label: `Delete the view ${view.name}` } });
      return [element('div', { class: 'choice' }, go, forget)];
    }));
  };
  const keep = button('Save this view', () => {
    const views = keptViews();
    const called = name.value.trim() || `View ${views.length + 1}`;
    put([...views.filter((view) => view.name !== called), { name: called, camera: cameraText(viewport.orbit.here) }].slice(-VIEWS_MAX));
    name.value = '';
  });
  show();
  return element('fieldset', {}, element('legend', {}, 'Camera'), element('div', { class: 'form' }, cameraButtons(viewport), list, element('div', { class: 'buttons' }, name, keep)));
}
