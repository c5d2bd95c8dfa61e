// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that type, spacing and corners use one scale: the variables at the head of the style sheet.
import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

const css = readFileSync(fileURLToPath(new URL('../../../clients/web/src/style.css', import.meta.url)), 'utf8').replace(/\/\*[^]*?\*\//g, '');
const declarations = [...css.matchAll(/(?<=[{;\s])([a-z-]+): ([^;{}]+)(?=[;}])/g)].map(([, property, value]) => ({ property, value: value.trim() }));

const values = (of: RegExp): string[] => declarations.filter(({ property }) => of.test(property)).map(({ value }) => value);
/** Returns the part of a value that is neither of the scale, nor zero or one pixel, nor inherited. */
const offScale = (value: string, scale: string): string =>
  value.replace(new RegExp(`var\\(--${scale}[a-z0-9-]*\\)`, 'g'), '').replace(/\b(auto|inherit)\b|!important|(?<![\d.])-?[01](px)?(?![\d.a-z])/g, '').trim();

describe('the style sheet', () => {
  it.each([
    ['spaces', /^(padding|margin|gap|row-gap|column-gap)(-[a-z]+)*$/, 'space-', 60],
    ['sizes of type', /^font-size$/, 'text', 4],
    ['corners', /^border-radius$/, 'round', 10],
  ] as const)('takes %s from the scale', (_what, properties, scale, least) => {
    const used = values(properties);
    expect(used.length).toBeGreaterThan(least); // otherwise the expressions above find nothing
    expect(used.filter((value) => offScale(value, scale) !== '')).toEqual([]);
  });

  it('uses no variable that it does not have', () => {
    const had = new Set([...css.matchAll(/(--[a-z0-9-]+):/g)].map(([, name]) => name));
    const placed = ['--fx', '--fy', '--tx', '--ty']; // variables that panels/cue.ts sets
    const used = new Set([...css.matchAll(/var\((--[a-z0-9-]+)\)/g)].map(([, name]) => name));
    expect([...used].filter((name) => !had.has(name) && !placed.includes(name))).toEqual([]);
  });
});
