import { defineConfig } from 'vitest/config';

// `npm run dev` serves the page with live reload and passes the rest on to a running server.
const server = process.env['BRUME_URL'] ?? 'http://127.0.0.1:8080';

export default defineConfig({
  base: './',
  build: {
    target: 'es2022',
    modulePreload: { polyfill: false },
    reportCompressedSize: false,
  },
  server: {
    proxy: {
      '/ws': { target: server, ws: true },
      '/healthz': server,
    },
  },
  test: { include: ['test/*.test.ts'] },
});
