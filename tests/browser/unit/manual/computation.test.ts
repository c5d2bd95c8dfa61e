// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that the chapter about the model has every equation of the paper exactly once.
import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

import { render } from '../../../../clients/web/manual/markdown.ts';

const EQUATIONS = 24; // number of equations of the paper, with those of its appendices

it('every equation is placed, with its number', () => {
  const source = readFileSync(fileURLToPath(new URL('../../../../deploy/manual/computation.md', import.meta.url)), 'utf8');
  const { html, anchors } = render(source, (link) => link);
  const numbers = Array.from({ length: EQUATIONS }, (_, at) => at + 1);
  expect([...source.matchAll(/\\tag\{(\d+)\}/g)].map((found) => Number(found[1])).sort((a, b) => a - b)).toEqual(numbers);
  expect(numbers.filter((number) => !anchors.has(`eq-${number}`))).toEqual([]);
  expect(html.match(/<math display="block"/g)!.length).toBeGreaterThanOrEqual(EQUATIONS);
});
