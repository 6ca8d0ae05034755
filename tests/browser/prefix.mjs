// The page below a prefix that a proxy takes away, in a real Chromium: node tests/browser/prefix.mjs
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { randomBytes } from 'node:crypto';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { connected, drag, openPage, settled, startBrowser } from './pages.mjs';
import { startProxy } from './proxy.mjs';
import { BINARY, startServer } from './server.mjs';

const DEEP = '/clouds/brume/';
const ROOM = '/r/demo/';
const PAGE = `<!doctype html><title>A page of the same host</title>
  <style>brume-view, iframe, img { display: block; width: 300px; height: 170px }</style>
  <brume-view src="/clouds/brume"></brume-view>
  <iframe src="${DEEP}embed.html?controls=look"></iframe>
  <img src="${DEEP}snapshot.jpg?w=64&h=36">
  <script type="module" src="${DEEP}brume-view.js"></script><script>window.brume = {}</script>`;

let browser, server, proxy;
before(async () => {
  browser = await startBrowser();
  server = await startServer();
  proxy = await startProxy(server.url, [DEEP, ROOM], { '/page.html': PAGE });
});
after(async () => {
  await browser?.close();
  proxy?.stop();
  if (server) assert.equal(await server.stop(), 0, 'the server’s exit');
});

for (const prefix of [DEEP, ROOM])
  test(`at ${prefix} all of the page is found: files, socket, scene file, link`, async (t) => {
    const page = await openPage(t, browser, `${proxy.url}${prefix}`, {
      permissions: ['clipboard-read', 'clipboard-write'],
    });
    await connected(page);
    await settled(page);
    await page.locator('#tool-panel').click();
    const [file] = await Promise.all([
      page.waitForEvent('download'),
      page.getByRole('button', { name: 'Save TOML' }).click(),
    ]);
    assert.match(file.suggestedFilename(), /\.toml$/);
    await page.locator('#tool-panel').click();
    await page.locator('#tool-link').click();
    await page.getByText('A link with this camera was copied.').waitFor();
    const link = await page.evaluate(() => navigator.clipboard.readText());
    assert.ok(link.startsWith(`${proxy.url}${prefix}?position=`), link);
    await drag(page, [0.5, 0.5], [0.7, 0.5]);
    await settled(page);
    const { camera } = await page.evaluate(() => window.brume);
    await page.reload();
    await connected(page);
    assert.deepEqual(await page.evaluate(() => window.brume.camera), camera, 'the tab keeps its camera');
    await page.leave();
    assert.deepEqual(proxy.astray, []);
  });

test('element, frame and snapshot work in a page of the same host', async (t) => {
  const page = await openPage(t, browser, `${proxy.url}/page.html`);
  await page.waitForFunction(() => document.querySelector('brume-view').report?.frames > 2, null, { polling: 50 });
  const inner = page.frames()[1];
  await inner.waitForFunction(() => window.brume?.frames > 2, null, { polling: 50 });
  await page.waitForFunction(() => document.querySelector('img').naturalWidth === 64, null, { polling: 50 });
  await page.leave();
  assert.deepEqual(proxy.astray, []);
});

test('the medium in another program’s scene works there, too', async (t) => {
  const page = await openPage(t, browser, `${proxy.url}${DEEP}three.html`, { script: 'window.brume = {}' });
  for (const deadline = Date.now() + 60_000; ; ) {
    const { viewers } = await (await fetch(`${server.url}/viewers`)).json();
    if (viewers.length > 0) break;
    assert.ok(Date.now() < deadline, 'it connects');
    await page.waitForTimeout(50);
  }
  await page.leave();
  assert.deepEqual(proxy.astray, []);
});

test('two servers of one host do not get each other’s tokens', async (t) => {
  const folder = mkdtempSync(join(tmpdir(), 'brume-'));
  t.after(() => rmSync(folder, { recursive: true }));
  const key = join(folder, 'token.key');
  writeFileSync(key, randomBytes(32), { mode: 0o600 });
  const locked = await startServer('--token-key', key);
  t.after(() => locked.stop());
  const both = await startProxy(locked.url, ['/one/', '/two/']);
  t.after(() => both.stop());
  const token = execFileSync(BINARY, ['--token-key', key, '--make-token', 'viewer', '--valid-for', '600'])
    .toString()
    .trim();
  const page = await openPage(t, browser, `${both.url}/one/#token=${token}`);
  await connected(page);
  await page.goto(`${both.url}/two/`);
  await page.waitForSelector('[data-state=refused]');
  await page.goto(`${both.url}/one/`);
  await connected(page);
  await page.leave();
});
