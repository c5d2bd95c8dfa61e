// SPDX-License-Identifier: GPL-3.0-or-later
// Inputs for the members of a material that are not single numbers: models and limits to choose, and values for each
// direction of the material.
import { text, type Text } from '../text/text';
import { LIMITS, MODELS, PROJECTIONS, type Layer } from '../wire/messages.gen';
import { element, field } from './dom';

type Kind = Layer['kind'];
type Values = Readonly<Record<string, unknown>>;
type Option = (typeof LIMITS | typeof MODELS | typeof PROJECTIONS)[number];
/** A direction, as in the names of the inputs; `text` has its words. */
type Entry = keyof Text['limits']['entries'];

interface Choice {
  name: keyof Text['limits']['choices'];
  options: readonly Option[];
  default: Option;
}

interface Directions {
  name: keyof Text['limits']['vectors'];
  entries: readonly Entry[];
  default: readonly number[];
  least: number;
  most: number;
  /** shown only with this limit */
  when?: 'target' | 'range';
}

const LIMIT: Omit<Choice, 'default'> = { name: 'limit', options: LIMITS };
const PROJECTION: Choice = { name: 'projection', options: PROJECTIONS, default: 'closed_form' };
const SHEET: Choice[] = [{ ...LIMIT, default: 'target' }, PROJECTION];
const FAT: Choice[] = [
  { name: 'model', options: MODELS, default: 'neohookean' },
  { ...LIMIT, default: 'none' },
  PROJECTION,
];
const CHOICES: Readonly<Record<Kind, readonly Choice[]>> = { fascia: SHEET, membrane: SHEET, fat: FAT, links: [] };

const AXES = ['along-fibres', 'across', 'through'] as const;
const SHEAR = ['shear-along-across', 'shear-along-through', 'shear-across-through'] as const;
const XYZ = ['x', 'y', 'z'] as const;

function directions(count: 2 | 3): readonly Directions[] {
  const axes = AXES.slice(0, count);
  const same = (value: number): number[] => axes.map(() => value);
  const shears = SHEAR.slice(0, count === 2 ? 1 : 3);
  return [
    { name: 'target', entries: [...axes, ...shears], default: [...same(1), ...shears.map(() => 0)], least: -100, most: 100, when: 'target' },
    { name: 'strain_min', entries: axes, default: same(-0.1), least: -0.99, most: 0, when: 'range' },
    { name: 'strain_max', entries: axes, default: same(0.1), least: 0, most: 100, when: 'range' },
    { name: 'shrink', entries: XYZ.slice(0, count), default: same(1), least: 0.001, most: 10 },
  ];
}
const DIRECTIONS: Readonly<Record<Kind, readonly Directions[]>> = {
  fascia: directions(2), membrane: directions(2), fat: directions(3), links: [],
};

/** Returns the members of a material of this kind that have inputs in this module. */
export const limitMembers = (kind: Kind): string[] => [...CHOICES[kind], ...DIRECTIONS[kind]].map(({ name }) => name);

export interface LimitInputs {
  fields: HTMLElement[];
  /** Returns all members. Throws a sentence if a number is out of range. */
  read(): Record<string, string | number[]>;
  show(values: Values): void;
}

export function limitInputs(kind: Kind): LimitInputs {
  const choices = CHOICES[kind].map((choice) => {
    const select = element('select', { name: choice.name }, ...choice.options.map((value) => element('option', { value }, text.limits.options[value] ?? value)));
    return { choice, select, label: field(text.limits.choices[choice.name], select) };
  });
  const vectors = DIRECTIONS[kind].map((vector) => {
    const inputs = vector.entries.map((entry) =>
      element('input', {
        type: 'number', name: `${vector.name}-${entry}`, step: 'any', min: String(vector.least), max: String(vector.most),
      }),
    );
    const { entries, entryOf, titles, vectors: words } = text.limits;
    const title = vector.name === 'shrink' || vector.name === 'target' ? titles[vector.name] : '';
    return { vector, inputs, labels: inputs.map((input, i) => field(entryOf(words[vector.name], entries[vector.entries[i]]), input, '', title)) };
  });
  const limit = choices.find(({ choice }) => choice.name === 'limit');
  const hide = (): void => {
    for (const { vector, labels } of vectors)
      for (const label of labels) label.hidden = vector.when !== undefined && limit?.select.value !== vector.when;
  };
  limit?.select.addEventListener('change', hide);
  return {
    fields: [...choices.map(({ label }) => label), ...vectors.flatMap(({ labels }) => labels)],
    show(values) {
      for (const { choice, select } of choices) {
        const value = values[choice.name];
        select.value = typeof value === 'string' ? value : choice.default;
      }
      for (const { vector, inputs } of vectors) {
        const given = values[vector.name];
        const shown = Array.isArray(given) ? (given as number[]) : vector.default;
        inputs.forEach((input, i) => (input.value = String(shown[i])));
      }
      hide();
    },
    read() {
      const values: Record<string, string | number[]> = {};
      for (const { choice, select } of choices) values[choice.name] = select.value;
      for (const { vector, inputs } of vectors) {
        const { name, least, most } = vector;
        const given = inputs.map((input) => input.valueAsNumber);
        if (given.some((value) => !(value >= least && value <= most))) throw new Error(text.limits.outOfRange(text.limits.vectors[name], least, most));
        values[name] = given;
      }
      return values;
    },
  };
}
