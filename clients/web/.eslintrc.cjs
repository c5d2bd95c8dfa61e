// SPDX-License-Identifier: GPL-3.0-or-later
module.exports = {
  root: true,
  parser: '@typescript-eslint/parser',
  parserOptions: { project: './tsconfig.json', tsconfigRootDir: __dirname },
  plugins: ['@typescript-eslint'],
  extends: ['eslint:recommended', 'plugin:@typescript-eslint/strict-type-checked'],
  rules: {
    '@typescript-eslint/restrict-template-expressions': ['error', { allowNumber: true, allowBoolean: true }],
    '@typescript-eslint/no-non-null-assertion': 'off',
    '@typescript-eslint/no-confusing-void-expression': ['error', { ignoreArrowShorthand: true }],
    // arrays are indexed without undefined in their types, so that checks of bounds look unnecessary to it
    '@typescript-eslint/no-unnecessary-condition': 'off',
    'eqeqeq': 'error',
    'no-console': 'error',
    'max-lines': ['error', 320],
  },
  ignorePatterns: ['dist', 'node_modules', '*.cjs', 'messages.gen.ts'],
};
