// SPDX-License-Identifier: GPL-3.0-or-later
import { fileURLToPath } from 'node:url';
import { defineConfig } from 'vitest/config';

const here = (path: string): string => fileURLToPath(new URL(path, import.meta.url));

// Pages in Chromium against real daemons, two files at a time: they wait more than they compute.
export default defineConfig({
  resolve: {
    alias: {
      '@mcap/core': here('./node_modules/@mcap/core'),
      '@foxglove/schemas': here('./node_modules/@foxglove/schemas'),
      'ajv': here('./node_modules/ajv'),
      'playwright-core': here('./node_modules/playwright-core/index.mjs'),
      '@axe-core/playwright': here('./node_modules/@axe-core/playwright/dist/index.mjs'),
    },
  },
  test: {
    globals: true,
    dir: here('../../tests/browser/page'),
    include: ['**/*.test.ts'],
    pool: 'forks',
    maxWorkers: 2,
    testTimeout: 300_000,
    hookTimeout: 300_000,
  },
});
