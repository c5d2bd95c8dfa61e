// SPDX-License-Identifier: GPL-3.0-or-later
// Run from the source folder, because it looks at tests/browser and tests/paper too (`npm run lint`).
import { fileURLToPath } from 'node:url';
import js from '@eslint/js';
import { defineConfig, globalIgnores } from 'eslint/config';
import { configs } from 'typescript-eslint';

export default defineConfig(
  globalIgnores(['**/dist/', '**/dist-manual*/', '**/node_modules/', '**/*.js', '**/messages.gen.ts']),
  {
    files: ['clients/web/**/*.ts', 'tests/browser/**/*.ts', 'tests/paper/*.ts'],
    extends: [js.configs.recommended, configs.strictTypeChecked],
    languageOptions: {
      parserOptions: { project: './tsconfig.json', tsconfigRootDir: fileURLToPath(new URL('.', import.meta.url)) },
    },
    rules: {
      '@typescript-eslint/restrict-template-expressions': ['error', { allowNumber: true, allowBoolean: true }],
      '@typescript-eslint/no-non-null-assertion': 'off',
      '@typescript-eslint/no-confusing-void-expression': ['error', { ignoreArrowShorthand: true }],
      // arrays are indexed without undefined in their types, so that checks of bounds look unnecessary to it
      '@typescript-eslint/no-unnecessary-condition': 'off',
      // what a caller names saves it a cast
      '@typescript-eslint/no-unnecessary-type-parameters': 'off',
      'eqeqeq': 'error',
      'no-console': 'error',
      'max-lines': ['error', 320],
    },
  },
  { files: ['clients/web/src/text/*.ts'], rules: { 'max-lines': 'off' } }, // a catalogue is read by group
);
