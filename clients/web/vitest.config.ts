// SPDX-License-Identifier: GPL-3.0-or-later
import { fileURLToPath } from 'node:url';
import { defineConfig } from 'vitest/config';

export default defineConfig({
  test: {
    globals: true,
    dir: fileURLToPath(new URL('../../tests/browser/unit', import.meta.url)),
    include: ['**/*.test.ts'],
    pool: 'forks',
    poolOptions: { forks: { maxForks: 1 } },
  },
});
