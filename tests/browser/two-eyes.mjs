// A headset that is emulated in the page, by a script that only the tests put there, and what two eyes see.
import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { screenshotOf, until } from './pages.mjs';

const EMULATOR = readFileSync(fileURLToPath(new URL('node_modules/iwer/build/iwer.min.js', import.meta.url)), 'utf8');
// Far apart, so that parallax spans many pixels; the camera of the scene is 26 m from the cloud's middle.
export const IPD = 0.9;
export const FOV_Y = 0.6;

// A headset whose projections lean outward by `lean`, in parts of half a picture's width.
export const headset = (lean = 0) => `${EMULATOR};
{
  const device = new IWER.XRDevice(IWER.metaQuest3, { stereoEnabled: true, ipd: ${IPD}, fovy: ${FOV_Y} });
  device.installRuntime({ forceInstall: true });
  device.position.set(0, 1.6, 0);
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
export async function halves(page, from) {
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
export function disparity([left, right]) {
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

export const contrast = (half) => {
  const all = half.flat();
  const average = all.reduce((a, b) => a + b, 0) / all.length;
  return Math.sqrt(all.reduce((sum, x) => sum + (x - average) ** 2, 0) / all.length) / 3;
};

// Until frames come for two eyes, and what is drawn is the newest that was asked for.
export const bothEyes = (page, more = 5) =>
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
export async function takeContext(page, canvasOf) {
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
