// Another scene for everyone, point clouds from a file, what was tuned, and the box: from the page.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { randomBytes } from 'node:crypto';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { nextDownload } from './browsers.mjs';
import { connected, drag, openPage, rested, screenshotOf, settled, startBrowser, until } from './pages.mjs';
import { BINARY, startServer } from './server.mjs';

const ply = (x) => `ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z
property float scale\nproperty float sigma_t\nend_header\n${x} 0 0 4 30\n3 1 0 4 30\n4 0 0 4 30\n`;

let browser, folder;
before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'brume-'));
  browser = await startBrowser();
});
after(async () => {
  await browser?.close();
  if (folder) rmSync(folder, { recursive: true });
});

const start = async (t, ...options) => {
  const server = await startServer('--cloud-dir', mkdtempSync(join(folder, 'clouds-')), ...options);
  t.after(async () => assert.equal(await server.stop(), 0, 'the server’s exit'));
  return server;
};
const openPanel = async (t, server, query = '') => {
  const page = await openPage(t, browser, `${server.url}/${query}`, { viewport: { width: 800, height: 600 } });
  await connected(page);
  await page.locator('#tool-panel').click();
  return page;
};
const sceneOf = (page) => page.locator('#brand-scene');
const cameraOf = (page) => page.evaluate(() => window.brume.camera);

test('an operator switches the scene for all, and every page takes the new camera', async (t) => {
  const server = await start(t);
  const one = await openPanel(t, server);
  const two = await openPage(t, browser, server.url);
  await connected(two);
  await drag(two, [0.5, 0.5], [0.8, 0.6]);
  const before = await cameraOf(two);
  const list = one.getByRole('combobox', { name: 'Scene' });
  const names = await list.locator('option').allTextContents();
  for (const name of ['cloud', 'plume', 'tubes']) assert.ok(names.includes(name), `${name} in ${names}`);
  await list.selectOption('tubes');
  for (const page of [one, two]) {
    await sceneOf(page)
      .filter({ hasText: /^tubes$/ })
      .waitFor();
    await page.getByText('Another scene is shown: tubes.').waitFor();
  }
  const now = await cameraOf(two);
  assert.notDeepEqual(now, before);
  const own = await openPage(t, browser, server.url);
  await connected(own);
  assert.deepEqual(now, await cameraOf(own), 'the scene’s own');
  await settled(two);
  for (const page of [own, two, one]) await page.leave();
});

describe('a PLY file', () => {
  test('that is chosen is shown to everyone, under its name', async (t) => {
    const server = await start(t);
    const page = await openPanel(t, server);
    const chooser = page.waitForEvent('filechooser');
    await page.getByRole('button', { name: 'Open file…' }).click();
    writeFileSync(join(folder, 'my cloud.ply'), ply(2));
    await (await chooser).setFiles(join(folder, 'my cloud.ply'));
    await sceneOf(page)
      .filter({ hasText: /^my-cloud$/ })
      .waitFor();
    await until(page, 'it is counted', (brume) => brume.scene.particles === 3);
    await settled(page);
    assert.equal(await page.getByRole('combobox', { name: 'Scene' }).inputValue(), 'my-cloud');
    await page.leave();
  });

  // A drop as the browser makes it of a file that is held above the page.
  const drop = (page, name, text) =>
    page.evaluate(
      ([file, content]) => {
        const dataTransfer = new DataTransfer();
        dataTransfer.items.add(new File([content], file));
        const event = (kind) => new DragEvent(kind, { dataTransfer, bubbles: true, cancelable: true });
        document.body.dispatchEvent(event('dragover'));
        const held = document.body.classList.contains('dropping');
        const dropped = event('drop');
        document.body.dispatchEvent(dropped);
        return { held, kept: dropped.defaultPrevented };
      },
      [name, text],
    );

  test('that is dropped is shown too; one that is wrong is one line, and the scene stays', async (t) => {
    const server = await start(t);
    const page = await openPanel(t, server);
    assert.deepEqual(await drop(page, 'mine.ply', ply(2)), { held: true, kept: true });
    await sceneOf(page)
      .filter({ hasText: /^mine$/ })
      .waitFor();
    await drop(page, 'other.ply', ply('0,5'));
    await page.getByText(/other\.ply:10: .*decimal point/).waitFor();
    await drop(page, 'plume.ply', ply(2));
    await page.locator('.note.error', { hasText: 'plume' }).waitFor(); // a name of a scene that there is
    assert.equal(await sceneOf(page).textContent(), 'mine');
    await page.leave();
  });

  test('in another unit and with another axis up is told so, and its answer is shown', async (t) => {
    const server = await start(t);
    const page = await openPanel(t, server);
    await page.getByRole('combobox', { name: 'File’s unit' }).selectOption('mm');
    await page.getByRole('combobox', { name: 'File’s up axis' }).selectOption('z');
    const text = ply(0).replace('float scale', 'float other').replace('3 1 0', '3000 1000 7').replaceAll(' 30', ' 1');
    await drop(page, 'mine.ply', text);
    const note = page.locator('.note', { hasText: "scene 'mine' is shown" });
    await note.waitFor();
    assert.match(await note.textContent(), /3 points in \[0, 0, -1\] to \[3, 0\.007, 0\] m/);
    await page.leave();
  });

  test('is not for viewers, who may still save', async (t) => {
    const key = join(folder, 'token.key');
    writeFileSync(key, randomBytes(32), { mode: 0o600 });
    const server = await start(t, '--token-key', key);
    const token = execFileSync(BINARY, ['--token-key', key, '--make-token', 'viewer']).toString().trim();
    const page = await openPanel(t, server, `#token=${token}`);
    assert.ok(await page.getByRole('button', { name: 'Open file…' }).isDisabled());
    assert.ok(await page.getByRole('button', { name: 'Reset all' }).isDisabled());
    assert.deepEqual(await drop(page, 'mine.ply', ply(2)), { held: false, kept: true });
    const download = nextDownload(page);
    await page.getByRole('button', { name: 'Save TOML' }).click();
    assert.equal((await download).suggestedFilename(), 'cloud.toml');
    await page.leave();
  });
});

describe('what was tuned', () => {
  const extinction = 'medium.extinction';
  const valueOf = (page, path) => page.evaluate((name) => window.brume.scene.settings[name], path);
  const tune = async (page, name, path) => {
    const before = await valueOf(page, path);
    await page.getByRole('slider', { name, exact: true }).focus();
    for (let i = 0; i < 5; ++i) await page.keyboard.press('ArrowRight');
    await until(page, `${path} changes`, (brume, [p, old]) => brume.scene.settings[p] > old, [path, before]);
    return before;
  };

  test('is saved as a scene that begins so, with this camera', async (t) => {
    const server = await start(t);
    const page = await openPanel(t, server);
    await tune(page, 'Extinction', extinction);
    await page.keyboard.press('Escape');
    await drag(page, [0.3, 0.5], [0.4, 0.5]);
    await settled(page);
    const [camera, wanted] = [await cameraOf(page), await valueOf(page, extinction)];
    await page.locator('#tool-panel').click();
    const download = nextDownload(page);
    await page.getByRole('button', { name: 'Save TOML' }).click();
    const file = join(folder, 'saved.toml');
    await (await download).saveAs(file);
    assert.match(readFileSync(file, 'utf8'), /\[medium\]/);
    const again = await start(t, '--scene', file);
    const other = await openPage(t, browser, again.url);
    await connected(other);
    assert.ok(Math.abs((await valueOf(other, extinction)) - wanted) < 1e-3 * wanted);
    const now = await cameraOf(other);
    for (const i of [0, 1, 2]) assert.ok(Math.abs(now.position[i] - camera.position[i]) < 1e-2, `${now.position}`);
    await other.leave();
    await page.leave();
  });

  test('goes back, one by one or all at once', async (t) => {
    const server = await start(t);
    const page = await openPanel(t, server);
    const all = page.getByRole('button', { name: 'Reset all' });
    await page.locator('#panel details').first().waitFor();
    assert.ok(await all.isDisabled());
    assert.equal(await page.locator('#panel .reset:visible').count(), 0);
    const exposure = await tune(page, 'Exposure', 'render.exposure');
    const thickness = await tune(page, 'Extinction', extinction);
    const is = (path, value) => until(page, `${path} is back`, (b, [p, v]) => b.scene.settings[p] === v, [path, value]);
    const one = page.getByRole('button', { name: 'exposure: back to the scene’s value' });
    await one.click();
    await is('render.exposure', exposure);
    await one.waitFor({ state: 'hidden' });
    assert.notEqual(await valueOf(page, extinction), thickness);
    await all.click();
    await is(extinction, thickness);
    await page.waitForFunction(() => document.querySelectorAll('#panel .reset:not([hidden])').length === 0, null, {
      polling: 50,
    });
    assert.ok(await all.isDisabled());
    await page.leave();
  });
});

test('B draws the medium’s box and a scale where they belong', async (t) => {
  const server = await start(t);
  const page = await openPage(t, browser, server.url);
  await connected(page);
  await page.keyboard.press('p');
  await rested(page);
  const lines = () =>
    page.evaluate(() => {
      const canvas = document.getElementById('view').shadowRoot.querySelector('.drawing');
      if (canvas.hidden) return undefined;
      const { width, height } = canvas;
      const { data } = canvas.getContext('2d').getImageData(0, 0, width, height);
      let [left, right, count] = [width, 0, 0];
      for (let i = 0; i < width * height; ++i) {
        if (data[4 * i + 3] < 128 || i / width > 0.4 * height) continue; // the scale is below
        if (i % width > width - 92) continue; // the axes are there
        count += 1;
        left = Math.min(left, i % width);
        right = Math.max(right, i % width);
      }
      return { width, left, right, count };
    });
  assert.equal(await lines(), undefined);
  const plain = await screenshotOf(page, '#view');
  await page.keyboard.press('b');
  await page.waitForFunction(() => !document.getElementById('view').shadowRoot.querySelector('.drawing').hidden, null, {
    polling: 50,
  });
  const { box, height, camera, fovY } = await page.evaluate(() => ({
    ...{ box: window.brume.scene.box, height: innerHeight, camera: window.brume.camera },
    fovY: window.brume.lastFrame.fovY,
  }));
  const drawn = await lines();
  assert.ok(drawn.count > 200, `${drawn.count} pixels`);
  // The camera looks along -z: the nearest face is the widest.
  const half = ((box.hi[0] - box.lo[0]) / 2 / (camera.position[2] - box.hi[2]) / Math.tan(fovY / 2)) * (height / 2);
  const off = Math.abs(drawn.right - drawn.left - 2 * half) / (2 * half);
  assert.ok(off < 0.05, `${drawn.left} to ${drawn.right} where ${2 * half} pixels are due`);
  assert.notEqual(await screenshotOf(page, '#view'), plain);
  await page.reload(); // it is the viewer's own, and stays
  await connected(page);
  await page.waitForFunction(() => !document.getElementById('view').shadowRoot.querySelector('.drawing').hidden, null, {
    polling: 50,
  });
  await page.leave();
});
