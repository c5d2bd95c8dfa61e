// SPDX-License-Identifier: GPL-3.0-or-later
// Inputs for the numbers of a table, with unit, range and meaning.
import { memberWords, unitText } from '../model/sentences';
import { text } from '../text/text';
import type { Parameter } from '../wire/messages.gen';
import { element, field, short } from './dom';

export interface ParameterInputs {
  fields: HTMLElement[];
  /** Returns all members; unchanged members keep all their digits. Throws a sentence if a number is out of range. */
  read(): Record<string, number>;
  /** Shows the present values. A number that was typed and not applied yet stays. */
  show(values: Readonly<Record<string, unknown>>): void;
  /** Hides parameters that the shown tool does not have; they keep their values. */
  offer(makesSense: (name: string) => boolean): void;
  /** Discards typed numbers. */
  clear(): void;
}

interface Shown {
  unit: string;
  /** shown value over the value of the daemon */
  scale: number;
}

/** Shown units: lengths in millimetres, angles in degrees, others as in the protocol. */
const SHOWN: Readonly<Record<string, Shown>> = {
  'm': { unit: 'mm', scale: 1000 },
  'm/s': { unit: 'mm/s', scale: 1000 },
  'm^2': { unit: 'mm²', scale: 1e6 },
  'm^2/s': { unit: 'mm²/s', scale: 1e6 },
  'rad': { unit: '°', scale: 180 / Math.PI },
  'rad/s': { unit: '°/s', scale: 180 / Math.PI },
  'degC': { unit: '°C', scale: 1 },
  'kg/m^3': { unit: 'kg/m³', scale: 1 },
  '1': { unit: '', scale: 1 },
};
const DIGITS = 9; // digits that a number keeps when it is converted and back; more than users type
const SHOWN_DIGITS = 5; // shown digits of an unchanged number, which is applied with all its digits

const rounded = (value: number): number => Number(value.toPrecision(DIGITS));

export function parameterInputs(parameters: readonly Parameter[]): ParameterInputs {
  const inputs = parameters.map((parameter) => {
    const { unit, scale } = SHOWN[parameter.unit] ?? { unit: unitText(parameter.unit), scale: 1 };
    const [least, most] = [rounded(parameter.least * scale), rounded(parameter.most * scale)];
    const input = element('input', { type: 'number', name: parameter.name, min: String(least), max: String(most), step: 'any' });
    const title = text.parameters.title(parameter.meaning, short(least), short(most));
    return { parameter, scale, unit, least, most, input, label: field(memberWords(parameter.name), input, unit, title), shown: '', exact: 0 };
  });
  return {
    fields: inputs.map(({ label }) => label),
    show(values) {
      for (const one of inputs) {
        const value = values[one.parameter.name];
        one.exact = typeof value === 'number' ? value : one.parameter.default;
        const next = String(Number((one.scale * one.exact).toPrecision(SHOWN_DIGITS)));
        if (one.input.value === one.shown) one.input.value = next;
        one.shown = next;
      }
    },
    offer(makesSense) {
      for (const { parameter, label } of inputs) label.hidden = !makesSense(parameter.name);
    },
    clear() {
      for (const one of inputs) one.input.value = one.shown = '';
    },
    read() {
      const values: Record<string, number> = {};
      for (const { parameter, scale, unit, least, most, input, shown, exact } of inputs) {
        const value = input.valueAsNumber;
        if (input.value === shown) {
          values[parameter.name] = exact;
          continue;
        }
        if (!(value >= least && value <= most))
          throw new Error(text.parameters.outOfRange(memberWords(parameter.name), parameter.meaning, short(least), short(most), unit));
        values[parameter.name] = Math.min(Math.max(value / scale, parameter.least), parameter.most);
      }
      return values;
    },
  };
}
