// Pages of a real browser, and what can be seen on their canvas.
import assert from 'node:assert/strict';
import { IS_FIREFOX } from './browsers.mjs';

const WAIT_MS = 120_000; // nothing should take this long; a driver that compiles shaders beside other work may
// Small: on a machine without a GPU the pictures are what the tests wait for.
export const VIEWPORT = { width: 400, height: 225 };
// Errors in Firefox's words that are none of the page's: a server that is away, and the style element that Playwright
// puts into a page for a screenshot.
const NOT_ITS_OWN = new RegExp(
  [
    '^Firefox can’t establish a connection',
    '^The connection to wss?:',
    'CORS request did not succeed',
    'sha256-YjaKGiklmzC6wjXA513HAMmzus8VE61XCOT\\+SmwNZWA=',
  ].join('|'),
);
const SAMPLES = { width: 64, height: 36 };

export { startBrowser } from './browsers.mjs';

// A page of its own context, as another person would have, closed with the test `t`. Errors in it and requests to
// elsewhere fail the test when it leaves; `sentTo` is the one other server that it may know. `script` runs in the
// page before its own.
export async function openPage(t, browser, url, { script, sentTo, ...options } = {}) {
  if (IS_FIREFOX) delete options.isMobile; // it has no such mode
  const context = await browser.newContext({ viewport: VIEWPORT, ...options });
  t.after(() => context.close());
  const page = await context.newPage();
  if (script) await page.addInitScript(script);
  const errors = [];
  const elsewhere = [];
  page.on('pageerror', ({ message }) => !NOT_ITS_OWN.test(message) && errors.push(message));
  page.on('console', (message) => {
    if (message.text().includes('Content Security Policy')) errors.push(message.text());
  });
  page.on('request', (request) => {
    const { origin, protocol } = new URL(request.url());
    if (![url, sentTo].some((known) => known && new URL(known).origin === origin) && !/^(data|blob):/.test(protocol))
      elsewhere.push(request.url());
  });
  await page.goto(url);
  const started = page.waitForFunction(() => window.brume !== undefined, null, { timeout: 10_000, polling: 50 });
  await started.catch(() => assert.fail(`the page does not start: ${errors.join('; ')}`));
  return Object.assign(page, {
    async leave() {
      await context.close();
      assert.deepEqual(errors, [], 'errors in the page');
      assert.deepEqual(elsewhere, [], 'requests to other servers');
    },
  });
}

// Waits until `condition`, a function of the page's read-only state and `argument`, holds.
export async function until(page, what, condition, argument, timeout = WAIT_MS) {
  try {
    // Polling by timer: animation frames are what some of the tests hold back.
    // A function, since the page's policy forbids it to evaluate text.
    const test = new Function('argument', `return window.brume && (${condition})(window.brume, argument)`);
    return await page.waitForFunction(test, argument ?? null, { timeout, polling: 50 });
  } catch (error) {
    const state = await page
      .evaluate(() => JSON.stringify({ ...window.brume, recent: undefined, text: document.body.innerText }))
      .catch(() => 'gone');
    throw new Error(`waited in vain until ${what}: ${error.message.split('\n')[0]}\nthe page: ${state}`);
  }
}

export const connected = (page) =>
  until(page, 'pictures come', (brume) => brume.state === 'connected' && brume.frames >= 1);

// Until the picture shows the camera as it is now.
export async function settled(page) {
  await until(page, 'the camera is sent', (brume) => brume.sentPose !== undefined);
  const pose = await page.evaluate(() => window.brume.sentPose);
  await until(page, 'the picture shows the camera', (brume, sent) => brume.lastFrame.poseSeq >= sent, pose);
}

// For until(): true if the scene is paused, or not, as wanted.
export const pausedIs = (brume, wanted) => (brume.scene.settings['simulation.paused'] === 1) === wanted;
export const isPaused = (page) => page.evaluate(() => window.brume.scene.settings['simulation.paused'] === 1);

// Until it is the finer one that follows when neither the camera nor a paused medium moves. It shows the
// state of the scene: a server that compiles may have made a fine one before the pause.
export async function rested(page) {
  await settled(page);
  await until(
    page,
    'the picture rests',
    ({ lastFrame, scene, sentPose }) =>
      lastFrame.quality >= 90 && lastFrame.poseSeq >= sentPose && lastFrame.stateHash === scene.stateHash,
  );
  // Until it is drawn, too, and covers the one before.
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  await until(page, 'it is all there', ({ shown }) => shown?.part === 1);
}

// Until so many more pictures are shown.
export async function another(page, count = 1) {
  const { frames } = await page.evaluate(() => window.brume);
  await until(page, 'pictures come', (brume, most) => brume.frames >= most, frames + count);
}

// Until the camera, which was at `before`, has moved and come to rest.
export async function cameraRests(page, before) {
  await until(page, 'the camera moves', (brume, old) => JSON.stringify(brume.camera) !== old, JSON.stringify(before));
  await cameraStill(page);
}

// Until the camera is the same in two animation frames.
export const cameraStill = (page) =>
  page.evaluate(
    () =>
      new Promise((done) => {
        let last = '';
        const look = () => {
          const now = JSON.stringify(window.brume.camera);
          if (now === last) return done();
          last = now;
          requestAnimationFrame(look);
        };
        look();
      }),
  );

// Until nothing on the page fades or slides any more.
export const faded = (page) =>
  page.evaluate(() => {
    const transitions = document.getAnimations().filter((one) => one instanceof CSSTransition);
    return Promise.allSettled(transitions.map((one) => one.finished));
  });

// What the canvas shows, or a PNG in base64, small: [r, g, b] in rows from the top, 0 ... 255, each the mean of its
// pixels. Browsers shrink pictures each in their own way.
export const pixels = (page, png) =>
  page.evaluate(
    async ({ png, width, height }) => {
      const source = png
        ? await createImageBitmap(new Blob([Uint8Array.from(atob(png), (c) => c.charCodeAt(0))]))
        : document.getElementById('view').canvas;
      const copy = new OffscreenCanvas(source.width, source.height).getContext('2d');
      copy.drawImage(source, 0, 0);
      const { data } = copy.getImageData(0, 0, source.width, source.height);
      const edges = (parts, all) => Array.from({ length: parts + 1 }, (_, i) => Math.floor((i * all) / parts));
      const [columns, rows] = [edges(width, source.width), edges(height, source.height)];
      return Array.from({ length: width * height }, (_, i) => {
        const [left, right] = columns.slice(i % width);
        const [top, bottom] = rows.slice(Math.floor(i / width));
        const sum = [0, 0, 0];
        let count = 0;
        for (let y = top; y < Math.max(bottom, top + 1); ++y)
          for (let x = left; x < Math.max(right, left + 1); ++x, ++count)
            for (const k of [0, 1, 2]) sum[k] += data[4 * (y * source.width + x) + k];
        return sum.map((value) => value / count);
      });
    },
    { png, ...SAMPLES },
  );

// The window with everything hidden but that element, as PNG in base64. The page's policy forbids style
// elements, so the style is set by script.
export async function screenshotOf(page, selector) {
  const style = (text) =>
    page.evaluate((rules) => {
      const sheet = new CSSStyleSheet();
      sheet.replaceSync(rules);
      document.adoptedStyleSheets = [sheet];
    }, text);
  await style(`body :not(${selector}, ${selector} *, :has(${selector})) { visibility: hidden !important; }`);
  const png = (await page.screenshot({ caret: 'initial' })).toString('base64');
  await style('');
  return png;
}

// What a person sees in the window where the page's own furniture is put away, like pixels().
export const shown = async (page) => pixels(page, await screenshotOf(page, '#view'));

// Mean absolute difference of two pictures, 0 ... 255.
export function difference(a, b) {
  let sum = 0;
  for (let i = 0; i < a.length; ++i) for (const k of [0, 1, 2]) sum += Math.abs(a[i][k] - b[i][k]);
  return sum / (3 * a.length);
}

// The difference that a hundredth of the picture exceeds: a change in one place counts, a single wild pixel does not.
export function strongest(a, b) {
  const changes = a.map((colour, i) => Math.max(...colour.map((x, k) => Math.abs(x - b[i][k]))));
  return changes.sort((x, y) => x - y)[Math.floor(changes.length * 0.99)];
}

// Mean colour of a part of the picture; edges are fractions of its size.
export function mean(picture, left, top, right, bottom) {
  const sum = [0, 0, 0];
  let count = 0;
  for (let y = Math.floor(top * SAMPLES.height); y < bottom * SAMPLES.height; ++y) {
    for (let x = Math.floor(left * SAMPLES.width); x < right * SAMPLES.width; ++x) {
      for (const k of [0, 1, 2]) sum[k] += picture[y * SAMPLES.width + x][k];
      count += 1;
    }
  }
  return sum.map((x) => x / count);
}

export function deviation(picture) {
  const grey = picture.map(([r, g, b]) => (r + g + b) / 3);
  const average = grey.reduce((a, b) => a + b, 0) / grey.length;
  return Math.sqrt(grey.reduce((sum, x) => sum + (x - average) ** 2, 0) / grey.length);
}

// Draws a line with the mouse's left button, in fractions of the window, over about `steps` animation frames.
export async function drag(page, [fromX, fromY], [toX, toY], steps = 12) {
  const { width, height } = page.viewportSize();
  await page.mouse.move(fromX * width, fromY * height);
  await page.mouse.down();
  for (let i = 1; i <= steps; ++i) {
    const part = i / steps;
    await page.mouse.move((fromX + (toX - fromX) * part) * width, (fromY + (toY - fromY) * part) * height);
    await page.waitForTimeout(16);
  }
  await page.mouse.up();
}
