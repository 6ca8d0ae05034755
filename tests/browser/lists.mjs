// Fogs and lights of the scene in the panel: added, changed and removed for everyone.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { connected, difference, openPage, rested, shown, startBrowser, until } from './pages.mjs';
import { startServer } from './server.mjs';

const PATIENCE_MS = 60_000; // a driver compiles shaders for the first fog

let browser, server;
before(async () => {
  browser = await startBrowser();
  server = await startServer('--set', 'simulation.paused=true', '--set', 'medium.count=50');
});
after(async () => {
  await browser?.close();
  assert.equal(await server?.stop(), 0, 'the server’s exit');
});

// A page with the group of a list open.
async function openList(t, title) {
  const page = await openPage(t, browser, server.url, { viewport: { width: 800, height: 600 } });
  await connected(page);
  await page.locator('#tool-panel').click();
  const group = page.locator('#panel details').filter({ has: page.getByText(title, { exact: true }) });
  await group.locator('summary').click();
  return { page, group };
}

test('a fog is added, changed and removed, and everyone sees it', async (t) => {
  const { page, group } = await openList(t, 'Fogs');
  const other = await openList(t, 'Fogs');
  const extinction = group.getByRole('slider', { name: 'Extinction' });
  const others = other.group.getByRole('slider', { name: 'Extinction' });
  assert.equal(await extinction.count(), 0, 'there is none yet');
  assert.ok(await group.getByRole('button', { name: 'Remove' }).isDisabled());
  await rested(page);
  const bare = await shown(page);

  await group.getByRole('button', { name: 'Add' }).click();
  await others.waitFor({ timeout: PATIENCE_MS });
  await extinction.waitFor();
  const ofTheState = (brume) => brume.lastFrame.stateHash === brume.scene.stateHash;
  await until(page, 'the picture has it', ofTheState, undefined, PATIENCE_MS);
  await rested(page);
  assert.ok(difference(await shown(page), bare) > 2, 'it is seen');

  await extinction.fill('0.5');
  await others.and(other.page.locator('[aria-valuetext="0.500"]')).waitFor();
  await group.getByRole('button', { name: 'Remove' }).click();
  await others.waitFor({ state: 'hidden' });
  await extinction.waitFor({ state: 'hidden' });
  await other.page.leave();
  await page.leave();
});

test('of several lights one is chosen; a point has no cone, and a spot has', async (t) => {
  const { page, group } = await openList(t, 'Lights');
  const add = group.getByRole('button', { name: 'Add' });
  const which = group.getByRole('combobox', { name: 'Light' });
  const type = group.getByRole('combobox', { name: 'Type' });
  const cone = group.getByRole('slider', { name: 'Outer' });
  await add.click();
  await which.locator('option[value="0"]').waitFor({ state: 'attached', timeout: PATIENCE_MS });
  await add.click();
  await which.locator('option[value="1"]').waitFor({ state: 'attached', timeout: PATIENCE_MS });
  assert.equal(await which.inputValue(), '1', 'the new one is chosen');
  assert.ok(await cone.isHidden());
  await type.selectOption('spot');
  await cone.waitFor();
  assert.deepEqual(await which.locator('option').allTextContents(), ['1 point', '2 spot']);
  await which.selectOption('0');
  await cone.waitFor({ state: 'hidden' });
  assert.equal(await type.inputValue(), 'point');
  await group.getByRole('button', { name: 'Remove' }).click();
  await cone.waitFor(); // the spot moved up
  assert.deepEqual(await which.locator('option').allTextContents(), ['1 spot']);
  await page.leave();
});
