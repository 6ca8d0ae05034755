import { defineConfig } from 'vitest/config';
import { glsl } from './glsl';

// `npm run dev` serves the page with live reload and passes the rest on to a running server.
const server = process.env['BRUME_URL'] ?? 'http://127.0.0.1:8080';

// `vite build` makes the page, the view alone (dist/embed.html) and an example with Three.js (dist/three.html);
// `vite build --mode library` adds the element as one file that other pages import, dist/brume-view.js.
export default defineConfig(({ mode }) => ({
  base: './',
  plugins: [glsl()],
  build: {
    target: 'es2022',
    modulePreload: { polyfill: false },
    reportCompressedSize: false,
    ...(mode === 'library'
      ? {
          copyPublicDir: false,
          emptyOutDir: false,
          lib: { entry: 'src/element.ts', formats: ['es'] as const, fileName: () => 'brume-view.js' },
        }
      : { rollupOptions: { input: ['index.html', 'embed.html', 'three.html'] } }),
  },
  server: {
    proxy: {
      '/ws': { target: server, ws: true },
      '/healthz': server,
      '/scene': server, // and /scene.toml
      '/cloud': server,
    },
  },
  test: { include: ['test/*.test.ts'] },
}));
