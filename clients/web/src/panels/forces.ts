// SPDX-License-Identifier: GPL-3.0-or-later
// The section that pins and unpins vertices, and applies outer forces to them.
import type { Control } from '../model/control';
import type { Selection } from '../wire/messages.gen';
import { text } from '../text/text';
import { attempt, button, element, field, problemPlace } from './dom';

type Vector = [number, number, number];

const KINDS = ['sphere', 'nearest', 'box', 'rim'] as const;
const MM = 1000;
const FORCE_N_MAX = 10;

/** Three numbers in a row, under one label; in millimetres where `scale` says so. */
function vectorField(label: string, name: string, unit: string, most: number): { row: HTMLElement; read(): Vector; show(values: Vector): void } {
  const inputs = ['x', 'y', 'z'].map((axis) =>
    element('input', {
      type: 'number', name: `${name}-${axis}`, value: '0', step: 'any', min: String(-most), max: String(most), aria: { label: `${label} ${axis}` },
    }),
  );
  const row = element('div', { class: 'field vector' }, element('span', {}, label), element('div', {}, ...inputs), element('small', {}, unit));
  return {
    row,
    read() {
      const values = inputs.map((input) => input.valueAsNumber);
      if (values.some((value) => !(Math.abs(value) <= most))) throw new Error(text.forces.outOfRange(label, most, unit));
      return values as Vector;
    },
    show(values) {
      inputs.forEach((input, i) => (input.value = String(Number(values[i].toFixed(2)))));
    },
  };
}

const metres = (millimetres: Vector): Vector => millimetres.map((value) => value / MM) as Vector;

/** Fields for a selection of vertices by their rest positions. */
function selectionFields(control: Control): { fields: HTMLElement[]; read(): Selection; refresh(): void } {
  const { model } = control;
  const kind = element('select', { name: 'selection' }, ...KINDS.map((value) => element('option', { value }, text.forces.kinds[value])));
  const layer = element('select', { name: 'selection-layer' });
  const center = vectorField(text.forces.point, 'center', 'mm', 1e5);
  const radius = element('input', { type: 'number', name: 'radius', value: '5', min: '0', max: '100000', step: 'any' });
  const radiusField = field(text.forces.radius, radius, 'mm');
  const least = vectorField(text.forces.from, 'least', 'mm', 1e5);
  const most = vectorField(text.forces.to, 'most', 'mm', 1e5);
  const atTip = button(text.forces.atTip, () => {
    const tip = model.toolState?.positionM;
    if (tip) center.show(tip.map((value) => value * MM) as Vector);
  });
  const show = (): void => {
    const placed = kind.value === 'sphere' || kind.value === 'nearest';
    center.row.hidden = atTip.hidden = !placed;
    radiusField.hidden = kind.value !== 'sphere';
    least.row.hidden = most.row.hidden = kind.value !== 'box';
  };
  kind.addEventListener('change', show);
  show();
  return {
    fields: [field(text.forces.vertices, kind), field(text.forces.ofLayer, layer), center.row, atTip, radiusField, least.row, most.row],
    refresh() {
      const before = layer.value;
      const names = model.joined?.description.layers.filter(({ kind: of }) => of !== 'links').map(({ name }) => name) ?? [];
      layer.replaceChildren(element('option', { value: '' }, text.forces.anyLayer), ...names.map((value) => element('option', { value }, value)));
      layer.value = names.includes(before) ? before : '';
    },
    read() {
      const of = layer.value === '' ? {} : { layer: layer.value };
      switch (kind.value as Selection['kind']) {
        case 'rim':
          if (layer.value === '') throw new Error(text.forces.noRim);
          return { kind: 'rim', ...of };
        case 'box':
          return { kind: 'box', least_m: metres(least.read()), most_m: metres(most.read()), ...of };
        case 'nearest':
          return { kind: 'nearest', center_m: metres(center.read()), ...of };
        case 'sphere':
          return { kind: 'sphere', center_m: metres(center.read()), radius_m: radius.valueAsNumber / MM, ...of };
      }
    },
  };
}

export function forcesSection(control: Control): HTMLElement {
  const { model } = control;
  const problem = problemPlace();
  const said = element('p', { class: 'about', aria: { role: 'status' } });
  const selection = selectionFields(control);
  const force = vectorField(text.forces.force, 'force', 'N', FORCE_N_MAX);
  const doing = (words: string, told: string, work: () => Promise<unknown>): HTMLButtonElement => {
    const press = button(words, () => {
      said.textContent = '';
      void attempt(problem, work, press).then((done) => {
        if (done !== null) said.textContent = told;
      });
    });
    return press;
  };
  const buttons = [
    doing(text.forces.pin, text.forces.pinned, () => control.call('pin', { selection: selection.read() })),
    doing(text.forces.unpin, text.forces.unpinned, () => control.call('unpin', { selection: selection.read() })),
    doing(text.forces.push, text.forces.pushed, () =>
      control.call('force.set', { selection: selection.read(), force_n: force.read() })),
    doing(text.forces.none, text.forces.noneLeft, () => control.call('force.set', { selection: selection.read(), force_n: [0, 0, 0] })),
  ];
  const refresh = (): void => {
    for (const one of buttons) one.disabled = !model.mayOperate || model.joined === null;
  };
  model.on('link', refresh);
  model.on('joined', () => {
    selection.refresh();
    refresh();
  });
  refresh();
  const [pin, unpin, push, none] = buttons;
  return element(
    'details',
    { class: 'section', id: 'forces' },
    element('summary', {}, text.forces.title),
    element(
      'div',
      { class: 'form' },
      ...selection.fields,
      element('div', { class: 'buttons' }, pin, unpin),
      force.row,
      element('div', { class: 'buttons' }, push, none),
      said,
      problem,
    ),
  );
}
