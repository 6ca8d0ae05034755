// The pictures of README and viewing.md, by the programs: node tests/browser/pictures.mjs [FOLDER, docs/pictures]
import { mkdir, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { connected, openPage, pausedIs, settled, startBrowser, until } from './pages.mjs';
import { startServer } from './server.mjs';

const folder = process.argv[2] ?? 'docs/pictures';
// Nothing is given up, however busy the machine.
const FINE = [
  ...['--set', 'render.shadow_size=256', '--set', 'render.shadow_slices=32'],
  ...['--frame-budget', '10000', '--most-frame-time', '60000'],
];
const PLUME_TICKS = 900; // 15 s: the column has risen

const leave = [];
const never = { after: (end) => leave.push(end) }; // for openPage, which expects a test

async function snapshot(server, name, query) {
  const answer = await fetch(`${server.url}/snapshot.jpg?quality=90&${query}`);
  if (!answer.ok) throw new Error(`${name}: ${answer.status} ${await answer.text()}`);
  await writeFile(join(folder, `${name}.jpg`), Buffer.from(await answer.arrayBuffer()));
}

async function screenshot(page, name, quality = 88) {
  await page.screenshot({ path: join(folder, `${name}.jpg`), type: 'jpeg', quality });
}

await mkdir(folder, { recursive: true });
for (const [scene, query] of [
  ['cumulus', 'w=960&h=540'],
  ['props', 'w=960&h=540'],
]) {
  const server = await startServer('--scene', scene, ...FINE);
  try {
    await snapshot(server, scene, query);
  } finally {
    await server.stop();
  }
}

const browser = await startBrowser();

// Calls `use` with a page of a server whose column has risen.
async function risen(settings, use) {
  const server = await startServer('--scene', 'plume', ...settings);
  try {
    const page = await openPage(never, browser, server.url, { viewport: { width: 1200, height: 675 } });
    await connected(page);
    await until(page, 'the column has risen', (brume, ticks) => brume.lastFrame.tick >= ticks, PLUME_TICKS, 300_000);
    await use(page, server);
    await page.close();
  } finally {
    await server.stop();
  }
}

// A path around a cloud, seen from its second key view, with the list of them.
async function keyViews() {
  const server = await startServer('--scene', 'cumulus', '--paused', ...FINE);
  const path = '0,16,110,0,14,0,0.8,0_70,20,85,12,22,-10,0.8,3_100,30,10,0,16,0,0.8,3_40,24,-40,0,16,0,0.9,4';
  try {
    const viewport = { width: 1000, height: 600 };
    const page = await openPage(never, browser, `${server.url}/?path=${path}`, { viewport });
    await connected(page);
    await page.locator('#tool-panel').click();
    await page.getByRole('button', { name: 'Go to key view 2' }).click();
    await settled(page);
    await screenshot(page, 'key-views', 80);
    await page.close();
  } finally {
    await server.stop();
  }
}

try {
  await risen(FINE, async (page, server) => {
    await page.keyboard.press('p');
    await until(page, 'paused', pausedIs, true);
    await snapshot(server, 'plume', 'w=960&h=540');
  });
  // As people see it: the server's own settings, and the cloud moves.
  await risen([], async (page) => {
    await page.keyboard.press('i');
    await page.waitForTimeout(8000); // rates of the overlay settle
    await screenshot(page, 'page');
  });
  await keyViews();
} finally {
  for (const end of leave) await end();
  await browser.close();
}
