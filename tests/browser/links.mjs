// Where the page looks from: reloads, links, and what the status line says of the pictures.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';
import { startDelay } from './delay.mjs';
import {
  connected,
  difference,
  drag,
  openPage,
  pausedIs,
  pixels,
  rested,
  settled,
  startBrowser,
  until,
} from './pages.mjs';
import { startServer } from './server.mjs';

let browser;
before(async () => {
  browser = await startBrowser();
});
after(async () => {
  await browser?.close();
});

const cameraOf = (page) => page.evaluate(() => window.brume.camera);
const status = (page) => page.locator('#status-text');

describe('one server', () => {
  let server;
  before(async () => {
    server = await startServer();
  });
  after(async () => {
    assert.equal(await server?.stop(), 0, 'the server’s exit');
  });

  test('the camera survives a reload, and a page opened anew starts at the scene’s own', async (t) => {
    const page = await openPage(t, browser, server.url);
    await connected(page);
    const home = await cameraOf(page);
    await drag(page, [0.5, 0.5], [0.8, 0.6]);
    await page.mouse.wheel(0, -300);
    await settled(page);
    const camera = await cameraOf(page);
    assert.notDeepEqual(camera, home);
    await page.reload();
    await connected(page);
    assert.deepEqual(await cameraOf(page), camera);
    await page.keyboard.press('r');
    assert.deepEqual(await cameraOf(page), home, 'the first camera is still the scene’s');
    await page.goto(`${server.url}/?eyes=one`);
    await connected(page);
    assert.deepEqual(await cameraOf(page), home);
    await page.leave();
  });

  test('a link opens with the same camera, and with the viewer’s own settings', async (t) => {
    const page = await openPage(t, browser, server.url, { permissions: ['clipboard-read', 'clipboard-write'] });
    await connected(page);
    await page.keyboard.press('p');
    await until(page, 'it is paused', pausedIs, true);
    await drag(page, [0.5, 0.5], [0.75, 0.35]);
    await page.locator('#tool-panel').click();
    await page.getByRole('combobox', { name: 'Quality' }).selectOption('90');
    await page.locator('#tool-panel').click();
    await connected(page);
    await rested(page);
    await page.locator('#tool-link').click();
    await page.getByText('A link with this camera was copied.').waitFor();
    const link = await page.evaluate(() => navigator.clipboard.readText());
    assert.equal(page.url(), link);
    assert.match(link, /\?position=[-\d.,]+&target=[-\d.,]+&fov=0\.8&quality=90$/);
    const other = await openPage(t, browser, link);
    await connected(other);
    await rested(other);
    const [one, two] = [await cameraOf(page), await cameraOf(other)];
    for (const key of ['yaw', 'pitch', 'distance']) assert.ok(Math.abs(one[key] - two[key]) < 1e-3, key);
    const off = difference(await pixels(page), await pixels(other));
    assert.ok(off < 0.5, `the pictures differ by ${off}`);
    // Its first camera is the link's.
    await drag(other, [0.5, 0.5], [0.3, 0.5]);
    await other.keyboard.press('r');
    assert.deepEqual(await cameraOf(other), two);
    await other.keyboard.press('p');
    await until(other, 'it goes on', pausedIs, false);
    await other.leave();
    await page.leave();
  });

  test('fov is the picture’s', async (t) => {
    const page = await openPage(t, browser, `${server.url}/?fov=0.3`);
    await connected(page);
    await settled(page);
    assert.ok(Math.abs((await page.evaluate(() => window.brume.lastFrame.fovY)) - 0.3) < 1e-6);
    await page.leave();
  });

  test('an address that cannot be used is one notice, and the scene’s own camera', async (t) => {
    const page = await openPage(t, browser, server.url);
    await connected(page);
    const home = await cameraOf(page);
    await page.leave();
    for (const [query, line] of [
      ['position=1,2&eyes=side', 'position takes three numbers from −50,000 to 50,000, in metres: position=0,6,26.'],
      ['fov=9', 'fov takes an angle from 0.05 to 3, in radians: fov=0.8.'],
      ['position=1,2,3&target=1,2,3', 'position and target are the same place: they must differ by a millimetre.'],
      ['reproject=up', 'reproject in the address is one of auto, off, rotation, plane, layers.'],
    ]) {
      const bad = await openPage(t, browser, `${server.url}/?${query}`);
      assert.deepEqual(await bad.locator('#toasts .note').allTextContents(), [line], query);
      await connected(bad);
      const camera = await cameraOf(bad);
      assert.deepEqual(camera.position, home.position, query);
      await bad.leave();
    }
  });

  test('“Live” says when the cloud is paused, and who can resume', async (t) => {
    const page = await openPage(t, browser, server.url);
    await connected(page);
    await page.keyboard.press('p');
    await status(page).filter({ hasText: 'Paused: resume with P' }).waitFor();
    await page.keyboard.press('p');
    await until(page, 'it goes on', pausedIs, false);
    await status(page).filter({ hasNotText: 'Paused' }).waitFor();
    await page.leave();
  });
});

test('“Live” says when the server draws smaller pictures than the window wants', async (t) => {
  const server = await startServer('--max-pixels', '14400');
  t.after(() => server.stop());
  const page = await openPage(t, browser, server.url);
  await connected(page);
  await status(page)
    .filter({ hasText: /^159×90: the server’s limit$/ })
    .waitFor();
  await page.leave();
  assert.equal(await server.stop(), 0, 'the server’s exit');
});

test('“Live” says when the link is slow', async (t) => {
  const server = await startServer();
  t.after(() => server.stop());
  const narrow = await startDelay(server.url, 5, 25_000);
  t.after(() => narrow.stop());
  const page = await openPage(t, browser, narrow.url, { viewport: { width: 640, height: 360 } });
  await connected(page);
  await status(page)
    .filter({ hasText: /^(\d+×\d+|[\d.]+ pictures\/s): the link is slow$/ })
    .waitFor();
  await page.leave();
});
