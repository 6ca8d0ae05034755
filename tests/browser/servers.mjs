// The page whose server stops, is killed, or is full, in a real Chromium: node tests/browser/servers.mjs
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { another, connected, difference, drag, openPage, pixels, settled, startBrowser, until } from './pages.mjs';
import { startServer } from './server.mjs';

let browser;
before(async () => {
  browser = await startBrowser();
});
after(async () => {
  await browser?.close();
});

test('a page comes back by itself, where it was, when the server restarts', async (t) => {
  let server = await startServer();
  t.after(() => server.stop());
  const page = await openPage(t, browser, server.url);
  await connected(page);
  await drag(page, [0.5, 0.5], [0.7, 0.6]);
  await settled(page);
  const { frames } = await page.evaluate(() => window.brume);
  const picture = await pixels(page);

  assert.equal(await server.stop(), 0, 'the server’s exit');
  await until(page, 'it is reconnecting', (brume) => brume.state === 'reconnecting');
  await page.waitForSelector('[data-state=reconnecting]');
  assert.ok(difference(picture, await pixels(page)) < 20, 'the last picture stays');
  await drag(page, [0.5, 0.5], [0.4, 0.5]);
  const { camera } = await page.evaluate(() => window.brume);
  await page.waitForTimeout(2000);

  server = await startServer('--port', server.port);
  await until(page, 'pictures come again', (b, old) => b.state === 'connected' && b.frames > old, frames);
  await page.waitForSelector('[data-state=live]');
  assert.deepEqual(await page.evaluate(() => window.brume.camera), camera);
  await settled(page);
  await until(page, 'its latency is known', (brume) => brume.latency !== undefined);
  const { input } = await page.evaluate(() => window.brume.latency[99]);
  assert.ok(input < 1500, `${input} ms of input, most of which nobody was there to hear`);
  await page.leave();
  assert.equal(await server.stop(), 0, 'the server’s exit');
});

test('a page whose server is killed is back soon after the port opens', async (t) => {
  let server = await startServer();
  t.after(() => server.stop());
  const page = await openPage(t, browser, server.url);
  await connected(page);
  const killed = performance.now();
  assert.equal(await server.stop('SIGKILL'), 'SIGKILL');
  await until(page, 'it is reconnecting', (brume) => brume.state === 'reconnecting');
  const frames = await page.evaluate(() => window.brume.frames);
  server = await startServer('--port', server.port);
  const opened = performance.now();
  await until(page, 'pictures come again', (b, old) => b.state === 'connected' && b.frames > old, frames);
  const back = performance.now() - opened;
  t.diagnostic(`${Math.round(opened - killed)} ms without a server, back ${Math.round(back)} ms after`);
  // Tries are 1 s apart at most (backoff.ts), and a picture comes within another of the one that finds the server.
  assert.ok(back < 2000, `back after ${back} ms`);
  await page.leave();
  assert.equal(await server.stop(), 0, 'the server’s exit');
});

test('a full server refuses politely, and lets in who waits when there is room', async (t) => {
  const server = await startServer('--max-viewers', '1');
  t.after(() => server.stop());
  const first = await openPage(t, browser, server.url);
  await connected(first);
  const second = await openPage(t, browser, server.url);
  await until(second, 'it is refused', (brume) => brume.state === 'refused');
  assert.equal(await second.locator('#curtain-title').textContent(), 'All places are taken');
  assert.match(await second.locator('#curtain-wait').textContent(), /^Trying again/);
  assert.ok(await second.getByRole('button', { name: 'Try now' }).isVisible());
  assert.equal(await first.evaluate(() => window.brume.state), 'connected');
  await first.leave();
  await connected(second);
  await second.locator('#curtain-title').waitFor({ state: 'hidden' });
  await second.leave();
  assert.equal(await server.stop(), 0, 'the server’s exit');
});
