// The page for people without a mouse, with a screen reader, with large letters or less motion. What can be found by
// rules is axe-core's; the rest is used as they would.
import assert from 'node:assert/strict';
import { randomBytes } from 'node:crypto';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { IS_FIREFOX } from './browsers.mjs';
import { VIEWPORT, cameraRests, connected, faded, openPage, startBrowser, until } from './pages.mjs';
import { startServer } from './server.mjs';

const AXE = readFileSync(fileURLToPath(new URL('node_modules/axe-core/axe.min.js', import.meta.url)), 'utf8');
const WIDE = { width: 1280, height: 720 };
const PHONE = { width: 360, height: 640 };
const ZOOMED = { viewport: { width: 640, height: 360 }, deviceScaleFactor: 2 }; // a window of 1280 x 720 at 200 %

let browser, server, locked, folder;
before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'brume-'));
  const key = join(folder, 'token.key');
  writeFileSync(key, randomBytes(32), { mode: 0o600 });
  [browser, server, locked] = await Promise.all([startBrowser(), startServer(), startServer('--token-key', key)]);
});
after(async () => {
  await browser?.close();
  for (const one of [server, locked]) if (one) assert.equal(await one.stop(), 0, 'the server’s exit');
  if (folder) rmSync(folder, { recursive: true });
});

const open = (t, url = server.url, options = {}) =>
  openPage(t, browser, url, { script: AXE, viewport: WIDE, reducedMotion: 'reduce', ...options });

// What axe finds, a line each, upon a white picture and a black one: the hardest for what lies upon them. It cannot tell
// what is behind letters over a picture, a gradient, or the edge of what scrolls; these rules make it known.
const PLAIN = `
  #view { background: none }
  #curtain { background: #263447 } /* its lightest */
  #overlay .passes > div { background: rgb(156 196 238 / 20%) }
  html, body { height: auto; overflow: visible }
  @media (min-width: 1000px) {
    #panel, #overlay { max-height: none !important; position: absolute }
    #bar:has(~ #panel:not([hidden])) { display: none }
  }
`;
const findings = (page) =>
  page.evaluate(async (plain) => {
    const sheet = new CSSStyleSheet();
    document.adoptedStyleSheets = [sheet];
    for (const canvas of document.getElementById('view').shadowRoot.querySelectorAll('canvas'))
      canvas.style.visibility = 'hidden';
    const found = [];
    for (const ground of ['white', 'black']) {
      sheet.replaceSync(`${plain} html, body { background: ${ground} !important }`);
      const { violations, incomplete } = await window.axe.run(document, {
        resultTypes: ['violations', 'incomplete'],
        rules: { 'target-size': { enabled: true } },
      });
      // Of what it leaves open only contrast counts, and of that not arrows and crosses.
      const open = incomplete.filter(({ id }) => id === 'color-contrast');
      for (const { id, nodes } of [...violations, ...open])
        for (const { target, any, all, none } of nodes) {
          const [{ message, data }] = [...any, ...all, ...none];
          if (data?.messageKey === 'nonBmp' || data?.messageKey === 'shortTextContent') continue;
          found.push(`${id}, on ${ground}: ${target.flat().join(' ')}: ${message}`);
        }
    }
    document.adoptedStyleSheets = [];
    return found;
  }, PLAIN);

async function holds(page) {
  await faded(page);
  assert.deepEqual(await findings(page), []);
  await page.leave();
}

test('axe finds nothing on the page with tools and a note', async (t) => {
  const page = await open(t);
  await connected(page);
  await page.locator('#tool-link').click();
  await page.locator('#toasts .note').waitFor();
  await holds(page);
});

for (const part of ['panel', 'stats'])
  test(`nor as narrow as a phone, with ${part}`, async (t) => {
    const page = await open(t, server.url, { viewport: PHONE });
    await connected(page);
    await page.locator(`#tool-${part}`).click();
    await holds(page);
  });

test('nor in the dialog that compares pictures, which gives the focus back', async (t) => {
  const page = await open(t, `${server.url}/?draw=client`, { viewport: { width: 800, height: 450 } });
  await until(page, 'the page draws', ({ drawing, drawn }) => drawing === 'client' && drawn?.rays > 0);
  await page.locator('#tool-panel').click();
  const compare = page.getByRole('button', { name: 'Compare' });
  await compare.click();
  const dialog = page.getByRole('dialog');
  await dialog.waitFor();
  assert.ok(await dialog.evaluate((element) => element.contains(document.activeElement)), 'the focus goes in');
  const found = await findings(page);
  await page.keyboard.press('Escape');
  await dialog.waitFor({ state: 'detached' });
  assert.ok(await compare.evaluate((element) => element === document.activeElement), 'and comes back');
  assert.deepEqual(found, []);
  await page.leave();
});

test('nor where the page is refused, whose line is told', async (t) => {
  const page = await open(t, locked.url);
  await until(page, 'it is refused', (brume) => brume.state === 'refused');
  await page.getByRole('status').filter({ hasText: 'A token is needed' }).waitFor();
  await holds(page);
});

for (const url of ['', 'refused'])
  test(`nor in the view alone${url && ', refused'}`, async (t) => {
    const page = await open(t, `${(url ? locked : server).url}/embed.html`);
    await (url ? until(page, 'it is refused', (brume) => brume.state === 'refused') : connected(page));
    await holds(page);
  });

// Last: what it adds stays in the scene.
test('nor with all settings, the statistics and a handle', async (t) => {
  const page = await open(t);
  await connected(page);
  await page.locator('#tool-panel').click();
  await page.locator('#panel .setting').first().waitFor();
  await page.evaluate(() => document.querySelectorAll('#panel details').forEach((group) => (group.open = true)));
  await page.locator('#tool-stats').click();
  await page.getByRole('button', { name: 'Add' }).first().click();
  await page.locator('.handle').first().waitFor();
  await holds(page);
});

// What the keyboard can come to on the page.
const REACHABLE =
  'brume-view, button:not(:disabled), input, select, summary, a[href], [tabindex="0"]:not(button, brume-view)';

test('Tab comes to all there is, and shows where it is', async (t) => {
  const page = await open(t);
  await connected(page);
  for (const key of ['i', 'o']) await page.keyboard.press(key); // a click would be where Tab goes on from
  await page.locator('#panel .setting').first().waitFor();
  const all = await page.evaluate((selector) => {
    const seen = [...document.querySelectorAll(selector)].filter(
      (one) => one.checkVisibility({ visibilityProperty: true }) && !one.closest('[inert]') && one.tabIndex >= 0,
    );
    window.order = new Map(seen.map((one, i) => [one, i]));
    window.met = new Map();
    document.addEventListener('focusin', ({ target }) => {
      const ring = target.matches('brume-view') ? target.shadowRoot.querySelector('.ring') : target;
      const { outlineStyle, outlineWidth } = getComputedStyle(ring);
      window.met.set(target, outlineStyle !== 'none' && parseFloat(outlineWidth) >= 2);
    });
    return seen.length;
  }, REACHABLE);
  assert.ok(all > 40, `${all} places to come to`);
  for (let i = 0; i < all + 3; ++i) await page.keyboard.press('Tab');
  const missing = await page.evaluate(() =>
    [...window.order.keys()]
      .filter((one) => window.met.get(one) !== true)
      .map((one) => `${one.tagName} ${one.id} ${one.title} ${window.met.get(one) === false ? 'no ring' : 'not met'}`),
  );
  assert.deepEqual(missing, []);
  await page.leave();
});

test('keys turn, fly, push, open the settings and leave them', async (t) => {
  const page = await open(t, server.url, { viewport: VIEWPORT });
  await connected(page);
  const camera = () => page.evaluate(() => window.brume.camera);
  for (const key of ['ArrowLeft', 'w']) {
    const before = await camera();
    await page.keyboard.press(key, { delay: 100 });
    await cameraRests(page, before);
  }
  const commands = async () =>
    Number(/^brume_command_to_tick_seconds_count (\d+)/m.exec(await (await fetch(`${server.url}/metrics`)).text())[1]);
  const [before, count] = [await camera(), await commands()];
  await page.keyboard.press('x');
  await page.keyboard.press('ArrowRight', { delay: 200 });
  for (const deadline = Date.now() + 30_000; (await commands()) <= count; ) assert.ok(Date.now() < deadline, 'a push');
  assert.deepEqual(await camera(), before, 'the camera stays where it was');
  await page.keyboard.press('Escape');
  const focused = () => page.evaluate(() => document.activeElement.id || document.activeElement.className);
  await page.locator('#tool-panel').focus();
  await page.keyboard.press('Enter');
  await page.keyboard.press('Tab');
  if ((await focused()) === 'panel') await page.keyboard.press('Tab'); // Firefox stops at what scrolls
  assert.equal(await focused(), 'close', 'the settings follow their button');
  await page.keyboard.press('Escape');
  assert.equal(await focused(), 'tool-panel', 'which has the focus again');
  assert.ok(await page.locator('#panel').isHidden());
  await page.leave();
});

test('at 200 % nothing is cut off, nor covers what it should not', async (t) => {
  const page = await open(t, server.url, ZOOMED);
  await connected(page);
  for (const part of ['stats', 'panel']) await page.locator(`#tool-${part}`).click();
  await page.locator('#panel .setting').first().waitFor();
  await faded(page);
  const seen = await page.evaluate(() => {
    const box = (id) => document.getElementById(id).getBoundingClientRect();
    const apart = (a, b) => a.bottom <= b.top || b.bottom <= a.top || a.right <= b.left || b.right <= a.left;
    const parts = ['brand', 'overlay', 'panel', 'bar'];
    const pairs = parts.flatMap((a, i) => parts.slice(i + 1).map((b) => [a, b]));
    return {
      beyond: parts.filter((id) => {
        const { left, top, right, bottom } = box(id);
        return left < 0 || top < 0 || right > window.innerWidth || bottom > window.innerHeight;
      }),
      upon: pairs.filter(([a, b]) => !apart(box(a), box(b))).map(String),
      wide: ['panel', 'overlay'].filter((id) => {
        const { scrollWidth, clientWidth, clientHeight } = document.getElementById(id);
        return scrollWidth > clientWidth || clientHeight < 100;
      }),
    };
  });
  assert.deepEqual(seen, { beyond: [], upon: [], wide: [] });
  await page.leave();
});

const skip = IS_FIREFOX && 'Playwright cannot tell Firefox so';
test('nothing moves by itself for who wants less motion', { skip }, async (t) => {
  for (const [reducedMotion, moves] of [
    ['reduce', false],
    ['no-preference', true],
  ]) {
    const page = await open(t, server.url, { reducedMotion });
    await connected(page);
    const count = await page.evaluate(() => document.getAnimations().length);
    assert.equal(count > 0, moves, `${count} animations where ${reducedMotion} is asked for`);
    await page.leave();
  }
});
