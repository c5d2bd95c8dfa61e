// SPDX-License-Identifier: GPL-3.0-or-later
// Materials per layer and region: the protocol's numbers with units and ranges; gravity; pins and forces.
import type { Control } from '../model/control';
import { text } from '../text/text';
import { PARAMETERS, type Layer } from '../wire/messages.gen';
import { attempt, element, field, problemPlace } from './dom';
import { forcesSection } from './forces';
import { limitInputs } from './limits';
import { parameterInputs } from './parameters';
import type { Panel } from './tabs';

/** A layer's default material, or that of a region of its mesh file, which has the default's where it says nothing. */
interface Material {
  layer: Layer;
  region: number | null;
  /** what the layer says, members besides those of its material included */
  values: Record<string, unknown>;
}

function materialsOf(layer: Layer): Material[] {
  const values = { ...layer };
  const regions = 'regions' in layer ? layer.regions ?? [] : [];
  return [
    { layer, region: null, values },
    ...regions.map(({ region, ...own }) => ({ layer, region, values: { ...values, ...own } })),
  ];
}

function materialForm(control: Control, { layer, region, values }: Material): HTMLElement {
  const problem = problemPlace();
  const inputs = parameterInputs(PARAMETERS[layer.kind]);
  const limits = limitInputs(layer.kind);
  inputs.show(values);
  limits.show(values);
  const apply = element('button', { type: 'submit', disabled: !control.model.mayOperate }, text.materials.apply);
  const form = element('form', { class: 'form' }, ...inputs.fields, ...limits.fields, apply, problem);
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    const work = async (): Promise<void> => {
      const where = region === null ? {} : { region };
      await control.setMaterial({ ...inputs.read(), ...limits.read(), ...where, kind: layer.kind, layer: layer.name });
    };
    void attempt(problem, work, apply);
  });
  const words = region === null ? text.materials.layer(layer.name, text.materials.kinds[layer.kind]) : text.materials.region(layer.name, region);
  return element('details', { class: 'section', open: region === null }, element('summary', {}, words), form);
}

function gravityForm(control: Control): HTMLElement {
  const problem = problemPlace();
  const gravity = control.model.joined?.description.definition.gravity_m_s2 ?? [0, 0, -9.81];
  const inputs = gravity.map((value, i) =>
    element('input', { type: 'number', min: '-100', max: '100', step: 'any', value: String(value), name: `gravity-${'xyz'[i]}` }),
  );
  const apply = element('button', { type: 'submit', disabled: !control.model.mayOperate }, text.materials.apply);
  const form = element('form', { class: 'form' }, ...inputs.map((input, i) => field(text.materials.gravityAlong('xyz'[i]), input, 'm/s²')), apply, problem);
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    const [x, y, z] = inputs.map((input) => input.valueAsNumber);
    void attempt(problem, () => control.call('gravity.set', { gravity_m_s2: [x, y, z] }), apply);
  });
  return element('details', { class: 'section' }, element('summary', {}, text.materials.gravity), form);
}

/** New forms for old ones, with the same ones open and the focus on the same control. */
function replaceForms(place: HTMLElement, forms: HTMLElement[]): void {
  const controls = (): HTMLElement[] => [...place.querySelectorAll<HTMLElement>('summary, input, select, button')];
  const focused = controls().findIndex((control) => control === document.activeElement);
  const open = new Map([...place.querySelectorAll('details')].map((details) => [details.firstChild?.textContent, details.open]));
  place.replaceChildren(...forms);
  for (const details of place.querySelectorAll('details')) details.open = open.get(details.firstChild?.textContent) ?? details.open;
  controls()[focused]?.focus();
}

export function materialsPanel(control: Control): Panel {
  const { model } = control;
  const changing = element('div');
  const body = element('div', {}, changing, forcesSection(control));
  let shown = '';
  const show = (): void => {
    const layers = model.joined?.description.definition.layers ?? [];
    const now = JSON.stringify([model.session, layers, model.mayOperate]);
    if (now === shown) return;
    shown = now;
    const forms = [...layers.flatMap(materialsOf).map((material) => materialForm(control, material)), gravityForm(control)];
    replaceForms(changing, forms);
    if (layers.length === 0) changing.replaceChildren(element('p', { class: 'about' }, text.materials.empty));
  };
  model.on('joined', show);
  model.on('tools', show);
  show();
  return { id: 'materials', title: text.materials.title, body };
}
