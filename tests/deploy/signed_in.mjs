// The page of somebody who has signed in, in a real Chromium; oidc_test.py starts what it needs.
// node signed_in.mjs URL ISSUER FOLDER: the page, the provider, and the folder of both
import assert from 'node:assert/strict';
import { readdirSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { argv } from 'node:process';
import { after, before, test } from 'node:test';
import { another, connected, openPage, startBrowser, until } from '../browser/pages.mjs';

const [url, issuer, folder] = argv.slice(2);
const LASTS_S = '2'; // of a token
const SKIP = process.env.BRUME_TESTS !== 'whole' && 'two more pages: BRUME_TESTS=whole';
const HARM = '<img src=x onerror=harm=1>'; // names of people have at most 32 characters
const comes = (name) =>
  writeFileSync(join(folder, 'person.json'), JSON.stringify({ preferred_username: name, groups: [] }));
const enter = (t, browser) => openPage(t, browser, `${url}/?token_url=/token`, { sentTo: issuer });

let browser;
before(async () => {
  browser = await startBrowser();
});
after(() => browser?.close());

test('a page outlives its token, and says in one line that nobody is signed in any more', async (t) => {
  comes('ann');
  writeFileSync(join(folder, 'short'), LASTS_S);
  t.after(() => rmSync(join(folder, 'short'), { force: true }));
  const page = await enter(t, browser);
  await connected(page);
  assert.equal(page.url(), `${url}/?token_url=/token`);
  await page.waitForResponse((response) => new URL(response.url()).pathname === '/token' && response.ok());
  await connected(page);
  await another(page, 2);

  const cache = join(folder, 'cache');
  for (const file of readdirSync(cache)) rmSync(join(cache, file)); // all sessions have ended
  await until(page, 'it is refused', (brume) => brume.state === 'refused');
  const line = page.locator('#curtain-text');
  assert.equal(await line.textContent(), 'Your sign-in has ended: load this page again to sign in.');
  rmSync(join(folder, 'short'));
  await Promise.all([page.waitForEvent('load'), page.getByRole('button', { name: 'Load again' }).click()]);
  await connected(page);
  assert.equal(page.url(), `${url}/?token_url=/token`);
  await page.leave();
});

test('a name is text', { skip: SKIP }, async (t) => {
  comes('ann');
  const page = await enter(t, browser);
  await connected(page);
  comes(HARM);
  const other = await enter(t, browser);
  await connected(other);
  await until(page, 'the other is there', (_, name) => document.body.textContent.includes(name), HARM, 30_000);
  for (const one of [page, other]) {
    assert.equal(await one.evaluate(() => window.harm), undefined);
    assert.equal(await one.locator('img[src=x]').count(), 0);
    await one.leave();
  }
});
