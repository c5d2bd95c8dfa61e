// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that the table of tests/browser/README.md is correct: each file contains the tests that the table lists for it.
import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

const POINTS = 19;
const folder = fileURLToPath(new URL('..', import.meta.url));
const rows = [...readFileSync(`${folder}README.md`, 'utf8').matchAll(/^\| (\d+) \| [^|]+ \| ([^|]+) \|$/gm)].map(([, point, shown]) => ({ point: Number(point), shown }));

/** Returns the files and names of a row's tests. */
function named(shown: string): [string, string][] {
  return shown.split('; ').flatMap((part) => {
    const file = /^`([^`]+\.test\.ts)`: /.exec(part)?.[1] ?? 'no file';
    return [...part.matchAll(/"([^"]+)"/g)].map(([, name]): [string, string] => [file, name]);
  });
}

describe('the table of points', () => {
  it('has every point', () => {
    expect([...new Set(rows.map(({ point }) => point))]).toEqual(Array.from({ length: POINTS }, (_, i) => i + 1));
  });

  it('names tests that are there', () => {
    const all = rows.map(({ shown }) => named(shown));
    expect(all.filter((tests) => tests.length === 0)).toEqual([]);
    // Finds a name as an argument of `it`, or as the first value of a row in a table of cases.
    const missing = all.flat().filter(([file, name]) => !readFileSync(folder + file, 'utf8').includes(`'${name}',`));
    expect(missing).toEqual([]);
  });
});
