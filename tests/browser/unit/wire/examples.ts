// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the hexadecimal examples of protocol/examples.md, which the C codecs write.
import { readFileSync } from 'node:fs';

const text = readFileSync(new URL('../../../../protocol/examples.md', import.meta.url), 'utf8');

export function example(heading: string): Uint8Array {
  const section = text.split(`## ${heading}\n`)[1];
  const block = section?.split('```')[1];
  if (block === undefined) throw new Error(`no example "${heading}"`);
  const digits = block.replace(/^[0-9a-f]{4} {2}/gm, '').replace(/\s/g, '');
  return Uint8Array.from(digits.match(/../g) ?? [], (pair) => parseInt(pair, 16));
}
