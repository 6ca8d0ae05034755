// The page behind an nginx as it comes, and behind one with our files, in a real Chromium: node tests/browser/behind.mjs
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { connected, openPage, settled, startBrowser, until } from './pages.mjs';
import { startServer } from './server.mjs';

const FILES = fileURLToPath(new URL('../../deploy/nginx/', import.meta.url));
const NGINX = ['nginx', '/usr/sbin/nginx'].find((name) => spawnSync(name, ['-v']).status === 0);
const skip = NGINX === undefined && 'nginx is missing: apt-get install nginx';

const freePort = () =>
  new Promise((resolve) => {
    const listener = createServer().listen(0, '127.0.0.1', () => {
      const { port } = listener.address();
      listener.close(() => resolve(port));
    });
  });

// nginx with that text in its http { }; it answers when this resolves.
async function startNginx(t, url, text) {
  const folder = mkdtempSync(join(tmpdir(), 'brume-'));
  const paths = ['client_body', 'proxy', 'fastcgi', 'uwsgi', 'scgi'].map((it) => `${it}_temp_path ${folder}/${it};`);
  writeFileSync(join(folder, 'brume.location'), readFileSync(join(FILES, 'brume.location')));
  writeFileSync(
    join(folder, 'nginx.conf'),
    `daemon off; pid ${folder}/pid; events {} http { access_log off; ${paths.join(' ')} ${text} }`,
  );
  const child = spawn(NGINX, ['-e', 'stderr', '-p', folder, '-c', join(folder, 'nginx.conf')], { stdio: 'inherit' });
  const ended = new Promise((resolve) => child.once('exit', resolve));
  t.after(async () => {
    child.kill();
    await ended;
    rmSync(folder, { recursive: true });
  });
  for (const deadline = Date.now() + 20_000; ; ) {
    if (
      await fetch(`${url}/`).then(
        (answer) => answer.ok,
        () => false,
      )
    )
      return;
    assert.ok(Date.now() < deadline && child.exitCode === null, 'nginx starts');
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

describe('nginx', { skip }, () => {
  let browser, server;
  before(async () => {
    browser = await startBrowser();
    server = await startServer('--open');
  });
  after(async () => {
    await browser?.close();
    if (server) assert.equal(await server.stop(), 0, 'the server’s exit');
  });

  for (const [what, more, said] of [
    [
      'proxy_pass alone',
      '',
      'The proxy in front of this server does not pass the Host header (nor, perhaps, WebSockets) on',
    ],
    [
      'and the host',
      'proxy_set_header Host $http_host;',
      'The proxy in front of this server does not pass WebSockets on',
    ],
  ])
    test(`${what}: the page says what is wrong in one line, and stops trying`, async (t) => {
      const port = await freePort();
      const url = `http://127.0.0.1:${port}`;
      await startNginx(t, url, `server { listen 127.0.0.1:${port}; location / { proxy_pass ${server.url}; ${more} } }`);
      const page = await openPage(t, browser, url);
      await until(page, 'it has given up', (brume) => brume.state === 'refused');
      const text = () => page.locator('#curtain-text').textContent();
      assert.equal(await text(), `${said}: see docs/deploy.md.`);
      await page.locator('#curtain-wait').waitFor({ state: 'hidden' });
      const lost = () => server.output().split('does not pass WebSockets on').length;
      const before = lost();
      assert.ok(before > 1, 'the log says so, too');
      await page.waitForTimeout(2000);
      assert.equal(lost(), before, 'no more tries');
      await page.getByRole('button', { name: 'Try now' }).click();
      for (const deadline = Date.now() + 10_000; lost() === before; ) {
        assert.ok(Date.now() < deadline, 'a try when it is asked for');
        await page.waitForTimeout(50);
      }
      assert.equal(await text(), `${said}: see docs/deploy.md.`);
      await page.leave();
    });

  test('with our files: pictures come, also below the prefix', async (t) => {
    const port = await freePort();
    const url = `http://127.0.0.1:${port}`;
    let text = readFileSync(join(FILES, 'brume.conf'), 'utf8');
    for (const [given, ours] of [
      ['127.0.0.1:8080', new URL(server.url).host],
      ['listen 80;', `listen 127.0.0.1:${port};`],
      ['listen [::]:80;', ''],
      ['access_log /var/log/nginx/brume.log brume;', ''],
      ['error_log /var/log/nginx/brume-error.log crit;', ''],
    ])
      text = text.replace(given, ours);
    await startNginx(t, url, text);
    for (const path of ['/', '/clouds/brume/']) {
      const page = await openPage(t, browser, url + path);
      await connected(page);
      await settled(page);
      await page.leave();
    }
  });
});
