// Two eyes: side by side on the page, and in a headset, emulated in the page by a script that only the tests put there.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, describe, test } from 'node:test';
import { fileURLToPath } from 'node:url';
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
  screenshotOf,
  shown,
  startBrowser,
  until,
} from './pages.mjs';
import { startServer } from './server.mjs';

const EMULATOR = readFileSync(fileURLToPath(new URL('node_modules/iwer/build/iwer.min.js', import.meta.url)), 'utf8');
// Far apart, so that parallax spans many pixels; the camera of the scene is 26 m from the cloud's middle.
const IPD = 0.9;
const FOV_Y = 0.6;

// A headset whose projections lean outward by `lean`, in parts of half a picture's width.
const headset = (lean = 0) => `${EMULATOR};
{
  const device = new IWER.XRDevice(IWER.metaQuest3, { stereoEnabled: true, ipd: ${IPD}, fovy: ${FOV_Y} });
  device.installRuntime({ forceInstall: true });
  device.position.set(0, 0, 0);
  const { get } = Object.getOwnPropertyDescriptor(XRView.prototype, 'projectionMatrix');
  Object.defineProperty(XRView.prototype, 'projectionMatrix', {
    get() {
      const matrix = Float32Array.from(get.call(this));
      matrix[8] += this.eye === 'left' ? -${lean} : ${lean};
      return matrix;
    },
  });
  window.device = device;
  // A headset that nobody wears has no frames. window.wear(false) takes it off, window.wear(true) puts it on again.
  const { requestAnimationFrame } = XRSession.prototype;
  const held = [];
  XRSession.prototype.requestAnimationFrame = function (step) {
    if (this.visibilityState === 'hidden') return held.push(step);
    return requestAnimationFrame.call(this, step);
  };
  window.wear = (on) => {
    const session = device.activeSession;
    const told = new Promise((done) => session.addEventListener('visibilitychange', done, { once: true }));
    device.updateVisibilityState(on ? 'visible' : 'hidden');
    return told.then(() => on && held.splice(0).forEach((step) => session.requestAnimationFrame(step)));
  };
  // The emulator itself cannot do without what a lost context does not answer.
  const { getParameter } = WebGL2RenderingContext.prototype;
  WebGL2RenderingContext.prototype.getParameter = function (name) {
    return getParameter.call(this, name) ?? (this.isContextLost() ? [0, 0, 0, 0] : null);
  };
}`;

// Grey values of the window's left and right half, in rows.
async function halves(page, from) {
  const png = await screenshotOf(page, from);
  return page.evaluate(async (data) => {
    const picture = await createImageBitmap(new Blob([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))]));
    const copy = new OffscreenCanvas(picture.width, picture.height).getContext('2d');
    copy.drawImage(picture, 0, 0);
    const width = Math.floor(picture.width / 2);
    return [0, width].map((x) => {
      const { data: rgba } = copy.getImageData(x, 0, width, picture.height);
      return Array.from({ length: picture.height }, (_, row) =>
        Array.from({ length: width }, (_, column) => {
          const i = 4 * (row * width + column);
          return rgba[i] + rgba[i + 1] + rgba[i + 2];
        }),
      );
    });
  }, png);
}

// Pixels by which what `left` shows lies further to the right than in `right`, where both agree best.
function disparity([left, right]) {
  const width = left[0].length;
  const lines = left.map((row, i) => [row, right[i]]).filter((_, i) => i % 3 === 0);
  let best = { cost: Infinity, shift: 0 };
  const most = Math.floor(width / 3);
  for (let shift = -most; shift <= most; ++shift) {
    let cost = 0;
    for (const [a, b] of lines) for (let x = most; x < width - most; ++x) cost += Math.abs(a[x] - b[x - shift]);
    if (cost < best.cost) best = { cost, shift };
  }
  return best.shift;
}

const contrast = (half) => {
  const all = half.flat();
  const average = all.reduce((a, b) => a + b, 0) / all.length;
  return Math.sqrt(all.reduce((sum, x) => sum + (x - average) ** 2, 0) / all.length) / 3;
};

// Pauses or resumes the scene that all share.
async function setPaused(page, paused) {
  await page.evaluate(() => document.activeElement?.blur());
  await page.keyboard.press('p');
  await until(page, `the scene ${paused ? 'rests' : 'goes on'}`, pausedIs, paused);
}

// Until frames come for two eyes, and what is drawn is the newest that was asked for.
const bothEyes = (page, more = 5) =>
  page
    .evaluate(() => window.brume.headset?.drawn ?? 0)
    .then((drawn) =>
      until(
        page,
        'both eyes are drawn',
        (b, least) => b.lastFrame.views === 2 && b.headset?.drawn >= least,
        drawn + more,
      ),
    );

// Takes the WebGL context of a canvas away, as a browser does whose GPU process ends, and gives it back.
async function takeContext(page, canvasOf) {
  const canvas = await page.evaluateHandle(canvasOf);
  const hears = (event, act) =>
    page.evaluate(
      async ([canvas, event, act]) => {
        window.context ??= canvas.getContext('webgl2').getExtension('WEBGL_lose_context');
        const heard = new Promise((done) => canvas.addEventListener(event, done, { once: true }));
        window.context[act]();
        await heard;
        await new Promise((done) => setTimeout(done)); // an event's own listeners are not through yet
      },
      [canvas, event, act],
    );
  await hears('webglcontextlost', 'loseContext');
  return () => hears('webglcontextrestored', 'restoreContext');
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

  const enter = async (t, lean, url = server.url) => {
    const page = await openPage(t, browser, url, { script: headset(lean) });
    await connected(page);
    await page.locator('#tool-vr').click();
    await bothEyes(page);
    return page;
  };

  test('without a headset there is no button', async (t) => {
    const page = await openPage(t, browser, server.url);
    await connected(page);
    assert.ok(await page.locator('#tool-vr').isHidden());
    await page.leave();
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

  test('a headset gets both eyes, with the parallax of its distance', async (t) => {
    const page = await enter(t);
    const { camera, headset: seen } = await page.evaluate(() => ({
      camera: window.brume.camera,
      headset: window.brume.headset,
    }));
    assert.ok(Math.abs(seen.asked.eyeSeparation - IPD) < 1e-6);
    assert.equal(seen.asked.frusta.length, 2);
    const eyes = await halves(page, 'div[data-webxr_runtime]');
    for (const half of eyes) assert.ok(contrast(half) > 4, `an eye is nearly black: ${contrast(half)}`);
    // The cloud reaches from its middle some 6 m toward the eyes, and what is near is seen best.
    const pixel = (2 * Math.tan(FOV_Y / 2)) / eyes[0].length;
    const wanted = IPD / camera.distance / pixel;
    const found = disparity(eyes);
    assert.ok(found > 0.8 * wanted && found < 1.6 * wanted, `${found} pixels of parallax where ${wanted} are due`);
    await page.leave();
  });

  test('a headset with layers draws both eyes from one picture, with the parallax of its distance', async (t) => {
    const page = await openPage(t, browser, `${server.url}/?reproject=layers`, { script: headset(0) });
    await connected(page);
    await page.locator('#tool-vr').click();
    await until(page, 'both eyes are drawn', ({ lastFrame, headset: on }) => lastFrame.layers > 0 && on?.drawn >= 5);
    const {
      camera,
      headset: seen,
      lastFrame,
    } = await page.evaluate(() => {
      const { camera, headset, lastFrame } = window.brume;
      return { camera, headset, lastFrame };
    });
    assert.equal(lastFrame.views, 1);
    assert.deepEqual([seen.asked.layers, seen.asked.frusta.length], [4, 1]);
    const { drawn } = seen;
    await until(page, 'newer ones are', (brume, most) => brume.headset.drawn > most + 3, drawn);
    const eyes = await halves(page, 'div[data-webxr_runtime]');
    for (const half of eyes) assert.ok(contrast(half) > 4, `an eye is nearly black: ${contrast(half)}`);
    const pixel = (2 * Math.tan(FOV_Y / 2)) / eyes[0].length;
    const wanted = IPD / camera.distance / pixel;
    const found = disparity(eyes);
    assert.ok(found > 0.8 * wanted && found < 1.6 * wanted, `${found} pixels of parallax where ${wanted} are due`);
    await page.leave();
  });

  test('a leaning projection is asked for and drawn', async (t) => {
    const lean = 0.2;
    const straight = disparity(await halves(await enter(t, 0), 'div[data-webxr_runtime]'));
    const page = await enter(t, lean);
    const { frusta } = await page.evaluate(() => window.brume.lastFrame);
    const offs = frusta.map(({ left, right }) => (right - left) / (right + left));
    // Widened by a tenth about the middle.
    assert.ok(Math.abs(offs[0] + lean / 1.1) < 0.02 && Math.abs(offs[1] - lean / 1.1) < 0.02, `middles at ${offs}`);
    const eyes = await halves(page, 'div[data-webxr_runtime]');
    const found = disparity(eyes) - straight;
    const wanted = lean * eyes[0][0].length; // half a width each way, for two eyes
    assert.ok(Math.abs(found - wanted) <= 3, `leaning shifts by ${found} pixels where ${wanted} are due`);
    await page.leave();
  });

  test('turning the head turns the pictures at once, new ones follow', async (t) => {
    const ANGLE = 0.1;
    const delay = await startDelay(server.url, 0);
    t.after(() => delay.stop());
    const page = await enter(t, 0, delay.url);
    const asked = () => page.evaluate(() => window.brume.headset.asked.orientation);
    const made = () => page.evaluate(() => window.brume.lastFrame.orientation);
    const between = (a, b) => 2 * Math.acos(Math.min(1, Math.abs(a.reduce((sum, x, i) => sum + x * b[i], 0))));
    const frames = await page.evaluate(() => window.brume.headset.drawn);
    await until(page, 'it rests', (brume, drawn) => brume.headset.drawn > drawn + 10, frames);
    const before = await halves(page, 'div[data-webxr_runtime]');
    const old = await asked();
    assert.ok(between(old, await made()) < 1e-3);
    delay.become(1500); // no new picture comes while we look
    // To the left.
    await page.evaluate((angle) => window.device.quaternion.set(0, Math.sin(angle / 2), 0, Math.cos(angle / 2)), ANGLE);
    await bothEyes(page);
    const after = await halves(page, 'div[data-webxr_runtime]');
    assert.ok(between(old, await made()) < 1e-3, 'the picture is still the old one');
    assert.ok(Math.abs(between(old, await asked()) - ANGLE) < 1e-3);
    const pixel = (2 * Math.tan(FOV_Y / 2)) / after[0].length;
    for (const eye of [0, 1]) {
      const moved = disparity([after[eye], before[eye]]);
      const wanted = Math.tan(ANGLE) / pixel;
      assert.ok(Math.abs(moved - wanted) <= 3, `eye ${eye} moved by ${moved} pixels where ${wanted} are due`);
    }
    await until(page, 'a new picture follows', (brume) => Math.abs(brume.lastFrame.orientation[1]) > 0.04);
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

  test('a lost graphics context: a headset waits, and draws both eyes again', async (t) => {
    const page = await enter(t);
    const canvas = () => document.querySelector('div[data-webxr_runtime] canvas');
    const giveBack = await takeContext(page, canvas);
    const { drawn } = await page.evaluate(() => window.brume.headset);
    await another(page, 3);
    assert.equal(await page.evaluate(() => window.brume.headset?.drawn), drawn, 'nothing is drawn meanwhile');
    await giveBack();
    await bothEyes(page);
    for (const half of await halves(page, 'div[data-webxr_runtime]'))
      assert.ok(contrast(half) > 4, `an eye is nearly black: ${contrast(half)}`);
    await page.leave();
  });

  test('leaving ends it: one picture again, and a line that says so', async (t) => {
    const page = await enter(t);
    await page.evaluate(() => window.device.activeSession.end());
    await until(page, 'one picture comes', (brume) => brume.headset === undefined && brume.lastFrame.views === 1);
    assert.match(await page.locator('#toasts').textContent(), /session has ended/);
    await page.locator('#tool-vr').click(); // and again
    await bothEyes(page);
    await page.leave();
  });

  test('a refusal is one line, and the page goes on', async (t) => {
    const refuse = `${headset()};
      navigator.xr.requestSession = () =>
        Promise.reject(new DOMException('The headset is in use.', 'InvalidStateError'));`;
    const page = await openPage(t, browser, server.url, { script: refuse });
    await connected(page);
    await page.locator('#tool-vr').click();
    await page.getByText('The headset did not start: The headset is in use.').waitFor();
    const frames = await page.evaluate(() => window.brume.frames);
    await until(page, 'pictures go on', (brume, old) => brume.frames > old && brume.lastFrame.views === 1, frames);
    await page.leave();
  });
});

// A page with a worn headset, and a server of its own.
async function worn(t) {
  const browser = await startBrowser();
  t.after(() => browser.close());
  const world = { server: await startServer() };
  t.after(() => world.server.stop());
  world.page = await openPage(t, browser, world.server.url, {
    script: headset(),
  });
  await connected(world.page);
  await world.page.locator('#tool-vr').click();
  await bothEyes(world.page);
  return world;
}

test('a lost connection ends the headset’s session', async (t) => {
  const world = await worn(t);
  const { page, server } = world;
  await server.stop();
  await page.getByText('The connection was lost: the headset’s session has ended.').waitFor();
  assert.equal(await page.evaluate(() => window.brume.headset), undefined);
  world.server = await startServer('--port', server.port);
  const frames = await page.evaluate(() => window.brume.frames);
  await until(page, 'pictures come again', (b, old) => b.frames > old && b.lastFrame.views === 1, frames);
  await page.leave();
});

const waits = {
  skip: process.env.BRUME_TESTS !== 'whole' && 'it waits for twenty seconds: BRUME_TESTS=whole',
};
test('a headset that is taken off, and put on after the connection was lost, goes on', waits, async (t) => {
  const world = await worn(t);
  const { page, server } = world;
  const viewers = async () => (await (await fetch(`${server.url}/viewers`)).json()).viewers.length;
  const session = await page.evaluateHandle(() => window.device.activeSession);
  await page.evaluate(() => window.wear(false));
  await server.stop('SIGKILL');
  await until(page, 'it is reconnecting', (brume) => brume.state === 'reconnecting');
  await page.waitForTimeout(12_000); // longer than a worn headset's session lasts
  world.server = await startServer('--port', server.port);
  await until(page, 'it is connected again', (brume) => brume.state === 'connected');
  const viewer = await page.evaluate(() => window.brume.viewer);
  await page.waitForTimeout(7000); // longer than the server waits for a first pose
  assert.equal(await viewers(), 1);
  assert.equal(await page.evaluate(() => window.brume.viewer), viewer, 'it was never disconnected');
  await page.evaluate(() => window.wear(true));
  await bothEyes(page);
  assert.ok(await session.evaluate((old) => window.device.activeSession === old), 'in the same session');
  await page.leave();
});
