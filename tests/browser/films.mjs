// Key views, playing them, undoing a change for everyone, and pictures as files: from the page.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { cameraRests, connected, openPage, settled, startBrowser, until } from './pages.mjs';
import { startServer } from './server.mjs';

let browser, server;
before(async () => {
  browser = await startBrowser();
  server = await startServer();
});
after(async () => {
  await browser?.close();
  assert.equal(await server?.stop(), 0, 'the server’s exit');
});

const open = async (t, query = '') => {
  const page = await openPage(t, browser, `${server.url}/${query}`, { viewport: { width: 800, height: 600 } });
  await connected(page);
  return page;
};
const cameraOf = (page) => page.evaluate(() => window.brume.camera);
const rows = (page) => page.locator('.key-views li');
const PATH = 'path=0,2,26,0,0,0,0.8,0_10,2,20,0,1,0,0.5,0.4';

test('key views are added, played and linked', async (t) => {
  const page = await open(t, '?position=0,2,26&target=0,0,0');
  await page.locator('#tool-panel').click();
  assert.ok(await page.locator('#tool-play').isHidden(), 'there is nothing to play');
  await page.keyboard.press('k');
  const before = await cameraOf(page);
  await page.keyboard.press('ArrowRight');
  await cameraRests(page, before);
  await page.keyboard.press('k');
  assert.equal(await rows(page).count(), 2);
  await page.getByTitle('Seconds from key view 1 to 2').locator('input').fill('0.3');
  await page.getByTitle('Seconds from key view 1 to 2').locator('input').press('Enter');
  await page.getByRole('button', { name: 'Go to key view 1' }).click();
  const first = await cameraOf(page);
  await page.locator('#tool-play').click();
  await until(page, 'the camera moves', (brume, old) => JSON.stringify(brume.camera) !== old, JSON.stringify(first));
  await page.waitForFunction(() => document.getElementById('tool-play').getAttribute('aria-pressed') === 'false');
  const last = await cameraOf(page);
  assert.ok(Math.abs(last.yaw - first.yaw) > 1e-4, 'it is at the other key view');
  await page.keyboard.press('l');
  assert.match(new URL(page.url()).search, /path=0,2,26,0,0,0,0\.8,0_/);
  await page.getByRole('button', { name: 'Remove key view 2' }).click();
  assert.equal(await rows(page).count(), 1);
  await page.leave();
});

test('a path in the address is played with its lens, and a drag ends it', async (t) => {
  const page = await open(t, `?${PATH}`);
  await page.keyboard.press('v');
  await page.waitForFunction(() => document.getElementById('tool-play').getAttribute('aria-pressed') === 'false');
  await settled(page);
  await until(page, 'the picture has the last lens', (brume) => Math.abs(brume.lastFrame.fovY - 0.5) < 1e-4);
  const { position } = await cameraOf(page);
  assert.ok(Math.hypot(position[0] - 10, position[1] - 2, position[2] - 20) < 1e-6);
  await page.keyboard.press('r');
  await until(page, 'the first lens is back', (brume) => Math.abs(brume.lastFrame.fovY - 0.5) > 1e-2);
  await page.leave();
  const wrong = await open(t, '?path=1,2');
  assert.match(await wrong.locator('#toasts').innerText(), /Key view 1 of path is wrong/);
  await wrong.leave();
});

test('one viewer undoes what another has changed', async (t) => {
  const [a, b] = [await open(t), await open(t)];
  const paused = (brume, wanted) => (brume.scene.settings['simulation.paused'] === 1) === wanted;
  await a.keyboard.press('p');
  await until(b, 'it is paused', paused, true);
  await b.keyboard.press('Control+z');
  await until(a, 'it goes on', paused, false);
  assert.match(await b.locator('#toasts').innerText(), /simulation\.paused back to false/);
  await a.leave();
  await b.leave();
});

test('a picture is saved, also without its sky', async (t) => {
  const page = await open(t, '?box=1');
  await page.locator('#tool-panel').click();
  const saved = async (name) => {
    const [download] = await Promise.all([
      page.waitForEvent('download'),
      page.getByRole('button', { name, exact: true }).click(),
    ]);
    return { name: download.suggestedFilename(), bytes: readFileSync(await download.path()) };
  };
  const plain = await saved('Save picture');
  assert.equal(plain.name, 'cloud.png');
  assert.equal(plain.bytes.toString('latin1', 1, 4), 'PNG');
  const cut = await saved('Without sky');
  assert.equal(cut.name, 'cloud-cut-out.png');
  assert.equal(cut.bytes[25], 6, 'red, green, blue and alpha');
  const exr = await saved('EXR');
  assert.equal(exr.name, 'cloud.exr');
  assert.equal(exr.bytes.readUInt32LE(0), 20000630);
  await page.leave();
});
