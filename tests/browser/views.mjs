// Views of how a picture is made: chosen in the panel and by the page's address, each for one viewer alone.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';
import { another, connected, difference, openPage, pausedIs, pixels, rested, startBrowser, until } from './pages.mjs';
import { startServer } from './server.mjs';

// Pixels of the lower left corner of what the canvas holds that are nearly white, or nearly black, whichever are fewer:
// a legend has white letters on black.
const ink = (page) =>
  page.evaluate(() => {
    const { canvas } = document.getElementById('view');
    const { width, height } = canvas;
    const copy = new OffscreenCanvas(width, height).getContext('2d');
    copy.drawImage(canvas, 0, 0);
    const { data } = copy.getImageData(0, height - Math.min(60, height), Math.floor(width * 0.8), Math.min(60, height));
    const [white, black] = [0, 0].map((_, which) => {
      let count = 0;
      for (let i = 0; i < data.length; i += 4) {
        const rgb = [data[i], data[i + 1], data[i + 2]];
        count += (which === 0 ? Math.min(...rgb) > 200 : Math.max(...rgb) < 50) ? 1 : 0;
      }
      return count;
    });
    return Math.min(white, black);
  });

// Nothing is given up, however busy the machine: pictures come to rest.
const FINE = ['--frame-budget', '10000', '--most-frame-time', '60000'];

describe('how a picture is made', () => {
  let browser, server;
  before(async () => {
    [browser, server] = await Promise.all([startBrowser(), startServer(...FINE)]);
  });
  after(async () => {
    await browser?.close();
    assert.equal(await server?.stop(), 0, 'the server’s exit');
  });

  test('a view is chosen in the panel, has a legend, and is nobody else’s', async (t) => {
    const viewport = { width: 640, height: 360 };
    const page = await openPage(t, browser, server.url, { viewport });
    const other = await openPage(t, browser, server.url, { viewport });
    await Promise.all([connected(page), connected(other)]);
    await page.keyboard.press('p');
    for (const one of [page, other]) await until(one, 'the scene rests', pausedIs, true);
    await Promise.all([rested(page), rested(other)]);
    const [picture, untouched] = [await pixels(page), await pixels(other)];
    assert.ok((await ink(page)) < 20, 'there is no legend without a view');

    await page.locator('#tool-panel').click();
    const choice = page.getByRole('combobox', { name: 'View' });
    assert.doesNotMatch(await page.locator('#bar').innerHTML(), /\bview\b/i, 'the tools name the camera so');
    const seen = {};
    for (const view of ['overdraw', 'depth', 'light']) {
      await choice.selectOption(view);
      await another(page);
      await rested(page);
      seen[view] = await pixels(page);
      assert.ok(difference(picture, seen[view]) > 5, `${view} is another picture`);
      assert.ok((await ink(page)) > 200, `${view} has a legend`);
    }
    assert.ok(difference(seen.overdraw, seen.depth) > 5, 'views differ');
    assert.match(await page.locator('#panel').innerText(), /sun’s light that arrives/);
    assert.ok(difference(untouched, await pixels(other)) < 1, 'the other page sees the picture');

    await choice.selectOption('picture');
    await another(page);
    await rested(page);
    assert.ok(difference(picture, await pixels(page)) < 1, 'the picture is back');
    await page.keyboard.press('Escape');
    await page.evaluate(() => document.activeElement?.blur());
    await page.keyboard.press('p');
    await until(page, 'the scene goes on', pausedIs, false);
    await Promise.all([page.leave(), other.leave()]);
  });

  test('the page’s own leaves the legend free, on a phone too', async (t) => {
    const phone = {
      viewport: { width: 390, height: 844 },
      hasTouch: true,
      isMobile: true,
    };
    for (const options of [{ viewport: { width: 1280, height: 720 } }, phone]) {
      const page = await openPage(t, browser, `${server.url}/?view=depth&box=1&size=480x270`, options);
      await connected(page);
      await page.locator('#tool-stats').click();
      await page.locator('#tool-panel').click();
      await another(page);
      const found = await page.evaluate(() => {
        const { canvas } = document.getElementById('view');
        const { width, height } = canvas;
        const copy = new OffscreenCanvas(width, height).getContext('2d');
        copy.drawImage(canvas, 0, 0);
        const from = Math.floor(height / 2);
        const { data } = copy.getImageData(0, from, Math.floor(width / 2), height - from);
        let first = 0; // white pixel from above: of the title's letters
        while (first < data.length && Math.min(data[first], data[first + 1], data[first + 2]) < 200) first += 4;
        const row = from + Math.floor(first / 4 / Math.floor(width / 2));
        const own = [...document.querySelectorAll('#bar, #hint, #panel, #overlay')].filter((one) => one.offsetHeight);
        const lowest = Math.max(...own.map((one) => one.getBoundingClientRect().bottom));
        const drawing = document.getElementById('view').shadowRoot.querySelector('.drawing');
        const scale = Number.parseFloat(getComputedStyle(drawing).getPropertyValue('--brume-scale-above'));
        const bar = document.getElementById('bar').getBoundingClientRect();
        return {
          legend: (row / height) * innerHeight,
          lowest,
          aboveBar: innerHeight - scale - 18 < bar.top,
        };
      });
      assert.ok(found.legend < 840 && found.lowest <= found.legend, JSON.stringify(found));
      assert.ok(found.aboveBar, 'the scale is above the tools');
      await page.leave();
    }
  });

  test('a view in the address is shown, one that is not there is a notice', async (t) => {
    const page = await openPage(t, browser, `${server.url}/?view=wasted`, {
      viewport: { width: 640, height: 360 },
    });
    await connected(page);
    assert.ok((await ink(page)) > 200, 'its legend is there');
    await page.leave();
    const wrong = await openPage(t, browser, `${server.url}/?view=x-ray`);
    await connected(wrong);
    assert.match(await wrong.locator('#toasts').innerText(), /view in the address is one of picture, wasted/);
    await wrong.leave();
  });

  test('errors of single pixels collect while the camera rests', async (t) => {
    const page = await openPage(t, browser, `${server.url}/?view=error`, {
      viewport: { width: 640, height: 360 },
    });
    await connected(page);
    // A legend with a bar comes with the first pixel.
    await page.waitForFunction(
      () => {
        const { canvas } = document.getElementById('view');
        const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d');
        copy.drawImage(canvas, 0, 0);
        const { data } = copy.getImageData(0, 0, canvas.width, Math.floor(canvas.height * 0.8));
        let orange = 0; // inferno's middle
        for (let i = 0; i < data.length; i += 4) orange += data[i] > 120 && data[i + 2] < 0.6 * data[i] ? 1 : 0;
        return orange > 50;
      },
      null,
      { timeout: 30_000, polling: 200 },
    );
    await page.leave();
  });
});
