// SPDX-License-Identifier: GPL-3.0-or-later
import { readFileSync } from 'node:fs';
import { defineConfig } from 'vite';

const { version } = JSON.parse(readFileSync(new URL('package.json', import.meta.url), 'utf8')) as { version: string };

// No inlined assets and no module-preload helper: the page must pass `default-src 'none'` headers
// without inline scripts, styles or blob workers. The daemon compresses the files when it loads them.
export default defineConfig({
  base: './',
  define: { __VIEWER_VERSION__: JSON.stringify(version) },
  build: {
    target: 'es2022',
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 900,
  },
  worker: { format: 'es' },
});
