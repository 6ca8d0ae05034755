// Several servers: a page goes where its own sends it, and finds another behind a gateway. And what a page says while
// the scene stands still.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { startGateway } from './gateway.mjs';
import { startMock } from './mock.mjs';
import { connected, difference, drag, faded, openPage, pixels, settled, shown, startBrowser, until } from './pages.mjs';
import { startServer } from './server.mjs';

let browser;
before(async () => {
  browser = await startBrowser();
});
after(async () => {
  await browser?.close();
});

test('a page goes where a server that stops sends it, with its camera and its wishes', async (t) => {
  const next = await startServer();
  t.after(() => next.stop());
  const server = await startServer('--drain-time', '0', '--drain-to', `ws://127.0.0.1:${next.port}/ws`);
  t.after(() => server.stop());
  const page = await openPage(t, browser, `${server.url}/?predict=0`, { sentTo: next.url });
  await connected(page);
  await drag(page, [0.5, 0.5], [0.7, 0.6]);
  await settled(page);
  const { camera } = await page.evaluate(() => window.brume);
  assert.equal(await server.stop(), 0, 'the server’s exit');
  await page.waitForURL(`${next.url}/?predict=0`); // what it brought along has left the address bar
  await connected(page);
  assert.deepEqual(await page.evaluate(() => window.brume.camera), camera);
  await settled(page);
  await page.leave();
  assert.equal(await next.stop(), 0, 'the server’s exit');
});

test('a page comes back to its server when nobody is where it was sent', async (t) => {
  const sentTo = 'http://127.0.0.1:1/';
  let server = await startServer('--drain-time', '0', '--drain-to', sentTo);
  t.after(() => server.stop());
  const page = await openPage(t, browser, server.url, { sentTo });
  await connected(page);
  assert.equal(await server.stop(), 0, 'the server’s exit');
  await until(page, 'it is reconnecting', (brume) => brume.state === 'reconnecting');
  server = await startServer('--port', server.port);
  await connected(page);
  await page.leave();
  assert.equal(await server.stop(), 0, 'the server’s exit');
});

// How the view's link changed: its name, the milliseconds until the next try, the time on this machine's clock, and
// the pictures that came before.
const watchLink = (page) =>
  page.evaluate(() => {
    window.links = [];
    document.getElementById('view').addEventListener('statechange', ({ detail }) =>
      window.links.push({
        name: detail.name,
        wait: detail.retryAt - performance.now(),
        at: Date.now(),
        frames: window.brume.frames,
      }),
    );
  });

test('behind a gateway a page waits less than a second after its server was killed, and keeps its camera', async (t) => {
  const [one, two] = [await startServer(), await startServer('--set', 'camera.position=[9,9,9]')];
  t.after(() => one.stop());
  t.after(() => two.stop());
  const gateway = await startGateway(one.url, two.url);
  t.after(() => gateway.stop());
  const page = await openPage(t, browser, gateway.url);
  await connected(page);
  await drag(page, [0.5, 0.5], [0.7, 0.6]);
  await settled(page);
  await watchLink(page);
  const { camera } = await page.evaluate(() => window.brume);
  const killed = Date.now();
  assert.equal(await one.stop('SIGKILL'), 'SIGKILL');
  // A picture of the server that was killed may come late: only those after the other one's welcome count.
  await until(page, 'it is welcomed', () => window.links.some(({ name }) => name === 'connected'));
  const links = await page.evaluate(() => window.links);
  const welcome = links.find(({ name }) => name === 'connected');
  await until(page, 'pictures come again', (brume, before) => brume.frames > before, welcome.frames);
  t.diagnostic(`welcomed ${welcome.at - killed} ms after its server was killed`);
  // Its waits alone: how long a welcome takes, a tenth of a second where nothing else runs, is the machine's matter.
  const waited = links.reduce((sum, { wait }) => sum + (wait > 0 ? wait : 0), 0);
  assert.ok(waited > 0 && waited < 1000, `it waited ${waited} ms`);
  assert.deepEqual(await page.evaluate(() => window.brume.camera), camera, 'nobody knows this viewer there');
  await settled(page);
  await page.leave();
  assert.equal(await two.stop(), 0, 'the server’s exit');
});

test('a page behind a gateway without a server keeps its picture, and blames no version', async (t) => {
  const one = await startServer();
  t.after(() => one.stop());
  const port = one.port;
  const gateway = await startGateway(one.url);
  t.after(() => gateway.stop());
  const page = await openPage(t, browser, gateway.url);
  await connected(page);
  await watchLink(page);
  assert.equal(await one.stop('SIGKILL'), 'SIGKILL');
  const tries = () => page.evaluate(() => window.links.filter(({ name }) => name !== 'connected').length);
  for (const deadline = Date.now() + 30_000; (await tries()) < 12; )
    assert.ok(Date.now() < deadline, 'it goes on trying');
  assert.deepEqual([...new Set(await page.evaluate(() => window.links.map(({ name }) => name)))], ['reconnecting']);
  const again = await startServer('--port', port);
  t.after(() => again.stop());
  await connected(page);
  await page.leave();
  assert.equal(await again.stop(), 0, 'the server’s exit');
});

test('a scene that stands still says so until ticks come again, and covers no picture', async (t) => {
  const mock = await startMock();
  t.after(() => mock.stop());
  const page = await openPage(t, browser, mock.url, { viewport: { width: 900, height: 506 } });
  await connected(page);
  await settled(page);
  await faded(page); // the curtain
  const line = page.getByRole('status').filter({ hasText: 'The scene stands still' });
  assert.equal(await line.count(), 0);
  await mock.does({ standstill: 'no word from the log' });
  await line.waitFor();
  assert.equal(await line.textContent(), 'The scene stands still: no word from the log.');
  assert.equal(await page.locator('#standstill').getAttribute('aria-live'), 'polite');
  await page.locator('#status-text', { hasText: /^Standing still$/ }).waitFor();
  const covered = await page.evaluate(() => {
    const { top, bottom, left, right } = document.querySelector('#standstill .note').getBoundingClientRect();
    const inside = top >= 0 && left >= 0 && right <= window.innerWidth;
    return { inside, middle: bottom > window.innerHeight / 4, hit: document.elementFromPoint(left + 9, top + 9).id };
  });
  assert.deepEqual(covered, { inside: true, middle: false, hit: 'view' }, 'a strip at the top, which takes no clicks');

  // It stays, longer than a note, and takes another reason; what is pushed meanwhile is refused in a note.
  await mock.does({ standstill: 'two of three stores are away' });
  await line.filter({ hasText: 'two of three stores are away.' }).waitFor();
  await page.keyboard.down('Control');
  await drag(page, [0.4, 0.5], [0.6, 0.5]);
  await page.keyboard.up('Control');
  const note = page.locator('#toasts .note', { hasText: 'Too many commands wait for their tick.' });
  await note.waitFor();
  await note.waitFor({ state: 'detached' });
  assert.equal(await line.count(), 1);
  const below = difference(await pixels(page), await shown(page));
  assert.ok(below < 2, `the picture stays as it was: it differs by ${below}`);

  await mock.does({ standstill: '' });
  await line.waitFor({ state: 'detached' });
  await page.locator('#status-text').filter({ hasNotText: 'Standing still' }).waitFor();
  await page.leave();
});

test('a frame of the view alone says that the scene stands still', async (t) => {
  const mock = await startMock();
  t.after(() => mock.stop());
  const page = await openPage(t, browser, `${mock.url}/embed.html`);
  await connected(page);
  await mock.does({ standstill: 'no word from the log' });
  const line = page.getByText('The scene stands still: no word from the log.');
  await line.waitFor();
  await mock.does({ standstill: '' });
  await line.waitFor({ state: 'hidden' });
  await page.leave();
});
