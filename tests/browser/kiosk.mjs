// A page that stands alone on a screen (?kiosk=1), in a real Chromium: node --test tests/browser/kiosk.mjs
import assert from 'node:assert/strict';
import { createHmac, randomBytes } from 'node:crypto';
import { cpSync, mkdtempSync, readFileSync, renameSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { another, connected, drag, openPage, settled, startBrowser, until } from './pages.mjs';
import { WEB_ROOT, startServer } from './server.mjs';

const SKIP = process.env.BRUME_TESTS !== 'whole' && 'it waits for long: BRUME_TESTS=whole';

let browser, folder;
before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'brume-'));
  browser = await startBrowser();
});
after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true });
});

const cameraOf = (page) => page.evaluate(() => window.brume.camera);
const turns = (page) =>
  until(page, 'it turns by itself', ({ camera }, before) => Math.abs(camera.yaw - before.yaw) > 0.02, {
    yaw: page.yaw,
  });
// Elements of the body, and of its main part, that are to be seen.
const seen = (page) =>
  page.evaluate(() =>
    [...document.querySelectorAll('body > :not(main), main > *')]
      .filter((one) => one.offsetHeight > 0)
      .map((one) => one.id),
  );
const inputs = (page) =>
  page.evaluate(() => {
    const { link } = document.getElementById('view').viewer;
    const send = link.sendInput.bind(link);
    window.inputs = [];
    link.sendInput = (command) => {
      window.inputs.push(command.kind);
      return send(command);
    };
  });

test('the picture is alone, a drag pushes, and nobody’s camera turns', async (t) => {
  const server = await startServer();
  t.after(() => server.stop());
  const page = await openPage(t, browser, `${server.url}/?kiosk=1&idle=2&turn=20&reproject=rotation`);
  await connected(page);
  assert.deepEqual(await seen(page), ['view']);
  for (const key of ['o', 'i', 'x']) await page.keyboard.press(key); // panel, statistics, push
  assert.deepEqual(await seen(page), ['view']);

  // A touch: the whole screen, a push, and the camera stays.
  await inputs(page);
  const camera = await cameraOf(page);
  await drag(page, [0.4, 0.5], [0.6, 0.5]);
  assert.deepEqual(await cameraOf(page), camera);
  const pushes = await page.evaluate(() => window.inputs);
  assert.ok(pushes.length > 0 && pushes.every((kind) => kind === 'impulse'), pushes.join());
  await page.waitForFunction(() => document.fullscreenElement !== null, null, { polling: 50 });
  await page.waitForFunction(() => getComputedStyle(document.getElementById('view')).cursor === 'none', null, {
    polling: 50,
  });

  // Left alone it turns about its pivot; a touch ends that.
  page.yaw = camera.yaw;
  await turns(page);
  const drifting = await cameraOf(page);
  assert.ok(Math.abs(drifting.distance - camera.distance) < 1e-9);
  await page.mouse.down();
  await page.waitForFunction(
    () => {
      const { yaw } = window.brume.camera;
      const stands = window.lastYaw === yaw;
      window.lastYaw = yaw;
      return stands;
    },
    null,
    { polling: 200 },
  );
  await page.mouse.up();

  // A graphics context that is lost and comes back, or does not.
  await page.evaluate(() => {
    const canvas = document.getElementById('view').warped;
    window.context = canvas.getContext('webgl2').getExtension('WEBGL_lose_context');
    window.context.loseContext();
  });
  await another(page, 2);
  await page.evaluate(() => window.context.restoreContext());
  await another(page, 2);
  await page.waitForFunction(() => !document.getElementById('view').warped.hidden, null, { polling: 50 });

  // Who presents has its camera.
  const guide = await openPage(t, browser, server.url);
  await connected(guide);
  await guide.evaluate(() => document.getElementById('view').viewer.people.lead(true));
  await drag(guide, [0.5, 0.5], [0.8, 0.6]);
  await settled(guide);
  const led = await cameraOf(guide);
  await until(page, 'it follows', ({ camera }, yaw) => Math.abs(camera.yaw - yaw) < 1e-3, led.yaw);
  await page.waitForTimeout(3000); // longer than idle
  assert.ok(Math.abs((await cameraOf(page)).yaw - led.yaw) < 1e-3, 'a presenter’s camera does not drift');
  await guide.leave();
  page.yaw = led.yaw;
  await turns(page);
  await page.leave();
  assert.equal(await server.stop(), 0, 'the server’s exit');
});

test('who wants no motion gets none, and the address’s mistakes are one line', { skip: SKIP }, async (t) => {
  const server = await startServer();
  t.after(() => server.stop());
  const page = await openPage(t, browser, `${server.url}/?kiosk=1&idle=2&turn=20`, { reducedMotion: 'reduce' });
  const wrong = await openPage(t, browser, `${server.url}/?kiosk=1&idle=0`);
  const frame = await openPage(t, browser, `${server.url}/embed.html?idle=2&turn=20`);
  for (const one of [page, wrong, frame]) await connected(one);
  const camera = await cameraOf(page);
  frame.yaw = (await cameraOf(frame)).yaw;
  await turns(frame);
  await page.waitForTimeout(1000);
  assert.deepEqual(await cameraOf(page), camera);
  assert.deepEqual(await seen(wrong), ['view', 'away']);
  assert.equal(await wrong.locator('#away').textContent(), 'idle takes seconds from 2 to 3600: idle=20.');
  for (const one of [page, wrong, frame]) await one.leave();
  assert.equal(await server.stop(), 0, 'the server’s exit');
});

test('a server that comes back with another page has it loaded, once', async (t) => {
  const web = join(folder, 'web');
  cpSync(WEB_ROOT, web, { recursive: true });
  let server = await startServer('--web-root', web);
  t.after(() => server.stop());
  const page = await openPage(t, browser, `${server.url}/?kiosk=1&size=480x270`);
  await connected(page);
  let loads = 0;
  page.on('load', () => ++loads);
  await server.stop();
  const away = page.locator('#away');
  await away.filter({ hasText: /^The server is away/ }).waitFor();
  assert.deepEqual(await seen(page), ['view', 'away']);

  // The same page: nothing is loaded.
  server = await startServer('--web-root', web, '--port', server.port);
  await connected(page);
  await away.waitFor({ state: 'hidden' });
  await another(page, 3);
  assert.equal(loads, 0);

  // Another.
  await server.stop('SIGKILL');
  const index = join(web, 'index.html');
  const markup = readFileSync(index, 'utf8');
  const [, name] = /assets\/(index-[^"]+\.js)/.exec(markup);
  renameSync(join(web, 'assets', name), join(web, 'assets/index-other.js'));
  writeFileSync(index, markup.replace(name, 'index-other.js'));
  const loaded = page.waitForEvent('load', { timeout: 60_000 });
  server = await startServer('--web-root', web, '--port', server.port);
  await loaded;
  await connected(page);
  assert.equal(
    await page.evaluate(() => document.querySelector('script[src]').getAttribute('src')),
    './assets/index-other.js',
  );
  assert.match(page.url(), /\?kiosk=1&size=480x270$/);
  await another(page, 3);
  assert.equal(loads, 1);
  await page.leave();
  assert.equal(await server.stop(), 0, 'the server’s exit');
});

test('a token to push is enough; when it has ended, one line says so', { skip: SKIP }, async (t) => {
  const secret = randomBytes(32);
  const key = join(folder, 'token.key');
  writeFileSync(key, secret, { mode: 0o600 });
  const server = await startServer('--token-key', key);
  t.after(() => server.stop());
  // Clocks may be 30 s apart: it is good for another 15 s.
  const claims = { exp: Math.floor(Date.now() / 1000) - 15, name: 'foyer', role: 'pusher' };
  const said = Buffer.from(JSON.stringify(claims)).toString('base64url');
  const token = `${said}.${createHmac('sha256', secret).update(said).digest('base64url')}`;
  const page = await openPage(t, browser, `${server.url}/?kiosk=1#token=${token}`);
  await connected(page);
  await inputs(page);
  await drag(page, [0.4, 0.5], [0.6, 0.5]);
  assert.ok((await page.evaluate(() => window.inputs)).length > 0);
  assert.deepEqual(await seen(page), ['view']);
  await until(page, 'it is refused', (brume) => brume.state === 'refused');
  const line = page.locator('#away');
  await line.waitFor();
  assert.match(await line.textContent(), /token.*\.$/);
  t.diagnostic(await line.textContent());
  await page.leave();
  assert.equal(await server.stop(), 0, 'the server’s exit');
});
