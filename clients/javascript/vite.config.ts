// SPDX-License-Identifier: Apache-2.0
// The package as one module. Its dependency stays outside.
export default {
  build: {
    target: 'es2022',
    minify: false,
    lib: { entry: 'src/index.ts', formats: ['es'], fileName: 'cautery' },
    rollupOptions: { external: /^meshoptimizer/ },
  },
};
