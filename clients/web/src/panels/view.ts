// SPDX-License-Identifier: GPL-3.0-or-later
// How the picture is drawn: layers, wireframe, scalars as colour with a legend, force, light or dark.
import type { Control } from '../model/control';
import { colourAt } from '../model/colour_maps';
import type { ViewOptions, Viewport } from '../scene/viewport';
import { attempt, button, byId, element, field, problemPlace, save, short } from './dom';
import type { Panel } from './tabs';

const COLOURINGS: readonly (readonly [ViewOptions['colouring'], string])[] = [
  ['tissue', 'as tissue'],
  ['exposure', 'heat exposure'],
  ['charring', 'char'],
  ['stress', 'stress'],
];

function check(words: string, name: string, change: (on: boolean) => void, checked = false): HTMLElement {
  const box = element('input', { type: 'checkbox', name, checked });
  box.addEventListener('change', () => change(box.checked));
  return element('label', { class: 'check' }, box, words);
}

function legendCanvas(): HTMLCanvasElement {
  const canvas = element('canvas', { width: 128, height: 1, aria: { hidden: 'true' } });
  const context = canvas.getContext('2d');
  for (let i = 0; context && i < 128; i++) {
    context.fillStyle = `rgb(${colourAt(i / 127).join()})`;
    context.fillRect(i, 0, 1, 1);
  }
  return canvas;
}

function legend(control: Control, options: () => ViewOptions): () => void {
  const place = byId('legend');
  const title = element('span');
  const least = element('small', {}, '0');
  const most = element('small');
  place.append(title, legendCanvas(), element('div', { class: 'ends' }, least, most));
  const refresh = (): void => {
    const { colouring } = options();
    place.hidden = colouring === 'tissue';
    title.textContent = colouring === 'exposure' ? 'Heat exposure over ignition' : colouring === 'charring' ? 'Char' : 'Von Mises stress';
    const scale = control.model.frame?.stressScalePa ?? 0;
    const text = colouring === 'stress' ? `${short(scale, 2)} Pa` : '1';
    if (most.textContent !== text) most.textContent = text;
  };
  control.model.on('frame', () => {
    if (options().colouring === 'stress') refresh();
  });
  return refresh;
}

function themes(viewport: Viewport): HTMLElement {
  const choose = element(
    'select',
    { name: 'theme' },
    ...['as the system', 'dark', 'light'].map((words) => element('option', { value: words }, words)),
  );
  const system = window.matchMedia('(prefers-color-scheme: dark)');
  const apply = (): void => {
    const dark = choose.value === 'dark' || (choose.value !== 'light' && system.matches);
    document.documentElement.dataset['theme'] = dark ? 'dark' : 'light';
    viewport.setTheme(dark);
  };
  choose.value = localStorage.getItem('theme') ?? 'as the system';
  choose.addEventListener('change', () => {
    localStorage.setItem('theme', choose.value);
    apply();
  });
  system.addEventListener('change', apply);
  apply();
  return field('Light', choose);
}

export function viewPanel(control: Control, viewport: Viewport): Panel {
  const { model } = control;
  let options: ViewOptions = { wireframe: false, hiddenLayers: new Set(), colouring: 'tissue', forceArrow: false };
  const refreshLegend = legend(control, () => options);
  const set = (change: Partial<ViewOptions>): void => {
    options = { ...options, ...change };
    viewport.setOptions(options);
    control.setStress(options.colouring === 'stress');
    refreshLegend();
  };
  const colouring = element('select', { name: 'colouring', id: 'colouring' }, ...COLOURINGS.map(([value, words]) => element('option', { value }, words)));
  colouring.addEventListener('change', () => set({ colouring: colouring.value as ViewOptions['colouring'] }));
  const layers = element('fieldset', {}, element('legend', {}, 'Layers'));
  model.on('joined', (joined) => {
    const names = [...new Set(joined?.batches.map((batch) => batch.layer))];
    const boxes = names.map((name) =>
      check(name, `layer-${name}`, (on) => {
        const hidden = new Set(options.hiddenLayers);
        if (on) hidden.delete(name);
        else hidden.add(name);
        set({ hiddenLayers: hidden });
      }, !options.hiddenLayers.has(name)),
    );
    layers.replaceChildren(element('legend', {}, 'Layers'), ...boxes);
  });
  const problem = problemPlace();
  const png = button('Save the picture', () => {
    void attempt(problem, async () => save(`cautery-${model.session ?? 'view'}-${model.frame?.tick ?? 0}.png`, await viewport.png()), png);
  });
  const home = button('Camera home', () => {
    viewport.orbit.reset();
    viewport.invalidate();
  });
  const body = element(
    'div',
    {},
    field('Colour', colouring),
    layers,
    check('Wireframe', 'wireframe', (on) => set({ wireframe: on })),
    check('Force on the tool', 'force', (on) => set({ forceArrow: on })),
    themes(viewport),
    element('div', { class: 'buttons' }, home, png),
    problem,
  );
  return { id: 'view', title: 'View', body };
}
