// The page draws the medium by itself, from the server's lit particles: what it shows, and when it does.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';
import { startDelay } from './delay.mjs';
import {
  VIEWPORT,
  cameraRests,
  difference,
  faded,
  openPage,
  screenshotOf,
  shown,
  startBrowser,
  until,
} from './pages.mjs';
import { startServer } from './server.mjs';
import { contrast, disparity, halves, headset, takeContext } from './two-eyes.mjs';

const HOPELESS_MS = 60_000;
const WHOLE = process.env.BRUME_TESTS === 'whole';
// Scenes, the relative RMSE that each may have, and a camera where it is not the scene's. Where shadows of objects are
// smoothed, and in dense clouds, more is allowed.
const SHOWN = [
  ['cloud', 0.03],
  ['plume', 0.03],
  ...(WHOLE
    ? [
        ['cloud', 0.03, 'position=0,0,2&target=0,0,-10'],
        ['cloud-5000', 0.03],
        ['cloud-5000', 0.03, 'position=0,0,2&target=0,0,-10'],
        ['tubes', 0.03],
        ['cumulus', 0.04],
        ['props', 0.04],
      ]
    : []),
];

// Until what came is on the screen.
async function drawn(page) {
  await until(page, 'the page draws', ({ drawing, drawn, scene }) => drawing === 'client' && drawn?.rays > 0 && scene);
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
}

// The server's picture of the page's camera: its PNG in base64, and the hash of its state.
async function snapshot(page, url, { width, height }) {
  const { position, target, fov } = await page.evaluate(() => {
    const { camera, fovY } = document.getElementById('view').viewer;
    const flat = Math.cos(camera.pitch) * camera.distance;
    const to = [-Math.sin(camera.yaw) * flat, Math.sin(camera.pitch) * camera.distance, -Math.cos(camera.yaw) * flat];
    return { position: camera.position, target: camera.position.map((x, i) => x + to[i]), fov: fovY };
  });
  const query = new URLSearchParams({ position, target, fov, w: width, h: height });
  for (const end = Date.now() + HOPELESS_MS; ; await page.waitForTimeout(500)) {
    const answer = await fetch(`${url}/snapshot.png?${query}`);
    assert.ok(answer.ok || Date.now() < end, `no snapshot: ${answer.status}`);
    if (answer.ok)
      return {
        png: Buffer.from(await answer.arrayBuffer()).toString('base64'),
        state: answer.headers.get('Brume-State'),
      };
  }
}

// Relative RMSE of the picture `own` against `server`, in linear light, where it differs from `bare`: the same without
// the medium.
const errorOf = (page, own, server, bare) =>
  page.evaluate(
    async (pictures) => {
      const { filmic } = document.getElementById('view').viewer.drawing.newest;
      const [a, b, c] = await Promise.all(
        pictures.map(async (png) => {
          const picture = await createImageBitmap(new Blob([Uint8Array.from(atob(png), (x) => x.charCodeAt(0))]));
          const copy = new OffscreenCanvas(picture.width, picture.height).getContext('2d');
          copy.drawImage(picture, 0, 0);
          return copy.getImageData(0, 0, picture.width, picture.height).data;
        }),
      );
      const linear = (byte) => {
        const y = byte > 10 ? ((byte / 255 + 0.055) / 1.055) ** 2.4 : byte / 255 / 12.92;
        if (!filmic) return y;
        const z = Math.min(y, 0.999); // the inverse of Narkowicz's curve
        const [p, q, r] = [2.51 - 2.43 * z, 0.03 - 0.59 * z, -0.14 * z];
        return (Math.sqrt(q * q - 4 * p * r) - q) / (2 * p);
      };
      let [off, sum, count] = [0, 0, 0];
      for (let i = 0; i < a.length; i += 4) {
        if ([0, 1, 2].every((k) => Math.abs(b[i + k] - c[i + k]) < 2)) continue;
        count += 1;
        for (let k = 0; k < 3; ++k) {
          off += (linear(a[i + k]) - linear(b[i + k])) ** 2;
          sum += linear(b[i + k]) ** 2;
        }
      }
      return { error: Math.sqrt(off / sum), part: (4 * count) / a.length };
    },
    [own, server.png, bare.png],
  );

const set = (page, path, value) =>
  page.evaluate((change) => document.getElementById('view').viewer.command({ kind: 'set', changes: [change] }), {
    path,
    value,
  });

describe('a page that draws', () => {
  let browser, server;
  before(async () => {
    [browser, server] = await Promise.all([startBrowser(), startServer('--paused')]);
  });
  after(async () => {
    await browser?.close();
    assert.equal(await server?.stop(), 0, 'the server’s exit');
  });
  const open = (t, query = '?draw=client', options = {}, { url } = server) =>
    openPage(t, browser, `${url}/${query}`, options);

  for (const [scene, most, camera = ''] of SHOWN)
    test(`shows ${scene} as the server does${camera && ` from ${camera}`}`, async (t) => {
      const own = scene === 'cloud' ? server : await startServer('--scene', scene, '--paused');
      if (own !== server) t.after(() => own.stop());
      const page = await open(t, `?draw=client&${camera}`, {}, own);
      await drawn(page);
      await faded(page);
      const picture = await screenshotOf(page, '#view');
      const theirs = await snapshot(page, own.url, VIEWPORT);
      assert.equal(await page.evaluate(() => window.brume.stateHash), theirs.state, 'both show the same state');
      const { 'medium.extinction': extinction } = await page.evaluate(() => window.brume.scene.settings);
      await set(page, 'medium.extinction', 0);
      await until(page, 'the medium is gone', (brume) => brume.scene.settings['medium.extinction'] === 0);
      const bare = await snapshot(page, own.url, VIEWPORT);
      const { error, part } = await errorOf(page, picture, theirs, bare);
      assert.ok(part > 0.1, `the medium is in ${part} of the pixels`);
      await set(page, 'medium.extinction', extinction);
      await until(
        page,
        'the medium is back',
        (brume, old) => brume.scene.settings['medium.extinction'] === old,
        extinction,
      );
      const { frames, lastFrame, drawn: told } = await page.evaluate(() => window.brume);
      assert.ok(frames > 0 && lastFrame === undefined, 'no picture of the server came');
      t.diagnostic(`relative RMSE ${error} of ${part} of the pixels; ${told.proxies} quads, ${told.rays} rays`);
      assert.ok(error < most, `relative RMSE ${error}`);
      assert.ok(told.proxies > 0 && told.pixels === VIEWPORT.width * VIEWPORT.height);
      await page.getByText('Paused').first().waitFor();
      await page.leave();
    });

  test('sees at once what a moved camera sees, without the server', async (t) => {
    const delay = await startDelay(server.url, 0);
    t.after(() => delay.stop());
    const page = await open(t, '?draw=client', {}, delay);
    await drawn(page);
    await faded(page);
    const before = await shown(page);
    delay.become(20_000);
    const { camera } = await page.evaluate(() => window.brume);
    await page.mouse.move(180, 112);
    await page.mouse.wheel(0, -240); // nearer
    await cameraRests(page, camera);
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    const moved = difference(before, await shown(page));
    assert.ok(moved > 2, `the picture changes by ${moved}`);
    delay.become(0);
    await page.leave();
  });

  test('goes on while the scene does, and asks the server for other views', async (t) => {
    const page = await open(t);
    await drawn(page);
    await page.locator('#tool-pause').click();
    const { frames } = await page.evaluate(() => window.brume);
    await until(page, 'particles come', (brume, most) => brume.frames > most + 5, frames);
    await page.locator('#tool-pause').click();
    await page.locator('#tool-panel').click();
    await page.getByRole('combobox', { name: 'View' }).selectOption('depth');
    await until(page, 'the server draws', (brume) => brume.drawing === 'server' && brume.lastFrame !== undefined);
    await page.getByRole('combobox', { name: 'View' }).selectOption('picture');
    await drawn(page);
    await page.getByRole('combobox', { name: 'Drawing' }).selectOption('server');
    await until(page, 'the server draws', (brume) => brume.drawing === 'server');
    await page.leave();
  });

  test('compares its picture with the server’s', async (t) => {
    const page = await open(t, '?draw=client', { viewport: { width: 800, height: 450 } });
    await drawn(page);
    await page.locator('#tool-panel').click();
    await page.getByRole('button', { name: 'Compare' }).click();
    await page.getByText('Both show the same state.').waitFor();
    assert.equal(await page.locator('dialog.compare canvas').count(), 3);
    await page.getByRole('button', { name: 'Close', exact: true }).click();
    await page.leave();
  });

  test('draws two eyes side by side, and both of a headset', async (t) => {
    const page = await open(t, '?draw=client&eyes=side', { script: headset(), viewport: { width: 400, height: 225 } });
    await drawn(page);
    for (const half of await halves(page, '#view')) assert.ok(contrast(half) > 4, 'an eye is nearly uniform');
    await page.locator('#tool-vr').click();
    await until(page, 'both eyes are drawn', (brume) => brume.headset?.drawn > 7 && brume.drawing === 'client');
    const eyes = await halves(page, 'div[data-webxr_runtime]');
    for (const half of eyes) assert.ok(contrast(half) > 4, `an eye is nearly black: ${contrast(half)}`);
    assert.ok(disparity(eyes) > 0, 'without parallax');
    await page.leave();
  });

  test('draws again after its graphics context was lost', async (t) => {
    const page = await open(t);
    await drawn(page);
    await faded(page);
    const before = await shown(page);
    const giveBack = await takeContext(page, () => document.getElementById('view').warped);
    await giveBack();
    await page.waitForTimeout(300);
    await drawn(page);
    const changed = difference(before, await shown(page));
    assert.ok(changed < 2, `it differs by ${changed}`);
    await page.leave();
  });

  // A browser that draws with hardware, as far as the page can tell.
  const card = `{
    const { getParameter } = WebGL2RenderingContext.prototype;
    WebGL2RenderingContext.prototype.getParameter = function (name) {
      return name === 0x9246 ? 'a graphics card' : getParameter.call(this, name);
    };
  }`;

  test('of itself where a graphics card draws, until that takes too long', async (t) => {
    const page = await open(t, '', { script: card, viewport: { width: 900, height: 500 } });
    await drawn(page);
    await set(page, 'simulation.paused', 0); // nothing is drawn anew while nothing moves
    await page.getByText(/^Drawing here took \d+ ms a picture/).waitFor();
    await until(page, 'the server draws', (brume) => brume.drawing === 'server' && brume.lastFrame !== undefined);
    await set(page, 'simulation.paused', 1);
    await until(page, 'the scene rests', (brume) => brume.scene.settings['simulation.paused'] === 1);
    await page.leave();
  });

  test('not with software, nor where the browser cannot, which a line says', async (t) => {
    const plain = await open(t, '');
    await until(plain, 'pictures come', (brume) => brume.drawing === 'server' && brume.frames > 0);
    await plain.leave();
    const script = `{
      const { getExtension } = WebGL2RenderingContext.prototype;
      WebGL2RenderingContext.prototype.getExtension = function (name) {
        return name.startsWith('EXT_color_buffer') ? null : getExtension.call(this, name);
      };
    }`;
    const page = await open(t, '?draw=client', { script });
    await page.getByText('Not drawn here: this browser’s WebGL 2 draws no numbers with fractions.').waitFor();
    await until(page, 'pictures come', (brume) => brume.drawing === 'server' && brume.frames > 0);
    await page.leave();
  });
});
