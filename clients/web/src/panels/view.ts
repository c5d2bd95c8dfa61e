// SPDX-License-Identifier: GPL-3.0-or-later
// The panel with options of the picture: layers, wireframe, scalars as colours with a legend, force, theme.
import type { Control } from '../model/control';
import { colourAt, MAP_OF, type ColourMap, type Scalar } from '../model/colour_maps';
import type { ViewOptions, Viewport } from '../scene/viewport';
import { text } from '../text/text';
import type { Frame } from '../wire/worker_messages';
import { cameraViews } from './camera';
import { attempt, button, byId, check, element, field, problemPlace, save, short } from './dom';
import { sceneRecordingButton } from './scene_recording';
import type { Panel } from './tabs';
import { videoButton } from './video';

const COLOURINGS: readonly ViewOptions['colouring'][] = ['tissue', 'exposure', 'charring', 'stress', 'temperature'];
const THEMES = ['as the system', 'dark', 'light'] as const; // as the browser stores them

function paint(canvas: HTMLCanvasElement, map: ColourMap): void {
  const context = canvas.getContext('2d');
  const { width } = canvas;
  for (let i = 0; context && i < width; i++) {
    context.fillStyle = `rgb(${colourAt(map, i / (width - 1)).join()})`;
    context.fillRect(i, 0, 1, 1);
  }
}

/** Returns the values at both ends of the colours. */
function endsOf(scalar: Scalar, frame: Frame | null): readonly [string, string] {
  if (scalar === 'stress') return ['0', `${short(frame?.stressScalePa ?? 0, 2)} Pa`];
  if (scalar !== 'temperature') return ['0', '1'];
  const range = frame?.temperatureRangeC;
  return range ? [`${range[0].toFixed(0)} °C`, `${range[1].toFixed(0)} °C`] : [text.view.noValues, ''];
}

function legend(control: Control, options: () => ViewOptions): () => void {
  const place = byId('legend');
  const title = element('span');
  const colours = element('canvas', { width: 128, height: 1, aria: { hidden: 'true' } });
  const places = [element('small'), element('small')] as const;
  place.append(title, colours, element('div', { class: 'ends' }, ...places));
  const tellEnds = (scalar: Scalar): void => {
    const ends = endsOf(scalar, control.model.frame);
    places.forEach((end, i) => {
      if (end.textContent !== ends[i]) end.textContent = ends[i];
    });
  };
  control.model.on('frame', () => {
    const { colouring } = options();
    if (colouring !== 'tissue') tellEnds(colouring);
  });
  return () => {
    const { colouring } = options();
    place.hidden = colouring === 'tissue';
    if (colouring === 'tissue') return;
    title.textContent = text.view.legends[colouring];
    paint(colours, MAP_OF[colouring]);
    tellEnds(colouring);
  };
}

function themes(viewport: Viewport): HTMLElement {
  const choose = element(
    'select',
    { name: 'theme' },
    ...THEMES.map((value) => element('option', { value }, text.view.themes[value])),
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
  return field(text.view.theme, choose);
}

export function viewPanel(control: Control, viewport: Viewport, inspectSwitch: HTMLElement, clip: HTMLElement): Panel {
  const { model } = control;
  let options: ViewOptions = { wireframe: false, hiddenLayers: new Set(), colouring: 'tissue', forceArrow: false };
  const refreshLegend = legend(control, () => options);
  const set = (change: Partial<ViewOptions>): void => {
    options = { ...options, ...change };
    viewport.setOptions(options);
    control.show(options.colouring === 'stress' || options.colouring === 'temperature' ? options.colouring : null);
    refreshLegend();
  };
  const colouring = element('select', { name: 'colouring', id: 'colouring' }, ...COLOURINGS.map((value) => element('option', { value }, text.view.colourings[value])));
  colouring.addEventListener('change', () => set({ colouring: colouring.value as ViewOptions['colouring'] }));
  const layers = element('fieldset', {}, element('legend', {}, text.view.layers));
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
    layers.replaceChildren(element('legend', {}, text.view.layers), ...boxes);
  });
  const problem = problemPlace();
  const png = button(text.view.png, () => {
    void attempt(problem, async () => save(`cautery-${model.session ?? 'view'}-${model.frame?.tick ?? 0}.png`, await viewport.png()), png);
  });
  const body = element(
    'div',
    {},
    field(text.view.colour, colouring),
    layers,
    check(text.view.wireframe, 'wireframe', (on) => set({ wireframe: on })),
    check(text.view.force, 'force', (on) => set({ forceArrow: on })),
    inspectSwitch,
    clip,
    cameraViews(viewport),
    themes(viewport),
    element('div', { class: 'buttons' }, png, videoButton(model, viewport, problem), sceneRecordingButton(model, viewport, problem)),
    problem,
  );
  return { id: 'view', title: text.view.title, body };
}
