// The browser's half of the Python widget, client/python/brume/widget.js, in a page that stands in for a notebook: a
// model with get, set, on, off and save_changes, as anywidget has it.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { drag, openPage, startBrowser } from './pages.mjs';
import { startServer } from './server.mjs';

const WIDGET = readFileSync(fileURLToPath(new URL('../../client/python/brume/widget.js', import.meta.url)));

const page = (values) => `<!doctype html><title>Notebook</title><style>body { margin: 0 }</style><div id="cell"></div>
  <script type="module">
    import widget from '/widget.js';
    const values = ${JSON.stringify(values)};
    const listeners = new Map();
    const saved = []; // what Python would get
    let unsaved = {};
    const model = {
      get: (name) => values[name],
      set(name, value) {
        if (JSON.stringify(values[name]) === JSON.stringify(value)) return;
        values[name] = unsaved[name] = value;
        for (const act of [...(listeners.get('change:' + name) ?? [])]) act();
      },
      save_changes() {
        saved.push(unsaved);
        unsaved = {};
      },
      on: (event, act) => listeners.set(event, [...(listeners.get(event) ?? []), act]),
      off: (event, act) => listeners.set(event, listeners.get(event).filter((one) => one !== act)),
    };
    const el = document.querySelector('#cell');
    const close = widget.render({ model, el });
    const view = () => el.querySelector('brume-view');
    window.brume = {
      values, saved, close, listeners: () => [...listeners.values()].flat().length,
      python(told) { // all values at once, then what listens
        Object.assign(values, told);
        for (const name of Object.keys(told)) for (const act of listeners.get('change:' + name) ?? []) act();
      },
      report: () => view()?.report, text: () => el.innerText,
      size: () => { const box = view().getBoundingClientRect(); return [box.width, box.height]; },
    };
  </script>`;

let browser, site, server;
before(async () => {
  site = createServer((request, response) => {
    const script = request.url === '/widget.js';
    response.setHeader('content-type', script ? 'text/javascript' : 'text/html; charset=utf-8');
    response.end(script ? WIDGET : page(site.values));
  });
  await new Promise((resolve) => site.listen(0, '127.0.0.1', resolve));
  site.url = `http://127.0.0.1:${site.address().port}`;
  browser = await startBrowser();
  server = await startServer('--allow-origin', site.url);
});
after(async () => {
  await browser?.close();
  site?.close();
  if (server) assert.equal(await server.stop(), 0, 'the server’s exit');
});

const open = (t, values) => {
  site.values = { src: `${server.url}/`, width: '320px', height: '180px', settings: {}, position: null, ...values };
  return openPage(t, browser, site.url, { sentTo: site.values.src });
};
const holds = (page, condition, argument = null) =>
  page.waitForFunction(condition, argument, { polling: 50, timeout: 120_000 });
const pictures = (page) => holds(page, () => window.brume.report()?.frames > 1);
const python = (page, told) => page.evaluate((told) => window.brume.python(told), told);

test('a notebook shows the view, and both sides move its camera', async (t) => {
  const notebook = await open(t, { position: [0, 6, 26], target: [0, 0, 0], draw: 'server' });
  await pictures(notebook);
  assert.deepEqual(await notebook.evaluate(() => window.brume.size()), [320, 180]);
  const at = (page, [x, y, z]) =>
    holds(page, (to) => window.brume.report().camera.position.every((one, i) => Math.abs(one - to[i]) < 1e-3), [
      x,
      y,
      z,
    ]);
  await at(notebook, [0, 6, 26]);
  await python(notebook, { position: [26, 6, 0] });
  await at(notebook, [26, 6, 0]);
  // A person turns it; Python hears where it is, and what it turns about.
  await drag(notebook, [0.4, 0.4], [0.15, 0.4]);
  await holds(notebook, () => {
    const { values, saved, report } = window.brume;
    const { position } = report().camera;
    const told = values.position.every((one, i) => Math.abs(one - position[i]) < 1e-3);
    return told && Math.abs(position[0] - 26) > 1 && saved.some((one) => one.position);
  });
  const { target, position } = await notebook.evaluate(() => window.brume.values);
  assert.ok(Math.hypot(...target) < 1e-3, `it still looks at the middle: ${target}`);
  assert.ok(Math.abs(Math.hypot(...position) - Math.hypot(26, 6)) < 1e-2, 'from as far');
  // Back to where Python had it before: the attributes are the same, the camera is not.
  await python(notebook, { position: [26, 6, 0], target: [0, 0, 0] });
  await at(notebook, [26, 6, 0]);
  await python(notebook, { fov: 0.5, width: '200px' });
  await holds(notebook, () => Math.abs(window.brume.report().lastFrame.fovY - 0.5) < 1e-6);
  assert.equal((await notebook.evaluate(() => window.brume.size()))[0], 200);
  await notebook.evaluate(() => window.brume.close());
  assert.equal(await notebook.evaluate(() => window.brume.listeners()), 0, 'nothing listens any more');
  assert.equal(await notebook.evaluate(() => document.querySelector('brume-view')), null);
  await notebook.leave();
});

test('settings are told, changed, and taken back where they are refused', async (t) => {
  const notebook = await open(t, { draw: 'server' });
  await holds(notebook, () => window.brume.values.settings['render.exposure'] > 0);
  const { state, tick, settings } = await notebook.evaluate(() => window.brume.values);
  assert.equal(state, 'connected');
  assert.ok(tick > 0);
  const exposure = settings['render.exposure'];
  await python(notebook, { settings: { ...settings, 'render.exposure': exposure * 2, 'simulation.paused': true } });
  await holds(
    notebook,
    (to) => {
      const now = window.brume.report().scene.settings;
      return Math.abs(now['render.exposure'] - to) < 1e-3 && now['simulation.paused'] === 1;
    },
    exposure * 2,
  );
  await python(notebook, { settings: { 'render.exposure': -1 } });
  await holds(notebook, () => /exposure/i.test(window.brume.values.note ?? ''));
  await holds(notebook, (to) => Math.abs(window.brume.values.settings['render.exposure'] - to) < 1e-3, exposure * 2);
  await python(notebook, { settings: { ...settings } });
  await holds(
    notebook,
    (to) => Math.abs(window.brume.report().scene.settings['render.exposure'] - to) < 1e-3,
    exposure,
  );
  await notebook.leave();
});

test('a server that does not allow the page, or is not there, is told in one line', async (t) => {
  const strict = await startServer();
  t.after(() => strict.stop());
  for (const src of [`${strict.url}/`, 'http://127.0.0.1:1/']) {
    const notebook = await open(t, { src });
    await holds(notebook, () => window.brume.values.state === 'refused');
    const said = await notebook.evaluate(() => [window.brume.text(), window.brume.values.note]);
    assert.match(said[0], new RegExp(`^${src}brume-view.js cannot be loaded: .*--allow-origin ${site.url}\\?$`));
    assert.equal(said[1], said[0]);
    await notebook.leave();
  }
});
