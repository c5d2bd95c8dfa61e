// SPDX-License-Identifier: GPL-3.0-or-later
// Materials per layer: the numbers of the protocol's tables with units and ranges.
import type { Control } from '../model/control';
import { PARAMETERS, type Layer, type MaterialSet } from '../wire/messages.gen';
import { attempt, element, field, problemPlace } from './dom';
import { parameterInputs } from './parameters';
import type { Panel } from './tabs';

/** Members of a layer that are not of its material. */
const LAYER_ONLY = ['kind', 'name', 'mesh', 'of', 'to', 'fibre', 'regions'];

function materialOf(layer: Layer): Record<string, unknown> {
  return Object.fromEntries(Object.entries(layer).filter(([name]) => !LAYER_ONLY.includes(name)));
}

function layerForm(control: Control, layer: Layer): HTMLElement {
  const problem = problemPlace();
  const inputs = parameterInputs(PARAMETERS[layer.kind]);
  inputs.show({ ...layer });
  const shrink = 'shrink' in layer ? layer.shrink ?? [] : [];
  const shrinks = shrink.map((value, i) =>
    element('input', { type: 'number', min: '0.001', max: '10', step: 'any', value: String(value), name: `shrink-${i}` }),
  );
  const apply = element('button', { type: 'submit', disabled: !control.model.mayOperate }, 'Apply');
  const form = element(
    'form',
    { class: 'form' },
    ...inputs.fields,
    ...shrinks.map((input, i) => field(`Shrink ${'xyz'[i]}`, input, '', 'squared stretch of cut rims; 1: none')),
    apply,
    problem,
  );
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    const work = async (): Promise<void> => {
      const given = shrinks.length > 0 ? { shrink: shrinks.map((input) => input.valueAsNumber) } : {};
      const material = { ...materialOf(layer), ...inputs.read(), ...given };
      await control.setMaterial({ ...material, kind: layer.kind, layer: layer.name } as MaterialSet);
    };
    void attempt(problem, work, apply);
  });
  return element('details', { class: 'section', open: true }, element('summary', {}, `${layer.name} (${layer.kind})`), form);
}

function gravityForm(control: Control): HTMLElement {
  const problem = problemPlace();
  const gravity = control.model.joined?.description.definition.gravity_m_s2 ?? [0, 0, -9.81];
  const inputs = gravity.map((value, i) =>
    element('input', { type: 'number', min: '-100', max: '100', step: 'any', value: String(value), name: `gravity-${'xyz'[i]}` }),
  );
  const apply = element('button', { type: 'submit', disabled: !control.model.mayOperate }, 'Apply');
  const form = element('form', { class: 'form' }, ...inputs.map((input, i) => field(`Gravity ${'xyz'[i]}`, input, 'm/s²')), apply, problem);
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    const [x, y, z] = inputs.map((input) => input.valueAsNumber);
    void attempt(problem, () => control.call('gravity.set', { gravity_m_s2: [x, y, z] }), apply);
  });
  return element('details', { class: 'section' }, element('summary', {}, 'Gravity'), form);
}

export function materialsPanel(control: Control): Panel {
  const { model } = control;
  const body = element('div');
  let shown = '';
  const show = (): void => {
    const layers = model.joined?.description.definition.layers ?? [];
    const now = JSON.stringify([model.session, layers, model.mayOperate]);
    if (now === shown) return;
    shown = now;
    body.replaceChildren(...layers.map((layer) => layerForm(control, layer)), gravityForm(control));
    if (layers.length === 0) body.replaceChildren(element('p', { class: 'about' }, 'Join a session to see its materials.'));
  };
  model.on('joined', show);
  model.on('tools', show);
  show();
  return { id: 'materials', title: 'Materials', body };
}
