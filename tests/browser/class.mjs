// A class: many pages around one cloud, and one presents: node tests/browser/class.mjs [PAGES] [SECONDS]. Prints a
// table of pictures a second of each page, when all look for themselves and when all follow.
import { connected, openPage, startBrowser, until } from './pages.mjs';
import { startServer } from './server.mjs';

const PAGES = Number(process.argv[2] ?? 20);
const SECONDS = Number(process.argv[3] ?? 20);
const VIEWPORT = { width: 320, height: 180 };
const STEP = 0.02; // rad, that every camera turns by a picture of its browser

// Runs in the page: the camera turns for ever.
const turnFor = (step) => {
  const view = document.getElementById('view');
  const turn = () => {
    const { viewer } = view;
    if (viewer.people.leader === undefined) {
      const { camera } = viewer;
      viewer.camera = { ...camera, yaw: camera.yaw + step };
    }
    requestAnimationFrame(turn);
  };
  requestAnimationFrame(turn);
};

async function metrics(server) {
  const text = await (await fetch(`${server.url}/metrics`)).text();
  const value = (name) => Number(new RegExp(`^${name} (\\S+)$`, 'm').exec(text)?.[1] ?? NaN);
  return {
    pictures: value('brume_pictures_total'),
    sent: value('brume_frames_total{fate="sent"}'.replace(/[{}"]/g, (c) => `\\${c}`)),
    cpu: value('process_cpu_seconds_total'),
  };
}

const quantile = (sorted, part) => sorted[Math.min(sorted.length - 1, Math.floor(part * sorted.length))];

async function measure(server, pages, what) {
  const counts = () => Promise.all(pages.map((page) => page.evaluate(() => window.brume.frames)));
  await new Promise((done) => setTimeout(done, 3000));
  const [before, then, begun] = [await counts(), await metrics(server), performance.now()];
  await new Promise((done) => setTimeout(done, SECONDS * 1000));
  const [now, after, s] = [await counts(), await metrics(server), (performance.now() - begun) / 1000];
  const rates = now.map((count, i) => (count - before[i]) / s).sort((a, b) => a - b);
  const [drawn, sent] = [(after.pictures - then.pictures) / s, (after.sent - then.sent) / s];
  const cells = [what, quantile(rates, 0), quantile(rates, 0.5), rates.at(-1), drawn, sent, (after.cpu - then.cpu) / s];
  console.log(`| ${cells.map((x) => (typeof x === 'number' ? x.toFixed(1) : x)).join(' | ')} |`);
}

const server = await startServer('--max-viewers', String(PAGES + 4));
const browser = await startBrowser();
const leaving = [];
const t = { after: (leave) => leaving.push(leave) };
try {
  const pages = [];
  for (let i = 0; i < PAGES; ++i) {
    const page = await openPage(t, browser, `${server.url}/?size=480x270&reproject=off`, { viewport: VIEWPORT });
    await connected(page);
    await page.evaluate(turnFor, STEP * (1 + i / PAGES));
    pages.push(page);
  }
  console.log(`${PAGES} pages of ${VIEWPORT.width} x ${VIEWPORT.height} for ${SECONDS} s, all in one browser.\n`);
  console.log('| pages | slowest, /s | median, /s | fastest, /s | pictures drawn, /s | frames sent, /s | cores of the server |');
  console.log('|---|---|---|---|---|---|---|');
  await measure(server, pages, 'each for itself');
  await pages[0].evaluate(() => document.getElementById('view').viewer.people.lead(true));
  for (const page of pages.slice(1))
    await until(page, 'it follows', () => document.getElementById('view').viewer.people.leader !== undefined);
  await measure(server, pages, 'one presents');
  await pages[0].evaluate(() => document.getElementById('view').viewer.people.lead(false));
  await measure(server, pages, 'each for itself again');
} finally {
  for (const leave of leaving.reverse()) await leave();
  await browser.close();
  await server.stop();
}
