// SPDX-License-Identifier: GPL-3.0-or-later
import { fileURLToPath } from 'node:url';
import { defineConfig } from 'vitest/config';

const here = (path: string): string => fileURLToPath(new URL(path, import.meta.url));

export default defineConfig({
  resolve: {
    alias: [{ find: /^three$/, replacement: here('./node_modules/three/build/three.module.js') }, { find: /^three\//, replacement: here('./node_modules/three/') }, { find: /^typescript$/, replacement: here('./node_modules/typescript/lib/typescript.js') }],
  },
  test: {
    globals: true,
    dir: here('../../tests/browser/unit'),
    include: ['**/*.test.ts'],
    pool: 'forks',
    maxWorkers: 1,
    isolate: false, // a process for each file took three times as long; each file puts back what it replaces
  },
});
