// SPDX-License-Identifier: GPL-3.0-or-later
// Views of the camera: standard views, and views that the user has saved under a name.
import type { CameraPose } from '../scene/orbit';
import type { Viewport } from '../scene/viewport';
import { text } from '../text/text';
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

const FIELDS = ['trocar', 'open'] as const;
const FIELD_KEPT = 'field';

/** The round picture of an endoscope, or the open field; the browser keeps the choice. One for each place that shows it. */
function fieldChoice(viewport: Viewport): HTMLElement {
  const choose = element('select', { name: 'field' }, ...FIELDS.map((value) => element('option', { value }, text.camera.fields[value])));
  choose.value = localStorage.getItem(FIELD_KEPT) === 'open' ? 'open' : 'trocar';
  choose.addEventListener('change', () => {
    localStorage.setItem(FIELD_KEPT, choose.value);
    viewport.setTrocar(choose.value === 'trocar');
    for (const other of document.querySelectorAll<HTMLSelectElement>('select[name=field]')) other.value = choose.value;
  });
  viewport.setTrocar(choose.value === 'trocar');
  return field(text.camera.view, choose);
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
    to(text.camera.first, () => orbit.reset()),
    to(text.camera.above, () => orbit.look(FROM_ABOVE)),
    to(text.camera.low, () => orbit.look(ALONG)),
    to(text.camera.left, () => orbit.look(ASIDE, -QUARTER)),
    to(text.camera.right, () => orbit.look(ASIDE, QUARTER)),
    to(text.camera.nearer, () => orbit.zoom(NEARER)),
    to(text.camera.farther, () => orbit.zoom(1 / NEARER)),
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
  const name = element('input', { name: 'view', maxLength: NAME_MAX, placeholder: text.camera.name, aria: { label: text.camera.nameLabel } });
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
      const forget = button('×', () => put(keptViews().filter(({ name: other }) => other !== view.name)), { aria: { label: text.camera.deleteView(view.name) } });
      return [element('div', { class: 'choice' }, go, forget)];
    }));
  };
  const keep = button(text.camera.save, () => {
    const views = keptViews();
    const called = name.value.trim() || text.camera.unnamed(views.length + 1);
    put([...views.filter((view) => view.name !== called), { name: called, camera: cameraText(viewport.orbit.here) }].slice(-VIEWS_MAX));
    name.value = '';
  });
  show();
  return element('fieldset', {}, element('legend', {}, text.camera.title), element('div', { class: 'form' }, cameraButtons(viewport), list, element('div', { class: 'buttons' }, name, keep)));
}
