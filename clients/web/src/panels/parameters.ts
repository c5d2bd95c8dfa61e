// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers of a table as inputs with unit, range and meaning.
import type { Parameter } from '../wire/messages.gen';
import { element, field, short } from './dom';

export interface ParameterInputs {
  fields: HTMLElement[];
  /** members that differ from what was shown; throws a sentence if one is out of range */
  read(): Record<string, number>;
  /** what is in force; a number that somebody has typed and not applied yet stays */
  show(values: Readonly<Record<string, unknown>>): void;
  /** forgets what was typed */
  clear(): void;
}

function words(name: string): string {
  const bare = name.replace(/_(m_s|m2_s|m2|m|c|pa|rad_s|rad|per_s|n_m|ns_m|n|nm|kg_m3|s)$/, '');
  return bare.charAt(0).toUpperCase() + bare.slice(1).replaceAll('_', ' ');
}

const UNITS: Readonly<Record<string, string>> = { degC: '°C', 'm^2': 'm²', 'm^2/s': 'm²/s', 'kg/m^3': 'kg/m³', '1': '' };

export function parameterInputs(parameters: readonly Parameter[]): ParameterInputs {
  const inputs = parameters.map((parameter) => {
    const { least, most } = parameter;
    const input = element('input', { type: 'number', name: parameter.name, min: String(least), max: String(most), step: 'any' });
    const title = `${parameter.meaning}; ${short(least)} to ${short(most)}`;
    const unit = UNITS[parameter.unit] ?? parameter.unit;
    return { parameter, input, label: field(words(parameter.name), input, unit, title), shown: '' };
  });
  return {
    fields: inputs.map(({ label }) => label),
    show(values) {
      for (const one of inputs) {
        const value = values[one.parameter.name];
        const next = String(typeof value === 'number' ? value : one.parameter.default);
        if (one.input.value === one.shown) one.input.value = next;
        one.shown = next;
      }
    },
    clear() {
      for (const one of inputs) one.input.value = one.shown = '';
    },
    read() {
      const values: Record<string, number> = {};
      for (const { parameter, input } of inputs) {
        const value = input.valueAsNumber;
        const { least, most, meaning } = parameter;
        if (!(value >= least && value <= most))
          throw new Error(`${words(parameter.name)} (${meaning}) must be from ${short(least)} to ${short(most)}`);
        values[parameter.name] = value;
      }
      return values;
    },
  };
}
