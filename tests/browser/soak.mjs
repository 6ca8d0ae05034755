// A kiosk that runs for long, at accelerated time, and a server that has many visitors: nothing grows.
// The short one is in the default layer. BRUME_TESTS=whole runs for BRUME_SOAK_MINUTES (5) of real time, and writes
// what it has measured to BRUME_SOAK_OUT.
import assert from 'node:assert/strict';
import { readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { connect, createServer } from 'node:net';
import { after, before, test } from 'node:test';
import { connected, drag, openPage, startBrowser, until } from './pages.mjs';
import { startServer } from './server.mjs';
import { count, faster, listen, visit } from './soak-page.mjs';
import { trend } from './trend.mjs';

const WHOLE = process.env.BRUME_TESTS === 'whole';
const MINUTES = Number(process.env.BRUME_SOAK_MINUTES ?? 5);
const OUT = process.env.BRUME_SOAK_OUT;
// Real seconds of each block, after which is measured, of which `visits` are for other visitors. factor: of time.
const PLAN = WHOLE
  ? {
      blocks: Math.max(8, Math.round(MINUTES * 3)),
      seconds: 20,
      visits: 5,
      factor: 6,
      skip: 3,
      query: 'idle=20&home=120',
    }
  : { blocks: 5, seconds: 0.7, visits: 0.3, factor: 4, skip: 1, query: 'idle=4&home=12' };
// Growth below is none: of a short run it is what a page and a driver settle by in their first minute. Where visitors
// leave nothing behind, it does not grow with their number: a viewer has more than 1 kB, and a picture more than a byte
// for each pixel.
const MB = 2 ** 20;
const VIEWPORT = { width: 320, height: 180 };
const floorsFor = (visitors) => ({
  heap: (WHOLE ? 0.3 : 2) * MB,
  visitors: Math.max((WHOLE ? 0.3 : 2) * MB, 1024 * visitors), // heap of the page that they come from
  nodes: 20,
  listeners: 20,
  gpu: 4,
  bitmaps: 3,
  sockets: 2,
  server: (WHOLE ? 8 : 30) * MB, // its memory without the device's
  device: Math.max(30 * MB, VIEWPORT.width * VIEWPORT.height * visitors), // of pictures, light and particles
  files: 3,
});

let browser;
before(async () => {
  browser = await startBrowser();
});
after(async () => {
  await browser?.close();
});

// A way to the server that is cut on request, as by a cable.
async function startCable(url) {
  const { hostname, port } = new URL(url);
  const sockets = new Set();
  const server = createServer((near) => {
    const far = connect(Number(port), hostname);
    for (const [from, to] of [
      [near, far],
      [far, near],
    ]) {
      sockets.add(from);
      from.setNoDelay(true);
      from.on('error', () => undefined);
      from.on('close', () => sockets.delete(from) && to.destroy());
      from.pipe(to);
    }
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  const cut = () => sockets.forEach((socket) => socket.destroy());
  return {
    url: `http://127.0.0.1:${server.address().port}`,
    cut,
    stop() {
      server.close();
      cut();
    },
  };
}

const quantile = (values, q) => [...values].sort((a, b) => a - b)[Math.floor(q * (values.length - 1))];
const processOf = (pid) => {
  const kept = readFileSync(`/proc/${pid}/smaps_rollup`, 'utf8');
  const bytes = (what) => 1024 * Number(new RegExp(`^${what}:\\s+(\\d+)`, 'm').exec(kept)[1]);
  return { server: bytes('Anonymous'), rss: bytes('Rss'), files: readdirSync(`/proc/${pid}/fd`).length };
};

async function deviceOf(url) {
  const text = await (await fetch(`${url}/metrics`)).text();
  const value = (name) => Number(new RegExp(`^${name} (\\S+)$`, 'm').exec(text)[1]);
  return { device: value('brume_device_memory_bytes') };
}

async function inspect(page) {
  const inspector = await page.context().newCDPSession(page);
  for (const domain of ['HeapProfiler', 'Performance']) await inspector.send(`${domain}.enable`);
  return inspector;
}

async function heapOf(inspector) {
  for (let i = 0; i < 2; ++i) await inspector.send('HeapProfiler.collectGarbage');
  const { usedSize, backingStorageSize = 0 } = await inspector.send('Runtime.getHeapUsage');
  return usedSize + backingStorageSize;
}

// What both pages and the server hold, without what is garbage.
async function measure(page, [inspector, others], server) {
  const [heap, visitors] = [await heapOf(inspector), await heapOf(others)];
  await page.evaluate(() => new Promise((done) => setTimeout(done, 0))); // what was collected is counted
  const told = await Promise.all([inspector, others].map((one) => one.send('Performance.getMetrics')));
  const sum = (what) => told.reduce((all, { metrics }) => all + metrics.find(({ name }) => name === what).value, 0);
  const counted = await page.evaluate(() => {
    const { latencies, ...rest } = window.counted;
    window.counted.latencies = [];
    return { latencies, ...rest };
  });
  const { gpu, bitmaps, sockets, frames, latencies } = counted;
  return {
    ...{ heap, visitors },
    ...{ nodes: sum('Nodes'), listeners: sum('JSEventListeners'), gpu, bitmaps, sockets, frames },
    ...{ p50: quantile(latencies, 0.5) / PLAN.factor, p95: quantile(latencies, 0.95) / PLAN.factor },
    ...processOf(server.pid),
    ...(await deviceOf(server.url)),
  };
}

const trends = (rows, floors, more = []) =>
  Object.fromEntries(
    [...Object.keys(floors), ...more].map((name) => [
      name,
      trend(
        rows.map((row) => row[name]),
        floors[name],
      ),
    ]),
  );
const growing = (rows, floors) =>
  Object.entries(trends(rows, floors)).flatMap(([name, { grows }]) => (grows ? [name] : []));

test('what only scatters does not grow, what leaks does', () => {
  let seed = 1;
  const random = () => (seed = (seed * 16807) % 2147483647) / 2147483647 - 0.5;
  let wrong = 0;
  for (let i = 0; i < 1000; ++i) wrong += trend(Array.from({ length: 20 }, random)).grows ? 1 : 0;
  assert.ok(wrong <= 5, `${wrong} of 1000 rows without a trend`);
  for (let i = 0; i < 1000; ++i)
    assert.ok(trend(Array.from({ length: 20 }, (_, k) => random() + 0.2 * k)).grows, 'a fifth of the scatter a step');
  assert.ok(trend([1, 2, 3, 4, 5]).grows);
  assert.ok(!trend([1, 2, 3, 4, 5], 10).grows, 'below the floor');
  assert.ok(!trend([5, 4, 3, 2, 1]).grows);
});

test('a kiosk and its server hold no more after many visitors than after few', async (t) => {
  const server = await startServer('--max-pixels', '57600');
  t.after(() => server.stop());
  const cable = await startCable(server.url);
  t.after(() => cable.stop());
  const script = `(${count})(); if (location.pathname === '/') (${faster})(${PLAN.factor});`;
  const address = `${cable.url}/?kiosk=1&reproject=rotation&draw=server&${PLAN.query}`;
  const page = await openPage(t, browser, address, { script, viewport: VIEWPORT });
  const other = await openPage(t, browser, `${server.url}/embed.html`, { script, viewport: VIEWPORT });
  await Promise.all([connected(page), connected(other)]);
  await page.evaluate(listen);
  const inspectors = [await inspect(page), await inspect(other)];
  const done = { visitors: 0, cuts: 0, drags: 0 };

  // One block: somebody drags, the cable is pulled, a graphics context is lost, others come and go, nobody is there.
  async function block() {
    const end = performance.now() + 1000 * PLAN.seconds;
    const here = async () => {
      do {
        await drag(page, [0.35, 0.5], [0.65, 0.45], 6);
        ++done.drags;
        if (WHOLE) await page.waitForTimeout((1000 * 180) / PLAN.factor); // a visitor each three minutes
      } while (WHOLE && performance.now() < end - 3000);
    };
    const there = async () => {
      const visitors = await other.evaluate(visit, 1000 * PLAN.visits);
      assert.ok(visitors > 0, 'a visitor has a picture');
      done.visitors += visitors;
    };
    await Promise.all([here(), there()]);
    cable.cut();
    ++done.cuts;
    await page.evaluate(async () => {
      const canvas = document.getElementById('view').warped;
      const lost = new Promise((heard) => canvas.addEventListener('webglcontextlost', heard, { once: true }));
      const back = new Promise((heard) => canvas.addEventListener('webglcontextrestored', heard, { once: true }));
      window.loses ??= canvas.getContext('webgl2').getExtension('WEBGL_lose_context');
      window.loses.loseContext();
      await lost;
      await new Promise((done) => setTimeout(done, 500)); // it can be restored once its event is over
      window.loses.restoreContext();
      await back;
    });
    const { frames } = await page.evaluate(() => window.counted);
    await until(page, 'pictures come again', (b) => b.state === 'connected');
    await page.waitForFunction((old) => window.counted.frames > old + 2, frames, { polling: 50 });
    await page.waitForTimeout(Math.max(0, end - performance.now()));
    return measure(page, inspectors, server);
  }

  const began = await page.evaluate(() => performance.now());
  const rows = [];
  for (let i = 0; i < PLAN.skip + PLAN.blocks; ++i) rows.push(await block());
  const hours = ((await page.evaluate(() => performance.now())) - began) / 3_600_000;
  const kept = rows.slice(PLAN.skip);
  const floors = floorsFor(done.visitors);
  const found = trends(kept, floors, ['rss', 'p50', 'p95']);
  const frames = rows.at(-1).frames;
  const said = { hours, ...done, frames };
  t.diagnostic(JSON.stringify(said));
  for (const [name, { drift, scatter }] of Object.entries(found))
    t.diagnostic(`${name}: ${kept[0][name]} to ${kept.at(-1)[name]}, drift ${drift}, scatter ${scatter}`);
  if (OUT) writeFileSync(OUT, JSON.stringify({ ...said, plan: PLAN, found, rows }, undefined, 1));
  assert.deepEqual(growing(kept, floors), []);
  if (WHOLE) assert.ok(!found.p50.grows || found.p50.drift < kept[0].p50, 'the latency is what it was');

  // The same with a leak of each kind, which has to be found.
  const sockets = [];
  t.after(() => sockets.forEach((socket) => socket.destroy()));
  const leaky = [];
  for (let i = 0; i < 5; ++i) {
    await page.evaluate(async () => {
      const view = document.getElementById('view');
      const kept = (window.kept ??= []);
      kept.push(Array.from({ length: 500_000 }, (_, k) => k + 0.5)); // 4 MB
      const gl = view.warped.getContext('webgl2');
      for (let k = 0; k < 50; ++k) {
        kept.push(document.createElement('p'), gl.createTexture());
        view.addEventListener('drawn', () => kept.length);
      }
      for (let k = 0; k < 5; ++k) kept.push(await createImageBitmap(new ImageData(4, 4)));
    });
    for (let k = 0; k < 5; ++k) sockets.push(connect(Number(server.port), '127.0.0.1'));
    await page.waitForTimeout(50);
    leaky.push(await measure(page, inspectors, server));
  }
  const missed = ['heap', 'nodes', 'listeners', 'gpu', 'bitmaps', 'files'].filter(
    (name) => !growing(leaky, floorsFor(0)).includes(name),
  );
  assert.deepEqual(missed, [], 'leaks that were not found');
  await Promise.all([page.leave(), other.leave()]);
  assert.equal(await server.stop(), 0, 'the server’s exit');
});
