// The page in WebKit, as GNOME Web has it, by Debian's WebKitWebDriver: what everybody does first. Playwright drives no
// such WebKit; this is WebDriver by hand.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { existsSync } from 'node:fs';
import { createServer } from 'node:net';
import { test } from 'node:test';
import { setTimeout } from 'node:timers/promises';
import { startDisplay } from './browsers.mjs';
import { startServer } from './server.mjs';

const DRIVER = process.env.WEBKIT_DRIVER ?? '/usr/bin/WebKitWebDriver';
const WAIT_MS = 60_000;
const RIGHT = '\uE014'; // the arrow key
const skip =
  process.env.BRUME_TESTS !== 'whole'
    ? 'only with BRUME_TESTS=whole'
    : !existsSync(DRIVER) && `${DRIVER} is missing: install webkit2gtk-driver`;

async function freePort() {
  const probe = createServer().listen(0, '127.0.0.1');
  await once(probe, 'listening');
  const { port } = probe.address();
  probe.close();
  return port;
}

// A session of WebDriver: `run` evaluates a script in the page, `act` sends input.
async function startWebKit(t) {
  const display = await startDisplay();
  // Root has no sandbox for the processes of pages.
  const env = { ...process.env, DISPLAY: display.name, WEBKIT_DISABLE_SANDBOX_THIS_IS_DANGEROUS: '1' };
  const port = await freePort();
  const driver = spawn(DRIVER, [`--port=${port}`], { env, stdio: 'ignore' });
  let session;
  t.after(async () => {
    if (session) await call('DELETE', `/${session}`);
    driver.kill();
    display.stop();
  });
  const call = async (method, path, body) => {
    const answer = await fetch(`http://127.0.0.1:${port}/session${path}`, {
      method,
      body: body && JSON.stringify(body),
    });
    const { value } = await answer.json();
    if (!answer.ok) throw new Error(`${value.error}: ${value.message}`);
    return value;
  };
  const begin = async () => {
    for (const deadline = Date.now() + WAIT_MS; ; await setTimeout(100))
      try {
        return await call('POST', '', { capabilities: { alwaysMatch: { browserName: 'MiniBrowser' } } });
      } catch (error) {
        if (Date.now() > deadline || error.cause === undefined) throw error; // nobody listens yet
      }
  };
  session = (await begin()).sessionId;
  const run = (script, ...args) => call('POST', `/${session}/execute/sync`, { script: `return ${script}`, args });
  return {
    open: (url) => call('POST', `/${session}/url`, { url }),
    run,
    act: (source) => call('POST', `/${session}/actions`, { actions: [source] }),
    async until(what, script, ...args) {
      for (const deadline = Date.now() + WAIT_MS; !(await run(script, ...args)); await setTimeout(50))
        assert.ok(Date.now() < deadline, `waited in vain until ${what}`);
    },
  };
}

const press = (value, pause = 0) => ({
  ...{ type: 'key', id: 'keyboard' },
  actions: [
    { type: 'keyDown', value },
    { type: 'pause', duration: pause },
    { type: 'keyUp', value },
  ],
});

test('in WebKit a picture comes, drag and keys move the camera, and a setting changes', { skip }, async (t) => {
  const server = await startServer();
  t.after(() => server.stop());
  const { open, run, act, until } = await startWebKit(t);
  await open(`${server.url}/?draw=server`);
  await until('pictures come', 'window.brume?.state === "connected" && window.brume.frames > 5');
  const spread = await run(`(() => {
    const { canvas } = document.getElementById('view');
    const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d');
    copy.drawImage(canvas, 0, 0);
    const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
    return Math.max(...data.filter((_, i) => i % 4 === 1)) - Math.min(...data.filter((_, i) => i % 4 === 1));
  })()`);
  assert.ok(spread > 60, `the picture is nearly uniform: ${spread}`);

  const camera = () => run('JSON.stringify(window.brume.camera)');
  const moved = (before) => until('the camera moves', 'JSON.stringify(window.brume.camera) !== arguments[0]', before);
  let before = await camera();
  const middle = await run('[innerWidth / 2, innerHeight / 2].map(Math.round)');
  const at = ([x, y], duration = 0) => ({ type: 'pointerMove', x, y, duration });
  await act({
    ...{ type: 'pointer', id: 'mouse' },
    actions: [
      at(middle),
      { type: 'pointerDown', button: 0 },
      at([middle[0] + 120, middle[1] + 30], 200),
      { type: 'pointerUp', button: 0 },
    ],
  });
  await moved(before);
  before = await camera();
  await act(press('w', 200));
  await moved(before);
  const pose = await run('window.brume.sentPose');
  await until('a picture shows it', 'window.brume.lastFrame.poseSeq >= arguments[0]', pose);

  await act(press('o'));
  await until('the settings are there', 'document.querySelector("#panel .setting input[type=range]")');
  const exposure = await run('window.brume.scene.settings["render.exposure"]');
  await run(`[...document.querySelectorAll('#panel label')].find(({ textContent }) => textContent.startsWith('Exposure'))
    .querySelector('input').focus()`);
  for (let i = 0; i < 6; ++i) await act(press(RIGHT));
  await until('it changes', 'window.brume.scene.settings["render.exposure"] > arguments[0]', exposure);
});
