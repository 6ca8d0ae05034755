// In a headset, emulated in the page (two-eyes.mjs): both eyes' pictures, and what the controllers do.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';
import { startDelay } from './delay.mjs';
import { another, connected, openPage, startBrowser, until } from './pages.mjs';
import { startServer } from './server.mjs';
import { FOV_Y, IPD, bothEyes, contrast, disparity, halves, headset, takeContext } from './two-eyes.mjs';

describe('a headset', () => {
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

  // Until so many more frames of its display are drawn.
  const drawnAgain = async (page, more = 3) => {
    const { drawn } = await page.evaluate(() => window.brume.headset);
    await until(page, 'newer frames are drawn', (brume, most) => brume.headset.drawn > most, drawn + more);
  };
  // Both eyes see the cloud, as far apart as its distance says.
  const hasParallax = async (page, camera) => {
    const eyes = await halves(page, 'div[data-webxr_runtime]');
    for (const half of eyes) assert.ok(contrast(half) > 4, `an eye is nearly black: ${contrast(half)}`);
    // The cloud reaches from its middle some 6 m toward the eyes, and what is near is seen best.
    const pixel = (2 * Math.tan(FOV_Y / 2)) / eyes[0].length;
    const wanted = IPD / camera.distance / pixel;
    const found = disparity(eyes);
    assert.ok(found > 0.8 * wanted && found < 1.6 * wanted, `${found} pixels of parallax where ${wanted} are due`);
  };
  const askedOf = (page) => page.evaluate(() => window.brume.headset.asked);

  test('stands on the floor that the page’s camera stands over', async (t) => {
    const page = await enter(t);
    const { camera } = await page.evaluate(() => window.brume);
    const close = (a, b) => a.forEach((x, i) => assert.ok(Math.abs(x - b[i]) < 1e-4, `${a} where ${b} is due`));
    close((await askedOf(page)).position, camera.position);
    await page.evaluate(() => window.device.position.set(0, 1.1, 0)); // sits down
    await drawnAgain(page, 20); // the predicted pose has come to rest
    const [x, y, z] = camera.position;
    close((await askedOf(page)).position, [x, y - 0.5, z]);
    await page.leave();
  });

  test('asks for where the head will be when the picture is seen', async (t) => {
    const delay = await startDelay(server.url, 40);
    t.after(() => delay.stop());
    const page = await enter(t, 0, delay.url);
    const leads = await page.evaluate(async () => {
      const [speed, leads, begun] = [0.4, [], performance.now()]; // rad/s about the vertical
      while (leads.length < 40) {
        const angle = (speed * (performance.now() - begun)) / 1000;
        window.device.quaternion.set(0, Math.sin(angle / 2), 0, Math.cos(angle / 2));
        await new Promise((done) => window.device.activeSession.requestAnimationFrame(done));
        const { orientation } = window.brume.headset.asked;
        leads.push((2 * Math.atan2(orientation[1], orientation[3]) - angle) / speed);
      }
      return leads.slice(15); // s
    });
    const lead = leads.sort((a, b) => a - b)[Math.floor(leads.length / 2)];
    assert.ok(lead > 0.04 && lead < 0.2, `${lead} s ahead over a link of 80 ms`);
    await page.leave();
  });

  test('its grip holds the scene, and moves it', async (t) => {
    const page = await enter(t);
    const before = await askedOf(page);
    await page.evaluate(() => {
      const { right } = window.device.controllers;
      right.position.set(0.2, 1.4, -0.3);
      right.quaternion.set(0, 0, 0, 1);
      right.updateButtonValue('squeeze', 1);
    });
    await drawnAgain(page);
    await page.evaluate(() => window.device.controllers.right.position.set(0.5, 1.4, -0.3));
    await drawnAgain(page);
    await page.evaluate(() => window.device.controllers.right.updateButtonValue('squeeze', 0));
    await drawnAgain(page, 20);
    await page.evaluate(() => window.device.controllers.right.position.set(0, 1, -0.3)); // holds nothing
    await drawnAgain(page);
    const [was, now] = [before.position, (await askedOf(page)).position];
    const moved = Math.hypot(...now.map((x, i) => x - was[i]));
    assert.ok(Math.abs(moved - 0.3) < 0.01, `the scene moved by ${moved} m with a hand that moved by 0.3`);
    await page.leave();
  });

  test('its trigger pushes the medium', async (t) => {
    const page = await enter(t);
    const commands = async () =>
      Number(
        /^brume_command_to_tick_seconds_count (\d+)/m.exec(await (await fetch(`${server.url}/metrics`)).text())[1],
      );
    const before = await commands();
    await page.evaluate(() => window.device.controllers.right.updateButtonValue('trigger', 1));
    await drawnAgain(page, 30);
    // One that rests pushes again and again, as the mouse does.
    for (let tries = 0; (await commands()) < before + 3; ++tries) {
      assert.ok(tries < 200, 'no push arrives');
      await page.waitForTimeout(50);
    }
    await page.evaluate(() => window.device.controllers.right.updateButtonValue('trigger', 0));
    await page.leave();
  });

  test('without a headset there is no button', async (t) => {
    const page = await openPage(t, browser, server.url);
    await connected(page);
    assert.ok(await page.locator('#tool-vr').isHidden());
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
    await hasParallax(page, camera);
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
    await drawnAgain(page);
    await hasParallax(page, camera);
    await page.leave();
  });

  test('in the wearer’s room nothing is drawn but the cloud', async (t) => {
    const page = await openPage(t, browser, server.url, { script: headset(0) });
    await connected(page);
    await page.locator('#tool-ar').click();
    await until(page, 'both eyes are drawn', ({ lastFrame, headset: on }) => lastFrame.layers > 0 && on?.drawn >= 5);
    // Alpha of the left eye's middle and of its corner, 0 ... 255.
    const alphas = await page.evaluate(
      () =>
        new Promise((done) =>
          window.device.activeSession.requestAnimationFrame(() => {
            const canvas = document.querySelector('div[data-webxr_runtime] canvas');
            const gl = canvas.getContext('webgl2');
            const at = (x, y) => {
              const pixel = new Uint8Array(4);
              gl.readPixels(x, y, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
              return pixel[3];
            };
            gl.bindFramebuffer(gl.FRAMEBUFFER, null);
            done([at(canvas.width / 4, canvas.height / 2), at(2, 2)]);
          }),
        ),
    );
    assert.ok(alphas[0] > 150, `the cloud’s middle covers the room by ${alphas[0]} of 255`);
    assert.ok(alphas[1] < 3, `beside the cloud ${alphas[1]} of 255 cover the room`);
    await page.leave();
  });

  test('a way of rendering without layers gives it a picture for each eye', async (t) => {
    const page = await openPage(t, browser, `${server.url}/?reproject=layers`, { script: headset(0) });
    await connected(page);
    await page.locator('#tool-vr').click();
    await until(page, 'layers come', ({ lastFrame, headset: on }) => lastFrame.layers > 0 && on?.drawn >= 5);
    await page.evaluate(() => {
      const change = { path: 'render.method', value: 'sphere' };
      document.getElementById('view').viewer.command({ kind: 'set', changes: [change] });
    });
    await bothEyes(page);
    await page.evaluate(() => {
      const change = { path: 'render.method', value: 'auto' };
      document.getElementById('view').viewer.command({ kind: 'set', changes: [change] });
    });
    await another(page, 3);
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
