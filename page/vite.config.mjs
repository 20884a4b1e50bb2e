import { readFileSync } from 'node:fs';
import { defineConfig } from 'vite';

// `npm run dev` shows the mock server's stream; the build's folder is given by CMake.
export default defineConfig({
  base: './', // the page may stand behind a proxy, below any path
  server: { proxy: { '/api': 'http://localhost:8099' } },
  build: {
    target: 'es2022',
    assetsInlineLimit: 0, // no data: addresses, which the content security policy would refuse
    modulePreload: false,
    emptyOutDir: true,
  },
  plugins: [{
    name: 'licence', // of what is bundled, to go with it
    generateBundle() {
      this.emitFile({ type: 'asset', fileName: 'uplot-licence.txt', source: readFileSync('node_modules/uplot/LICENSE') });
    },
  }],
});
