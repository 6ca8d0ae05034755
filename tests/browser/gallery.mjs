// The pictures of docs/gallery.md, made by the server: node tests/browser/gallery.mjs [FOLDER] [SCENE...]
import { mkdir, readdir, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { setTimeout } from 'node:timers/promises';
import { startServer } from './server.mjs';

const folder = process.argv[2] ?? 'docs/pictures/scenes';
const SCENES = 'server/scenes';
// Nothing is given up, however busy the machine.
const FINE = ['--frame-budget', '10000', '--most-frame-time', '60000'];
const SIZE = 'w=480&h=270&quality=90';
// Of scenes whose smoke has to rise first; the others are as they begin.
const TICKS = { plume: 900, morning: 900, 'smoke-spots': 600, glass: 600 };
// A scene of several places has a picture of each, with these parameters.
const PLACES = {
  flythrough: {
    local: 'position=-4,2.6,15&target=4.5,2.8,0&fov=0.85',
    close: 'position=30.2,1.7,5.5&target=30.4,1.6,-4&fov=0.95',
    lights: 'position=6,3.2,-30&target=60,5,-31.5&fov=0.8',
    sun: 'position=-18,1.7,10&target=-25,9.5,-10&fov=0.95',
    depth: 'position=-64.5,41,-40&target=-77,4,-52&fov=1.1',
    balance: 'position=48,12.5,52&target=72,4,22&fov=0.85',
  },
};

// A driver that compiles shaders has no picture for now.
async function get(url, options) {
  for (;;) {
    const answer = await fetch(url, options);
    if (answer.ok) return answer;
    if (answer.status !== 503) throw new Error(`${url}: ${answer.status} ${await answer.text()}`);
    await setTimeout(1000);
  }
}

await mkdir(folder, { recursive: true });
const all = (await readdir(SCENES)).filter((name) => name.endsWith('.toml')).map((name) => name.slice(0, -5));
const asked = process.argv.slice(3);
const tickOf = (answer) => Number(answer.headers.get('Brume-Tick'));
const server = await startServer(...FINE);
try {
  for (const scene of asked.length > 0 ? asked : all) {
    const begun = tickOf(await get(`${server.url}/scene?name=${scene}`, { method: 'POST' }));
    const due = begun + (TICKS[scene] ?? 0);
    while (tickOf(await get(`${server.url}/snapshot.jpg?w=32&h=18`)) < due);
    await get(`${server.url}/pause`, { method: 'POST' });
    for (const [place, query] of Object.entries(PLACES[scene] ?? { '': '' })) {
      const picture = await get(`${server.url}/snapshot.jpg?${SIZE}&${query}`);
      const name = place ? `${scene}-${place}` : scene;
      await writeFile(join(folder, `${name}.jpg`), Buffer.from(await picture.arrayBuffer()));
      console.log(name);
    }
  }
} finally {
  await server.stop();
}
