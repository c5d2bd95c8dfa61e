// SPDX-License-Identifier: Apache-2.0
// Gives the imports of dist's declarations the extension that Node's resolution wants: './header' becomes './header.js'.
import { globSync, readFileSync, writeFileSync } from 'node:fs';

for (const file of globSync('dist/**/*.d.ts')) {
  const text = readFileSync(file, 'utf8');
  writeFileSync(file, text.replace(/(from '|import\(')(\.[^']*?)(?:\.js)?'/g, "$1$2.js'"));
}
