// The README's animated picture: two browsers, and a push in one that moves both.
// node tests/browser/animation.mjs [FILE, docs/pictures/two-viewers.webp]; it needs ffmpeg
import { execFileSync } from 'node:child_process';
import { mkdtemp, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { connected, drag, openPage, settled, startBrowser } from './pages.mjs';
import { startServer } from './server.mjs';

const file = process.argv[2] ?? 'docs/pictures/two-viewers.webp';
const VIEWPORT = { width: 640, height: 360 };
const WIDTH = 400; // pixels of each in the picture
const EVERY_MS = 83;
const LENGTH_MS = 6000;
const PUSHES = [
  { at: 800, from: [0.35, 0.45], to: [0.6, 0.5] },
  { at: 3000, from: [0.62, 0.62], to: [0.45, 0.35] },
];

const leave = [];
const never = { after: (end) => leave.push(end) }; // for openPage, which expects a test
const folder = await mkdtemp(join(tmpdir(), 'brume-animation-'));
const server = await startServer('--scene', 'cloud');
const browser = await startBrowser();
try {
  const pages = [];
  for (const name of ['left', 'right']) {
    const page = await openPage(never, browser, server.url, { viewport: VIEWPORT });
    await connected(page);
    if (name === 'right') await drag(page, [0.8, 0.5], [0.35, 0.42]);
    await settled(page);
    pages.push(page);
  }
  const pushing = (async () => {
    const begin = Date.now();
    for (const push of PUSHES) {
      await new Promise((go) => setTimeout(go, Math.max(begin + push.at - Date.now(), 0)));
      await pages[0].keyboard.down('Control');
      await drag(pages[0], push.from, push.to);
      await pages[0].keyboard.up('Control');
    }
  })();
  const begin = Date.now();
  let count = 0;
  for (; Date.now() - begin < LENGTH_MS; ++count) {
    const number = String(count).padStart(3, '0');
    await Promise.all(pages.map((page, i) => page.screenshot({ path: join(folder, `${i}-${number}.png`) })));
    await new Promise((go) => setTimeout(go, Math.max(begin + (count + 1) * EVERY_MS - Date.now(), 0)));
  }
  await pushing;
  const rate = String((count * 1000) / (Date.now() - begin));
  const sides = [0, 1].flatMap((i) => ['-framerate', rate, '-i', join(folder, `${i}-%03d.png`)]);
  const smaller = `scale=${WIDTH}:-2:flags=area`;
  const together = `[0:v]${smaller},pad=iw+8:ih:0:0:white[a];[1:v]${smaller}[b];[a][b]hstack`;
  const webp = ['-c:v', 'libwebp_anim', '-loop', '0', '-quality', '100', '-compression_level', '6'];
  execFileSync('ffmpeg', ['-y', '-loglevel', 'error', ...sides, '-filter_complex', together, ...webp, file]);
  console.log(`${file}: ${count} frames`);
} finally {
  for (const end of leave) await end();
  await browser.close();
  await server.stop();
  await rm(folder, { recursive: true });
}
