// The page in a real browser against a real server: node tests/browser/page.mjs
// BRUME_SERVER and BRUME_WEB_ROOT name others than the usual ones; browsers.mjs says which browser it is.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';
import { fingersOn } from './browsers.mjs';
import {
  VIEWPORT,
  another,
  cameraRests,
  connected,
  deviation,
  difference,
  drag,
  faded,
  isPaused,
  mean,
  openPage,
  pausedIs,
  pixels,
  rested,
  settled,
  shown,
  startBrowser,
  strongest,
  until,
} from './pages.mjs';
import { startServer } from './server.mjs';

// Brightness steps, 0 ... 255: JPEG noise stays below, what a person would call a change is above.
const VISIBLE = 2;

let browser;
before(async () => {
  browser = await startBrowser();
});
after(async () => {
  await browser?.close();
});

const far = (a, b) => Math.max(...a.map((x, k) => Math.abs(x - b[k])));

// The statistics' line on the error.
const errorFact = (page) =>
  page
    .locator('#overlay .facts div')
    .filter({ has: page.locator('dt', { hasText: /^error$/ }) })
    .locator('dd');
const MEASURED = /^[\d.]+ % \([\d.]+–[\d.]+\), promised 0\.5 %$/;

async function pause(page, paused) {
  await page.evaluate(() => document.activeElement?.blur());
  const now = await isPaused(page);
  if (now !== paused) await page.keyboard.press('p');
  await until(page, `paused is ${paused}`, pausedIs, paused);
}

describe('one server', () => {
  let server;
  before(async () => {
    server = await startServer();
  });
  after(async () => {
    assert.equal(await server?.stop(), 0, 'the server’s exit');
  });

  test('the canvas shows the cloud', async (t) => {
    const page = await openPage(t, browser, server.url);
    await connected(page);
    await settled(page);
    const picture = await pixels(page);
    const centre = mean(picture, 0.42, 0.4, 0.58, 0.6);
    for (const [x, y] of [
      [0, 0],
      [0.9, 0],
      [0, 0.9],
      [0.9, 0.9],
    ]) {
      const corner = mean(picture, x, y, x + 0.1, y + 0.1);
      assert.ok(far(centre, corner) > 15, `centre ${centre} against corner ${corner}`);
    }
    assert.ok(deviation(picture) > 5, `the picture is nearly uniform: ${deviation(picture)}`);
    const seen = await page.evaluate(() => ({ ...window.brume, state: document.body.dataset.state }));
    assert.equal(seen.state, 'live');
    assert.match(seen.stateHash, /^[0-9a-f]{16}$/);
    assert.ok(seen.viewer > 0);
    assert.ok(seen.lastFrame.bytes > 500);
    assert.ok(
      Math.abs(seen.lastFrame.width / seen.lastFrame.height / (VIEWPORT.width / VIEWPORT.height) - 1) < 0.02,
      'the canvas’s shape',
    );
    assert.ok(seen.lastFrame.latency.total > 0);
    await page.leave();
  });

  test('the window shows the whole picture in its own shape', async (t) => {
    const page = await openPage(t, browser, server.url);
    await connected(page);
    await pause(page, true);
    await settled(page);
    await faded(page); // the curtain
    const off = difference(await pixels(page), await shown(page));
    assert.ok(off < VISIBLE, `window and picture differ by ${off}`);
    await pause(page, false);
    await page.leave();
  });

  test('dragging, scrolling, keys and reset move the camera and the picture', async (t) => {
    const page = await openPage(t, browser, server.url);
    await connected(page);
    await pause(page, true); // whatever changes now, the camera did it
    await rested(page);
    const home = await page.evaluate(() => window.brume.camera);
    const start = await pixels(page);
    await rested(page);
    const noise = difference(start, await pixels(page));
    assert.ok(noise < VISIBLE / 4, `a still picture changes by ${noise}`);

    const moves = {
      'a drag': () => drag(page, [0.5, 0.5], [0.85, 0.62]),
      'the wheel': () => page.mouse.wheel(0, -400),
      'a drag with shift': async () => {
        await page.keyboard.down('Shift');
        await drag(page, [0.5, 0.5], [0.6, 0.5]);
        await page.keyboard.up('Shift');
      },
      'a key': () => page.keyboard.press('KeyW', { delay: 400 }),
    };
    for (const [name, act] of Object.entries(moves)) {
      const before = await pixels(page);
      const { camera } = await page.evaluate(() => window.brume);
      await act();
      await cameraRests(page, camera);
      await rested(page);
      const change = difference(before, await pixels(page));
      assert.ok(change > VISIBLE && change > 8 * noise, `${name} changed the picture by ${change}, noise is ${noise}`);
    }

    await page.keyboard.press('r');
    await rested(page);
    assert.deepEqual(await page.evaluate(() => window.brume.camera), home);
    const back = difference(start, await pixels(page));
    assert.ok(back < VISIBLE / 4, `the first picture again differs by ${back}`);
    await pause(page, false);
    await page.leave();
  });

  test('a finger turns, two fingers zoom', async (t) => {
    const phone = { viewport: { width: 240, height: 420 }, hasTouch: true, isMobile: true };
    const page = await openPage(t, browser, server.url, phone);
    await connected(page);
    const camera = () => page.evaluate(() => window.brume.camera);
    const fingers = await fingersOn(page);
    const before = await camera();
    await fingers.put([[80, 200]]);
    for (let x = 90; x <= 160; x += 10) await fingers.move([[x, 200]]);
    await fingers.lift();
    const turned = await camera();
    assert.ok(turned.yaw < before.yaw - 0.2, `yaw ${before.yaw} became ${turned.yaw}`);
    assert.ok(Math.abs(turned.distance - before.distance) < 1e-9);
    await fingers.put([
      [100, 200],
      [140, 200],
    ]);
    for (let d = 0; d <= 40; d += 8)
      await fingers.move([
        [100 - d, 200],
        [140 + d, 200],
      ]);
    await fingers.lift();
    const near = await camera();
    assert.ok(near.distance < turned.distance * 0.6, `distance ${turned.distance} became ${near.distance}`);
    assert.ok(Math.abs(near.yaw - turned.yaw) < 1e-9);
    const { width, height } = await page.evaluate(() => window.brume.lastFrame);
    assert.ok(height > width, `an upright picture, not ${width}x${height}`);
    await page.leave();
  });

  test('two pages see the same ticks, each from its own side', async (t) => {
    const [one, two] = [await openPage(t, browser, server.url), await openPage(t, browser, server.url)];
    await Promise.all([connected(one), connected(two)]);
    await pause(one, false);
    await drag(two, [0.3, 0.5], [0.8, 0.5]);
    await until(one, 'both are counted', (brume) => brume.scene.viewers === 2);
    await Promise.all([settled(one), settled(two)]);
    let shared = [];
    for (const deadline = Date.now() + 20_000; shared.length < 5 && Date.now() < deadline; ) {
      await Promise.all([another(one, 5), another(two, 5)]);
      const [a, b] = await Promise.all([one, two].map((page) => page.evaluate(() => window.brume.recent)));
      const hashes = new Map(b.map(({ tick, hash }) => [tick, hash]));
      shared = a.filter(({ tick }) => hashes.has(tick));
      for (const { tick, hash } of shared) assert.equal(hash, hashes.get(tick), `the state hash of tick ${tick}`);
    }
    assert.ok(shared.length >= 5, `only ${shared.length} ticks were seen by both`);
    assert.ok(new Set(shared.map(({ hash }) => hash)).size > 1, 'the hash never changes');
    assert.notEqual(...(await Promise.all([one, two].map((page) => page.evaluate(() => window.brume.viewer)))));
    const views = await Promise.all([pixels(one), pixels(two)]);
    assert.ok(difference(...views) > VISIBLE, 'both show the same side');
    await one.leave();
    await two.leave();
  });

  test('a push in one page moves the cloud in the other, and no camera', async (t) => {
    const [one, two] = [await openPage(t, browser, server.url), await openPage(t, browser, server.url)];
    await Promise.all([connected(one), connected(two)]);
    await pause(one, false);
    await Promise.all([settled(one), settled(two)]);
    const cameras = () => Promise.all([one, two].map((page) => page.evaluate(() => window.brume.camera)));
    const before = await cameras();
    // How much the cloud moves by itself, over a longer time than the push takes to show.
    const calm = await pixels(two);
    let drift = 0;
    for (let i = 0; i < 5; ++i) {
      const { tick } = await two.evaluate(() => window.brume);
      await until(two, 'a third of a second passes in the scene', (brume, past) => brume.tick >= past + 20, tick);
      drift = Math.max(drift, strongest(calm, await pixels(two)));
    }
    const least = 3 * Math.max(VISIBLE, drift);
    const push = async () => {
      await one.keyboard.down('Control');
      for (const y of [0.45, 0.55]) await drag(one, [0.3, y], [0.7, y], 14);
      await one.keyboard.up('Control');
    };
    const watch = async () => {
      let most = 0;
      for (const deadline = Date.now() + 10_000; most <= least && Date.now() < deadline; ) {
        await another(two);
        most = Math.max(most, strongest(calm, await pixels(two)));
      }
      return most;
    };
    const [most] = await Promise.all([watch(), push()]);
    assert.ok(most > least, `the push changed ${most}, the cloud by itself ${drift}`);
    assert.deepEqual(await cameras(), before);
    await one.leave();
    await two.leave();
  });

  test('the panel says what is rendered with', async (t) => {
    const page = await openPage(t, browser, server.url);
    await connected(page);
    await page.locator('#tool-panel').click();
    const plan = page.locator('#plan');
    const shows = (pattern) => plan.filter({ hasText: pattern }).waitFor();
    const way = /\w[\w., ]*, [\d.]+ %(, relaxed \d+)?$/; // the method and its settings, then the error
    const method = page.getByRole('combobox', { name: 'Method' });
    const asked = await method.inputValue();
    await method.selectOption('auto');
    await shows(new RegExp(`^auto: ${way.source}`));
    assert.ok(await plan.isVisible());
    assert.ok(await page.locator('input[type=range]').first().isVisible());
    assert.equal(await page.getByRole('slider', { name: /^Union/ }).count(), 0, 'this medium is no union of balls');
    assert.ok((await page.getByRole('slider', { name: /^Falloff/ }).count()) > 0, 'but a sum of Gaussians');
    await method.selectOption('sphere');
    await shows(/^sphere, error not predicted/); // it has no law of its error
    await method.selectOption(asked);
    await page.leave();
  });

  test('the numbers of a slow server fit into the statistics', async (t) => {
    const page = await openPage(t, browser, server.url);
    await connected(page);
    await page.locator('#tool-stats').click();
    const cut = await page.evaluate(() => {
      const values = [...document.querySelectorAll('#overlay .legend dd')];
      for (const value of values) value.textContent = '12345 · 12345 · 12345';
      return values.filter((value) => value.scrollWidth > value.clientWidth).length;
    });
    assert.equal(cut, 0, 'values that are cut off');
    const fits = await page.evaluate(() => {
      const overlay = document.getElementById('overlay');
      return overlay.scrollWidth <= overlay.clientWidth;
    });
    assert.ok(fits, 'the statistics are wider than their box');
    await page.leave();
  });

  test('the statistics and the panel say how wrong the pictures are, as measured', async (t) => {
    const page = await openPage(t, browser, server.url);
    await connected(page);
    await page.locator('#tool-stats').click();
    await page.locator('#tool-panel').click();
    const fact = errorFact(page);
    await fact.filter({ hasText: MEASURED }).waitFor();
    const { error, low, high } = await page.evaluate(() => window.brume.lastFrame.measured);
    assert.ok(0 < low && low < error && error < high && high < 1, `${low} ${error} ${high}`);
    // As it is, and as long as it can be: small errors have more digits.
    const cut = await fact.evaluate((value) => {
      const isCut = () => value.scrollWidth > value.clientWidth || value.scrollHeight > value.clientHeight;
      const [now, box] = [isCut(), value.closest('#overlay')];
      value.textContent = '0.0000098 % (0.0000012–0.0000099), promised 0.0000095 %';
      return { now, longest: isCut(), box: box.scrollWidth > box.clientWidth };
    });
    assert.deepEqual(cut, { now: false, longest: false, box: false }, 'the line is cut off');
    await page.locator('#measured', { hasText: /^measured [\d.]+ % \([\d.]+–[\d.]+\), promised 0\.5 %$/ }).waitFor();
    await page.leave();
  });

  test('a notice does not cover the status line', async (t) => {
    const page = await openPage(t, browser, server.url, { viewport: { width: 900, height: 506 } });
    await connected(page);
    await page.locator('#tool-link').click();
    await page.locator('#toasts .note').waitFor();
    const apart = await page.evaluate(() => {
      document.getElementById('status-text').textContent = 'Accuracy reduced: the server is busy';
      const [brand, notes] = ['brand', 'notes'].map((id) => document.getElementById(id).getBoundingClientRect());
      return notes.top - brand.bottom;
    });
    assert.ok(apart >= 0, `${apart} pixels between them`);
    await page.leave();
  });

  test('a setting changed in one page is followed by the other’s panel', async (t) => {
    const [one, two] = [await openPage(t, browser, server.url), await openPage(t, browser, server.url)];
    await Promise.all([connected(one), connected(two)]);
    await Promise.all([one, two].map((page) => page.locator('#tool-panel').click()));
    const slider = (page) => page.getByRole('slider', { name: 'Exposure' });
    const wanted = await two.evaluate(() => window.brume.scene.settings['render.exposure']);
    await slider(one).focus();
    for (let i = 0; i < 12; ++i) await one.keyboard.press('ArrowRight');
    const chosen = await slider(one).inputValue();
    await until(
      two,
      'the exposure has grown',
      (brume, old) => brume.scene.settings['render.exposure'] > old * 1.1,
      wanted,
    );
    const handle = await slider(two).elementHandle();
    await two.waitForFunction(([input, value]) => input.value === value, [handle, chosen], { polling: 50 });
    await one.leave();
    await two.leave();
  });
});

test('an error that is larger than promised is marked', async (t) => {
  const coarse = ['--set', 'render.shadow_size=16', '--set', 'render.shadow_slices=7']; // for the scene's render.error
  const server = await startServer(...coarse);
  t.after(() => server.stop());
  const page = await openPage(t, browser, server.url);
  await connected(page);
  const colour = (of) => of.evaluate((element) => getComputedStyle(element).color);
  await page.locator('#tool-stats').click();
  const fact = errorFact(page);
  await fact.filter({ hasText: MEASURED }).waitFor();
  await page.locator('#overlay dd.broken').waitFor();
  const usual = page.locator('#overlay dd:not(.broken)').first();
  assert.notEqual(await colour(fact), await colour(usual));
  await page.locator('#tool-panel').click();
  await page.locator('#measured.broken').waitFor();
  await page.leave();
});
