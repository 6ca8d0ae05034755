// Fogs and lights of the scene in the panel: added, changed and removed for everyone.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { connected, difference, faded, openPage, rested, shown, startBrowser, until } from './pages.mjs';
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
  assert.equal(await group.getByRole('button', { name: 'Add' }).getAttribute('title'), 'Another fog, for everyone');
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

test('a light is dragged in the picture, and the server moves it', async (t) => {
  const { page, group } = await openList(t, 'Lights');
  const which = group.getByRole('combobox', { name: 'Light' });
  const count = (await which.locator('option').count()) + 1;
  for (const added of [count - 1, count]) {
    await group.getByRole('button', { name: 'Add' }).click();
    await which.locator(`option[value="${added}"]`).waitFor({ state: 'attached', timeout: PATIENCE_MS });
  }
  const handle = page.getByRole('button', { name: new RegExp(`^(Move|Choose) light ${count + 1}$`) });
  await handle.waitFor();
  await faded(page);
  const camera = await page.evaluate(() => window.brume.camera);

  const middle = async () => {
    const { x, y, width, height } = await handle.boundingBox();
    return [x + width / 2, y + height / 2];
  };
  // The panel's fields show what the server reports.
  const position = () =>
    Promise.all(
      ['x', 'y', 'z'].map(async (axis) =>
        Number(await group.getByRole('slider', { name: `Position ${axis}` }).getAttribute('aria-valuetext')),
      ),
    );
  // Once two reports in a row say the same, other than `before`.
  const movedFrom = async (before) => {
    let last = before;
    for (let tries = 0; tries < 40; ++tries, await page.waitForTimeout(1000)) {
      const now = await position();
      if (String(now) === String(last) && String(now) !== String(before)) return now;
      last = now;
    }
    throw new Error(`the light stays at ${before}`);
  };
  const dragBy = async (dx, dy) => {
    const [x, y] = await middle();
    await page.mouse.move(x, y);
    await page.mouse.down();
    for (let i = 1; i <= 10; ++i) {
      await page.mouse.move(x + (dx * i) / 10, y + (dy * i) / 10);
      await page.waitForTimeout(16);
    }
    await page.mouse.up();
    return [x + dx, y + dy];
  };
  const near = ([x, y], [toX, toY]) => Math.hypot(x - toX, y - toY) < 3;

  const start = await position();
  const cursor = await dragBy(-160, 60);
  assert.ok(near(await middle(), cursor), 'the handle is below the cursor');
  const aside = await movedFrom(start);
  assert.ok(aside[0] < start[0] - 1 && aside[1] < start[1] - 0.3, `to the left and down: ${start} to ${aside}`);
  assert.ok(near(await middle(), cursor), 'it stays there when the server has told where it is');

  await page.keyboard.down('Shift');
  await dragBy(0, -80);
  await page.keyboard.up('Shift');
  const behind = await movedFrom(aside);
  assert.ok(behind[2] < aside[2] - 1, `away from the camera: ${aside} to ${behind}`);
  assert.ok(near(await middle(), cursor), 'on the line of sight');

  await handle.press('ArrowRight');
  const stepped = await movedFrom(behind);
  assert.ok(stepped[0] > behind[0], `to the right: ${behind} to ${stepped}`);
  assert.deepEqual(await page.evaluate(() => window.brume.camera), camera, 'the camera stays');

  // Neither the cursor nor keys bring it under the tools, where nobody could take hold of it.
  const bar = await page.locator('#bar').boundingBox();
  const onTop = ([x, y]) => page.evaluate((at) => document.elementFromPoint(...at)?.className, [x, y]);
  const [x, y] = await middle();
  await dragBy(bar.x + bar.width / 2 - x, bar.y + bar.height / 2 - y);
  assert.match(await onTop(await middle()), /\bhandle\b/, 'after a drag');
  for (let i = 0; i < 12; ++i) await handle.press('ArrowDown');
  assert.match(await onTop(await middle()), /\bhandle\b/, 'after keys');
  assert.ok((await middle())[1] > y + 20, 'it has come near them');
  await movedFrom(stepped);

  // The others are dots, which choose.
  await page.getByRole('button', { name: `Choose light ${count}` }).click();
  await page.getByRole('button', { name: `Move light ${count}`, exact: true }).waitFor();
  assert.equal(await which.inputValue(), String(count - 1));

  await group.locator('summary').click();
  await handle.waitFor({ state: 'detached' });
  assert.equal(await page.locator('#handles button').count(), 0);
  await page.leave();
});
