// Two eyes side by side on the page, and pictures that the page redraws: from layers with depth, and after a lost
// graphics context.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';
import { startDelay } from './delay.mjs';
import {
  another,
  cameraRests,
  cameraStill,
  connected,
  deviation,
  difference,
  faded,
  openPage,
  pausedIs,
  rested,
  shown,
  startBrowser,
  until,
} from './pages.mjs';
import { startServer } from './server.mjs';
import { contrast, disparity, halves, takeContext } from './two-eyes.mjs';

// Pauses or resumes the scene that all share.
async function setPaused(page, paused) {
  await page.evaluate(() => document.activeElement?.blur());
  await page.keyboard.press('p');
  await until(page, `the scene ${paused ? 'rests' : 'goes on'}`, pausedIs, paused);
}

describe('two eyes', () => {
  let browser, server;
  before(async () => {
    [browser, server] = await Promise.all([startBrowser(), startServer()]);
  });
  after(async () => {
    await browser?.close();
    assert.equal(await server?.stop(), 0, 'the server’s exit');
  });

  test('side by side, each with its own picture', async (t) => {
    const page = await openPage(t, browser, server.url, {
      viewport: { width: 800, height: 450 },
    });
    await connected(page);
    await page.locator('#tool-panel').click();
    await page.getByRole('combobox', { name: 'Eyes' }).selectOption('side');
    await until(page, 'two pictures come', (brume) => brume.lastFrame.views === 2);
    const { width, height } = await page.evaluate(() => window.brume.lastFrame);
    assert.ok(width < height, `half a window’s shape, not ${width}x${height}`);
    await setPaused(page, true);
    // Nearer, until 64 mm are seen under some pixels.
    const distance = () => page.evaluate(() => window.brume.camera.distance);
    await page.mouse.move(150, 225); // over the picture, where the wheel is the camera's
    for (let i = 0; i < 60 && (await distance()) > 9; ++i) await page.mouse.wheel(0, -120);
    assert.ok((await distance()) <= 9, `the wheel brings the camera no nearer than ${await distance()} m`);
    await cameraStill(page);
    await rested(page);
    const eyes = await halves(page, '#view');
    for (const half of eyes) assert.ok(contrast(half) > 4, `a half is nearly uniform: ${contrast(half)}`);
    const wanted = 0.064 / (await distance()) / ((2 * Math.tan(0.4)) / eyes[0].length); // of what is orbited
    const found = disparity(eyes);
    assert.ok(found >= 0.5 * wanted && found <= 3 * wanted, `${found} pixels of parallax where ${wanted} are due`);
    await setPaused(page, false);
    await page.getByRole('combobox', { name: 'Eyes' }).selectOption('one');
    await until(page, 'one picture comes', (brume) => brume.lastFrame.views === 1);
    await page.leave();
  });

  test('with layers both eyes are drawn from one picture', async (t) => {
    const page = await openPage(t, browser, `${server.url}/?eyes=side&reproject=layers`, {
      viewport: { width: 800, height: 450 },
    });
    await connected(page);
    await until(page, 'layers come', (brume) => brume.lastFrame.layers > 0);
    assert.equal(await page.evaluate(() => window.brume.lastFrame.views), 1);
    await setPaused(page, true);
    const distance = () => page.evaluate(() => window.brume.camera.distance);
    await page.mouse.move(150, 225);
    for (let i = 0; i < 60 && (await distance()) > 9; ++i) await page.mouse.wheel(0, -120);
    await cameraStill(page);
    await rested(page);
    const eyes = await halves(page, '#view');
    for (const half of eyes) assert.ok(contrast(half) > 4, `a half is nearly uniform: ${contrast(half)}`);
    const wanted = 0.064 / (await distance()) / ((2 * Math.tan(0.4)) / eyes[0].length);
    const found = disparity(eyes);
    assert.ok(found >= 0.5 * wanted && found <= 3 * wanted, `${found} pixels of parallax where ${wanted} are due`);
    await setPaused(page, false);
    await page.leave();
  });

  test('with layers a camera that moves sees at once what the server draws later', async (t) => {
    const delay = await startDelay(server.url, 0);
    t.after(() => delay.stop());
    const page = await openPage(t, browser, `${delay.url}/?reproject=layers`);
    await connected(page);
    await until(page, 'layers come', (brume) => brume.lastFrame.layers > 0);
    await setPaused(page, true);
    await rested(page);
    await faded(page);
    const before = await shown(page);
    const { poseSeq } = await page.evaluate(() => window.brume.lastFrame);
    delay.become(5000); // no new picture comes while we look
    const { camera } = await page.evaluate(() => window.brume);
    await page.mouse.move(180, 112);
    await page.mouse.wheel(0, -240); // nearer
    await cameraRests(page, camera);
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    const redrawn = await shown(page);
    assert.equal(
      await page.evaluate(() => window.brume.lastFrame.poseSeq),
      poseSeq,
      'the picture is still the old one',
    );
    delay.become(0);
    await rested(page);
    const later = await shown(page);
    const [moved, off] = [difference(before, later), difference(redrawn, later)];
    assert.ok(moved > 2, `the camera has moved: ${moved}`);
    assert.ok(off < 0.25 * moved, `redrawn it differs by ${off}, as it was by ${moved}`);
    await setPaused(page, false);
    await page.leave();
  });

  for (const query of ['?reproject=plane', '?eyes=side', '?reproject=layers'])
    test(`a lost graphics context: the page with ${query} shows pictures as they are, then as before`, async (t) => {
      const page = await openPage(t, browser, `${server.url}/${query}`);
      await connected(page);
      await setPaused(page, true); // no new picture would hide that the old one is gone
      await rested(page);
      await faded(page);
      const seen = async (what) => {
        await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
        await page.waitForTimeout(300); // the last picture is decoded again
        const spread = deviation(await shown(page));
        assert.ok(spread > 5, `${what} the picture is nearly uniform: ${spread}`);
      };
      const warped = () => page.evaluate(() => !document.getElementById('view').warped.hidden);
      await seen('before,');
      assert.ok(await warped());
      const giveBack = await takeContext(page, () => document.getElementById('view').warped);
      await seen('without the context,');
      assert.ok(!(await warped()));
      await setPaused(page, false);
      await another(page, 3);
      await setPaused(page, true);
      await rested(page);
      await giveBack();
      await seen('with the context again,');
      assert.ok(await warped());
      await setPaused(page, false);
      await another(page, 3);
      await seen('later,');
      await page.leave();
    });

  test('a browser without WebGL 2 says so, and shows pictures as they come', async (t) => {
    const script = `{
      const { getContext } = HTMLCanvasElement.prototype;
      HTMLCanvasElement.prototype.getContext = function (kind, ...wish) {
        return kind === 'webgl2' ? null : getContext.call(this, kind, ...wish);
      };
    }`;
    const page = await openPage(t, browser, `${server.url}/?reproject=layers`, { script });
    await page.getByText('This browser has no WebGL 2, which that needs.').waitFor();
    await connected(page);
    await another(page, 3);
    const { lastFrame, reprojection } = await page.evaluate(() => window.brume);
    assert.deepEqual([reprojection, lastFrame.layers], ['off', undefined]);
    await page.leave();
  });

  test('pictures that come late are redrawn from layers though nobody asked, and a line says so', async (t) => {
    const delay = await startDelay(server.url, 60);
    t.after(() => delay.stop());
    // A browser that draws with hardware, as far as the page can tell: it has a card's name, and its animation frames
    // never tell of more than 20 ms between them, however busy this machine is.
    const script = `{
      const request = window.requestAnimationFrame.bind(window);
      let [real, told] = [0, 0];
      window.requestAnimationFrame = (step) =>
        request((now) => {
          told += Math.min(now - real, 20);
          real = now;
          step(told);
        });
      const { getParameter } = WebGL2RenderingContext.prototype;
      WebGL2RenderingContext.prototype.getParameter = function (name) {
        return name === 0x9246 ? 'a graphics card' : getParameter.call(this, name);
      };
    }`;
    for (const query of ['?draw=server', '?draw=server&eyes=side']) {
      // Small: software draws two eyes at each of the display's pictures.
      const page = await openPage(t, browser, `${delay.url}/${query}`, {
        script,
        viewport: { width: 200, height: 112 },
      });
      await connected(page);
      assert.equal(await page.evaluate(() => window.brume.reprojection), 'off');
      await until(page, 'layers come', (brume) => brume.reprojection === 'layers' && brume.lastFrame.layers > 0);
      await page.locator('#status-text', { hasText: 'Live, redrawn here between pictures' }).waitFor();
      assert.equal(await page.evaluate(() => JSON.parse(localStorage.getItem('brume')).reprojection), 'auto');
      const viewer = await page.evaluate(() => window.brume.viewer);
      await another(page, 10);
      const now = await page.evaluate(() => window.brume);
      assert.deepEqual([now.viewer, now.reprojection, now.lastFrame.views], [viewer, 'layers', 1], 'and they stay');
      await page.leave();
    }
  });
});
