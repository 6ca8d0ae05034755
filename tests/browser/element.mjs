// <brume-view> in pages of other people: two of them on one page, as npm packs it, and the view alone in a frame.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { IS_FIREFOX } from './browsers.mjs';
import { drag, openPage, startBrowser } from './pages.mjs';
import { startServer } from './server.mjs';

const WEB = fileURLToPath(new URL('../../client/web/', import.meta.url));

// A page elsewhere, with `body`; /brume-view.js is the packed library.
async function startSite(library) {
  const site = { body: '' };
  const http = createServer((request, response) => {
    const script = request.url === '/brume-view.js';
    response.setHeader('content-type', script ? 'text/javascript' : 'text/html; charset=utf-8');
    response.end(script ? library : `<!doctype html><title>Elsewhere</title>${site.body}`);
  });
  await new Promise((resolve) => http.listen(0, '127.0.0.1', resolve));
  site.url = `http://127.0.0.1:${http.address().port}`;
  site.stop = () => http.close();
  return site;
}

const TWO = (server) => `
  <style>body { margin: 0; display: flex } brume-view { flex: 1; height: 225px }</style>
  <brume-view id="left" src="${server}/" position="0,6,26" target="0,0,0"></brume-view>
  <brume-view id="right" src="${server}/" position="26,6,0" target="0,0,0" fov="0.5" controls="look"></brume-view>
  <script type="module" src="/brume-view.js"></script>
  <script>
    window.brume = {}; // openPage asks for it; the element itself leaves no global behind
    window.heard = [];
    for (const view of document.querySelectorAll('brume-view'))
      for (const name of ['welcome', 'picture', 'note'])
        view.addEventListener(name, ({ detail }) => window.heard.push([view.id, name, detail.text]));
  </script>`;

let browser, folder, library, site, server;
before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'brume-'));
  execFileSync('npm', ['pack', '--silent', '--pack-destination', folder], { cwd: WEB });
  const [packed] = readdirSync(folder);
  execFileSync('tar', ['xzf', join(folder, packed), '-C', folder]);
  library = readFileSync(join(folder, 'package/dist/brume-view.js'));
  site = await startSite(library);
  browser = await startBrowser();
  server = await startServer('--allow-origin', site.url);
});
after(async () => {
  await browser?.close();
  site?.stop();
  if (server) assert.equal(await server.stop(), 0, 'the server’s exit');
  if (folder) rmSync(folder, { recursive: true });
});

const elsewhere = async (t, body, options = {}) => {
  site.body = body;
  return openPage(t, browser, site.url, { sentTo: server.url, ...options });
};
const both = (page) =>
  page.waitForFunction(
    () => [...document.querySelectorAll('brume-view')].every((view) => view.report?.frames > 2),
    null,
    { polling: 50 },
  );
const cameras = (page) =>
  page.evaluate(() => [...document.querySelectorAll('brume-view')].map((view) => view.report.camera));

test('its types are enough for a program that uses it', () => {
  const program = join(folder, 'program.ts');
  writeFileSync(
    program,
    `import { BrumeView } from 'brume-web';
    const view: BrumeView = document.createElement('brume-view');
    view.setAttribute('src', 'https://clouds.example/');
    view.addEventListener('picture', ({ detail }) => console.log(detail.frame.width, detail.latency?.total));
    view.addEventListener('note', ({ detail }) => console.log(detail.text.length));
    view.addEventListener('pointerdown', (event) => console.log(event.clientX));
    document.body.append(view);`,
  );
  execFileSync('mkdir', ['-p', join(folder, 'node_modules')]);
  execFileSync('ln', ['-sfn', join(folder, 'package'), join(folder, 'node_modules/brume-web')]);
  const flags = ['--noEmit', '--strict', '--target', 'es2022', '--module', 'esnext', '--moduleResolution', 'bundler'];
  execFileSync(join(WEB, 'node_modules/.bin/tsc'), [...flags, '--lib', 'es2022,dom,dom.iterable', program], {
    stdio: ['ignore', 'inherit', 'inherit'],
  });
});

describe('two on one page of another origin', () => {
  test('are two viewers, each with its own view', async (t) => {
    const page = await elsewhere(t, TWO(server.url));
    await both(page);
    const seen = await page.evaluate(() =>
      [...document.querySelectorAll('brume-view')].map(({ report }) => [report.viewer, report.lastFrame.fovY]),
    );
    assert.notEqual(seen[0][0], seen[1][0]);
    assert.ok(Math.abs(seen[0][1] - 0.8) < 1e-6 && Math.abs(seen[1][1] - 0.5) < 1e-6, JSON.stringify(seen));
    const [left, right] = await cameras(page);
    assert.deepEqual(
      [left.position, right.position],
      [
        [0, 6, 26],
        [26, 6, 0],
      ],
    );
    const heard = await page.evaluate(() => window.heard.map(([id, name]) => `${id} ${name}`));
    for (const id of ['left', 'right'])
      for (const name of ['welcome', 'picture']) assert.ok(heard.includes(`${id} ${name}`), `${id} ${name}`);
    await page.leave();
  });

  test('mouse and keys move the one that they are for', async (t) => {
    const page = await elsewhere(t, TWO(server.url));
    await both(page);
    const before = await cameras(page);
    await drag(page, [0.2, 0.5], [0.3, 0.5]);
    const dragged = await cameras(page);
    assert.notEqual(dragged[0].yaw, before[0].yaw, 'a drag turns the one that it is in');
    assert.deepEqual(dragged[1], before[1]);
    await page.mouse.click(300, 112); // the right one has the keys now
    await page.keyboard.press('ArrowLeft', { delay: 200 });
    const turned = await cameras(page);
    assert.deepEqual(turned[0], dragged[0]);
    assert.notEqual(turned[1].yaw, before[1].yaw, 'a key turns the one that was pressed last');
    assert.equal(await page.evaluate(() => document.activeElement.id), 'right');
    await page.leave();
  });

  test('attributes change it while it runs; without its src it leaves', async (t) => {
    const page = await elsewhere(t, TWO(server.url));
    await both(page);
    const viewers = async () => (await (await fetch(`${server.url}/viewers`)).json()).viewers.length;
    assert.equal(await viewers(), 2);
    await page.evaluate(() => {
      const left = document.getElementById('left');
      left.setAttribute('position', '1,2,30');
      left.setAttribute('eyes', 'side');
    });
    await page.waitForFunction(
      () => {
        const { lastFrame, camera } = document.getElementById('left').report;
        return lastFrame.views === 2 && camera.position[2] === 30;
      },
      null,
      { polling: 50 },
    );
    await page.evaluate(() => document.getElementById('left').setAttribute('position', 'here'));
    const note = await page.evaluate(() => window.heard.find(([, name]) => name === 'note'));
    assert.match(note[2], /^position takes three numbers/);
    const line = (change) =>
      page.evaluate((change) => {
        const left = document.getElementById('left');
        for (const [name, value] of Object.entries(change)) left.setAttribute(name, value);
        const { hidden, textContent } = left.shadowRoot.querySelector('.message');
        return hidden ? '' : textContent;
      }, change);
    assert.match(await line({ size: 'wide' }), /^position takes three numbers.* size takes width and height/);
    assert.match(await line({ position: '1,2,30' }), /^size takes width and height/);
    assert.equal(await line({ size: '640x360' }), '');
    await page.evaluate(() => document.getElementById('left').removeAttribute('src'));
    await page.evaluate(() => document.getElementById('right').remove());
    for (const deadline = Date.now() + 30_000; (await viewers()) > 0; ) assert.ok(Date.now() < deadline, 'both leave');
    await page.leave();
  });
});

test('its script comes from the server itself, to a page of an allowed origin', async (t) => {
  const body = `<script>window.brume = {};</script>
    <brume-view src="${server.url}/"></brume-view>
    <script type="module" src="${server.url}/brume-view.js"></script>`;
  const page = await elsewhere(t, body);
  await both(page);
  await page.leave();
});

test('controls="none" leaves wheel, touch and keys to the page', async (t) => {
  const view = `<brume-view src="${server.url}/" controls="none" style="height: 225px"></brume-view>
    <script type="module" src="/brume-view.js"></script><script>window.brume = {}</script><p style="height: 2000px">`;
  const page = await elsewhere(t, view);
  await both(page);
  const before = await cameras(page);
  await drag(page, [0.2, 0.5], [0.6, 0.5]);
  await page.mouse.wheel(0, 100);
  await page.waitForFunction(() => scrollY > 50, null, { polling: 50 });
  assert.deepEqual(await cameras(page), before);
  await page.leave();
});

test('nothing is drawn for one that is scrolled out of the window', async (t) => {
  const page = await elsewhere(
    t,
    `<brume-view src="${server.url}/" style="height: 200px"></brume-view><p style="height: 3000px">
     <script type="module" src="/brume-view.js"></script><script>window.brume = {}</script>`,
  );
  await both(page);
  const told = async (name) => {
    const text = await (await fetch(`${server.url}/metrics`)).text();
    return Number(
      text
        .split('\n')
        .find((line) => line.startsWith(`${name} `))
        ?.split(' ')[1],
    );
  };
  const rendered = () => told('brume_frames_total{fate="rendered"}');
  await page.evaluate(() => scrollTo(0, 2000));
  for (const deadline = Date.now() + 30_000; ; ) {
    const [frames, ticks] = [await rendered(), await told('brume_tick_seconds_count')];
    while ((await told('brume_tick_seconds_count')) < ticks + 60) await page.waitForTimeout(50);
    if ((await rendered()) === frames) break;
    assert.ok(Date.now() < deadline, 'a second without a frame');
  }
  const { frames } = await page.evaluate(() => ({ frames: document.querySelector('brume-view').report.frames }));
  await page.evaluate(() => scrollTo(0, 0));
  await page.waitForFunction((old) => document.querySelector('brume-view').report.frames > old + 5, frames, {
    polling: 50,
  });
  await page.leave();
});

test('it says so when the server is away, and goes on when it is back', async (t) => {
  let own = await startServer('--allow-origin', site.url);
  t.after(() => own.stop());
  const { port } = own;
  const page = await elsewhere(
    t,
    `<brume-view src="${own.url}/"></brume-view><script type="module" src="/brume-view.js"></script>
     <style>brume-view { height: 200px }</style><script>window.brume = {}</script>`,
    { sentTo: own.url },
  );
  await both(page);
  const message = page.locator('brume-view .message');
  assert.ok(await message.isHidden());
  await own.stop('SIGKILL');
  await message.filter({ hasText: 'Reconnecting…' }).waitFor();
  own = await startServer('--allow-origin', site.url, '--port', port);
  await message.waitFor({ state: 'hidden' });
  await page.leave();
});

describe('the view alone in a frame', () => {
  const frame = (query) =>
    `<iframe src="${server.url}/embed.html?${query}" style="width: 380px; height: 200px; border: 0"></iframe>
     <script>window.brume = {}</script>`;

  test('of an allowed origin shows the cloud from where it is asked to', async (t) => {
    const page = await elsewhere(t, frame('position=5,6,20&target=0,1,0&controls=look'));
    const inner = page.frames()[1];
    await inner.waitForFunction(() => window.brume?.frames > 2, null, { polling: 50 });
    const { camera, width } = await inner.evaluate(() => ({
      camera: window.brume.camera,
      width: window.brume.lastFrame.width,
    }));
    assert.deepEqual(camera.position, [5, 6, 20]);
    assert.ok(width > 200, `a picture ${width} pixels wide`);
    await page.leave();
  });

  test('of any other origin is refused by the browser', async (t) => {
    const stranger = await startSite(library);
    t.after(() => stranger.stop());
    stranger.body = frame('');
    const context = await browser.newContext();
    t.after(() => context.close());
    const page = await context.newPage();
    const refused = page.waitForEvent(IS_FIREFOX ? 'pageerror' : 'console', (told) =>
      (told.message ?? told.text()).includes('frame-ancestors'),
    );
    await page.goto(stranger.url);
    await refused;
    assert.equal((await (await fetch(`${server.url}/viewers`)).json()).viewers.length, 0);
  });
});

describe('an <img> of the stream', () => {
  // 64 where a picture came, 0 where the browser refused it.
  const widthOf = async (t, { url }) => {
    site.body = `<img src="${url}/stream.mjpg?w=64&h=36">`;
    const context = await browser.newContext();
    t.after(() => context.close());
    const page = await context.newPage();
    await page.goto(site.url, { waitUntil: 'commit' });
    const width = await page.waitForFunction(
      () => {
        const image = document.querySelector('img');
        return image && (image.naturalWidth > 0 || image.complete) && { is: image.naturalWidth };
      },
      null,
      { polling: 50 },
    );
    return (await width.jsonValue()).is;
  };

  test('shows it in a page of an allowed origin', async (t) => {
    assert.equal(await widthOf(t, server), 64);
  });

  test('shows nothing in a page of any other, also of the same host', async (t) => {
    const own = await startServer();
    t.after(() => own.stop());
    assert.equal(await widthOf(t, own), 0);
  });
});
