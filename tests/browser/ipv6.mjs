// Page and clients over IPv6: node tests/browser/ipv6.mjs
import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { networkInterfaces } from 'node:os';
import { dirname, join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { promisify } from 'node:util';
import { connected, openPage, settled, startBrowser } from './pages.mjs';
import { BINARY, startServer } from './server.mjs';

const there = Object.values(networkInterfaces()).some((all) => all.some(({ address }) => address === '::1'));
const client = (url) =>
  promisify(execFile)(join(dirname(BINARY), 'brume-client'), [
    ...['--url', url, '--headless', '--frames', '2', '--size', '160x90', '--no-save', '--no-reconnect'],
  ]);

describe('over IPv6', { skip: !there && 'this machine has no ::1' }, () => {
  let browser;
  before(async () => {
    browser = await startBrowser();
  });
  after(() => browser?.close());

  for (const listen of ['::1', '::'])
    test(`--listen ${listen}: page, native client and snapshot at http://[::1]:PORT/`, async (t) => {
      const server = await startServer('--listen', listen, ...(listen === '::' ? ['--open'] : []));
      t.after(() => server.stop());
      assert.equal(server.url, `http://[${listen}]:${server.port}`);
      const url = `http://[::1]:${server.port}/`;
      const page = await openPage(t, browser, url);
      await connected(page);
      await settled(page);
      await page.leave();
      assert.equal((await fetch(`${url}snapshot.jpg?w=64&h=36`)).status, 200);
      await client(url);
      await client(url.replace('http', 'ws'));
      assert.match(server.output(), /viewer \d+: brume-client .* from ::1,/);
      if (listen === '::') {
        await client(`http://127.0.0.1:${server.port}/`);
        assert.match(server.output(), /viewer \d+: brume-client .* from 127\.0\.0\.1,/, 'as every log has it');
      }
      assert.equal(await server.stop(), 0, 'the server’s exit');
    });
});
