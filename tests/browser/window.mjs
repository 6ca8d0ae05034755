// The page as one window among others: it is hidden and seen again, and the keyboard's focus comes and goes.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';
import { setTimeout } from 'node:timers/promises';
import { startDelay } from './delay.mjs';
import { connected, drag, openPage, startBrowser, until } from './pages.mjs';
import { startServer } from './server.mjs';

let browser;
before(async () => {
  browser = await startBrowser();
});
after(async () => {
  await browser?.close();
});

// A headless browser never hides a page. This does what one with a screen does: window.see(false) stops animation
// frames and says that the document is hidden, window.see(true) lets them go on.
const hideable = `(() => {
  let hidden = false;
  const held = [];
  const request = window.requestAnimationFrame.bind(window);
  window.requestAnimationFrame = (step) => request((now) => (hidden ? held.push(step) : step(now)));
  Object.defineProperty(Document.prototype, 'hidden', { get: () => hidden });
  Object.defineProperty(Document.prototype, 'visibilityState', { get: () => (hidden ? 'hidden' : 'visible') });
  window.see = (seen) => {
    hidden = !seen;
    document.dispatchEvent(new Event('visibilitychange'));
    if (seen) for (const step of held.splice(0)) request(step);
  };
})()`;

async function metrics(server) {
  const text = await (await fetch(`${server.url}/metrics`)).text();
  const value = (name) =>
    Number(
      text
        .split('\n')
        .find((line) => line.startsWith(`${name} `))
        ?.split(' ')[1],
    );
  return { rendered: value('brume_frames_total{fate="rendered"}'), ticks: value('brume_tick_seconds_count') };
}

// How many frames the server lets be on their way to its one viewer.
async function windowOf(server) {
  const { viewers } = await (await fetch(`${server.url}/viewers`)).json();
  return viewers[0].window_frames;
}

// The frames that the server renders for everybody in that many ticks of the simulation.
async function renderedIn(server, ticks) {
  const first = await metrics(server);
  let last = first;
  while (last.ticks < first.ticks + ticks) {
    await setTimeout(50); // between two questions
    last = await metrics(server);
  }
  return last.rendered - first.rendered;
}

test('a hidden page costs the server nothing, and has pictures again when it is seen', async (t) => {
  const server = await startServer();
  t.after(() => server.stop());
  // A viewer far away has many frames on their way: each that comes would make room for another, presented or not.
  const delay = await startDelay(server.url, 40);
  t.after(() => delay.stop());
  const page = await openPage(t, browser, delay.url, { script: hideable });
  await connected(page);
  for (const deadline = Date.now() + 30_000; (await windowOf(server)) < 4; )
    assert.ok(Date.now() < deadline, 'a wide window');
  assert.ok((await renderedIn(server, 60)) > 0, 'the cloud moves');
  const viewer = await page.evaluate(() => window.brume.viewer);

  await page.evaluate(() => window.see(false));
  const hidden = performance.now();
  let rendered = Infinity;
  for (const deadline = Date.now() + 30_000; rendered > 0 && Date.now() < deadline; )
    rendered = await renderedIn(server, 60);
  assert.equal(rendered, 0, 'frames in a second long after the page was hidden');
  t.diagnostic(`a second without a frame ended ${Math.round(performance.now() - hidden)} ms after the page was hidden`);

  const { frames } = await page.evaluate(() => window.brume);
  const seen = performance.now();
  await page.evaluate(() => window.see(true));
  // The first picture may have waited in the page since before; the others are new.
  await until(page, 'pictures come again', (brume, old) => brume.frames >= old + 5, frames);
  t.diagnostic(`five pictures ${Math.round(performance.now() - seen)} ms after it was seen again`);
  const now = await page.evaluate(() => ({ viewer: window.brume.viewer, state: window.brume.state }));
  assert.deepEqual(now, { viewer, state: 'connected' }, 'the same viewer, never disconnected');
  await page.leave();
  assert.equal(await server.stop(), 0, 'the server’s exit');
});

describe('the keyboard’s focus', () => {
  let server;
  before(async () => {
    server = await startServer();
  });
  after(async () => {
    assert.equal(await server?.stop(), 0, 'the server’s exit');
  });
  const outline = (page) => page.evaluate(() => getComputedStyle(document.getElementById('view')).outlineStyle);

  test('shows no frame around the picture after a drag, also after a key', async (t) => {
    const page = await openPage(t, browser, server.url);
    await connected(page);
    await drag(page, [0.5, 0.5], [0.7, 0.6]);
    assert.equal(await outline(page), 'none', 'after a drag');
    await page.keyboard.press('w');
    await drag(page, [0.5, 0.5], [0.7, 0.6]);
    assert.equal(await outline(page), 'none', 'after a key and a drag');
    await page.leave();
  });

  test('shows one when it comes by Tab, until the mouse takes over', async (t) => {
    const page = await openPage(t, browser, server.url);
    await connected(page);
    const focused = () => page.evaluate(() => document.activeElement?.id);
    for (let i = 0; i < 40 && (await focused()) !== 'view'; ++i) await page.keyboard.press('Tab');
    assert.equal(await focused(), 'view', 'Tab comes to the picture');
    assert.equal(await outline(page), 'solid', 'after Tab');
    await drag(page, [0.5, 0.5], [0.7, 0.6]);
    assert.equal(await outline(page), 'none', 'after a drag');
    await page.leave();
  });

  test('as narrow as a small phone cuts nothing off', async (t) => {
    const page = await openPage(t, browser, server.url);
    await connected(page);
    await page.setViewportSize({ width: 320, height: 640 });
    const beyond = () =>
      page.evaluate(() =>
        [...document.querySelectorAll('#brand, #bar, #bar *, #hint, #overlay, #overlay *, #panel, #panel *')]
          .filter((element) => element.checkVisibility() && element.getClientRects().length > 0)
          .filter((element) => {
            const { left, right } = element.getBoundingClientRect();
            return left < -1 || right > window.innerWidth + 1;
          })
          .map((element) => `${element.tagName} ${element.id} ${element.textContent.slice(0, 30)}`),
      );
    assert.deepEqual(await beyond(), [], 'the hint and the tools');
    await page.locator('#tool-stats').click();
    await page.locator('#overlay .facts dd', { hasText: 'pixels' }).waitFor(); // the longest: what is rendered with
    assert.deepEqual(await beyond(), [], 'the statistics');
    await page.locator('#tool-stats').click();
    await page.locator('#tool-panel').click();
    assert.deepEqual(await beyond(), [], 'the settings');
    await page.leave();
  });

  test('upright as a phone shows tools, settings and statistics side by side, and nothing through them', async (t) => {
    const page = await openPage(t, browser, server.url, { viewport: { width: 390, height: 844 }, isMobile: true });
    await connected(page);
    await page.locator('#tool-stats').click();
    await page.locator('#tool-panel').click();
    const seen = await page.evaluate(() => {
      const parts = ['#brand', '#overlay', '#panel', '#bar'].map((id) => document.querySelector(id));
      const edges = parts.flatMap((part) => {
        const { top, bottom } = part.getBoundingClientRect();
        return [top, bottom];
      });
      return { edges, grounds: parts.map((part) => getComputedStyle(part).backgroundColor) };
    });
    const down = [...seen.edges].sort((a, b) => a - b);
    assert.deepEqual(seen.edges, down, 'one below the other');
    assert.ok(seen.edges[3] - seen.edges[2] > 100, 'the statistics are still to be read');
    for (const ground of seen.grounds) assert.match(ground, /^rgb\(/, 'opaque');
    await page.leave();
  });

  test('leaves a field of the panel when the picture is pressed: keys move the camera again', async (t) => {
    const page = await openPage(t, browser, server.url);
    await connected(page);
    await page.locator('#tool-panel').click();
    await page.getByRole('slider', { name: 'Exposure' }).focus();
    await drag(page, [0.3, 0.5], [0.4, 0.5]);
    const { yaw } = await page.evaluate(() => window.brume.camera);
    await page.keyboard.press('ArrowLeft', { delay: 200 });
    await until(page, 'an arrow key turns the camera', (brume, old) => brume.camera.yaw !== old, yaw);
    await page.leave();
  });
});
