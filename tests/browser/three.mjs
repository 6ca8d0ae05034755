// The example with Three.js: the medium is in front of what is behind it, and hides nothing of what is before it.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';
import { startBrowser } from './pages.mjs';
import { startServer } from './server.mjs';

describe('three.html', () => {
  let server, browser;
  before(async () => {
    [server, browser] = await Promise.all([startServer(), startBrowser()]);
  });
  after(async () => {
    await browser?.close();
    await server?.stop();
  });

  // The canvas's pixels, with the medium or without, and with the knot this far from the camera to the medium's middle.
  const look = (page, visible, ahead) =>
    page.evaluate(
      async ([visible, ahead]) => {
        const { medium, knot, camera, controls } = window.example;
        medium.visible = visible;
        knot.position.copy(camera.position).lerp(controls.target, ahead);
        const canvas = document.querySelector('canvas');
        const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d');
        // This frame's callback comes behind the page's own: the canvas still has its picture.
        for (let i = 0; i < 3; ++i) await new Promise((done) => requestAnimationFrame(done));
        copy.drawImage(canvas, 0, 0);
        return [...copy.getImageData(0, 0, canvas.width, canvas.height).data];
      },
      [visible, ahead],
    );
  // Mean change of a channel, 0 ... 255.
  const change = (a, b) => a.reduce((sum, x, i) => sum + Math.abs(x - b[i]), 0) / (0.75 * a.length);

  test('draws the medium by depth', async () => {
    const page = await browser.newPage({ viewport: { width: 320, height: 180 } });
    const errors = [];
    page.on('pageerror', (error) => errors.push(error.message));
    page.on('console', (message) => message.type() === 'error' && errors.push(message.text()));
    await page.goto(`${server.url}/three.html`);
    await page.waitForFunction(() => window.example?.medium.light, null, { polling: 50, timeout: 120_000 });
    // The knot far behind the medium, then well in front of it.
    const [all, changes] = [[], []];
    for (const ahead of [2, 0.3]) {
      const pictures = [await look(page, true, ahead), await look(page, false, ahead)];
      // Where the knot is: what is red without the medium.
      const red = [];
      const [full, bare] = pictures;
      for (let i = 0; i < bare.length; i += 4)
        if (bare[i] > 2 * bare[i + 2] && bare[i] > 2 * bare[i + 1]) red.push(...[0, 1, 2].map((k) => i + k));
      assert.ok(red.length > 60, `the knot has ${red.length / 3} pixels`);
      changes.push(red.reduce((sum, i) => sum + Math.abs(full[i] - bare[i]), 0) / red.length);
      all.push(change(full, bare));
    }
    assert.ok(all[0] > 3, `the medium changes the picture by ${all[0]}`);
    assert.ok(changes[0] > 10, `behind the medium the knot changes by ${changes[0]}`);
    assert.ok(changes[1] < 1, `in front of it by ${changes[1]}`);
    assert.deepEqual(errors, [], 'errors in the page');
  });
});
