// The page's stand-in for a server (client/web/test/mock-server.ts), for what a real one does not say on request.
import { spawn } from 'node:child_process';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { WEB_ROOT } from './server.mjs';

const WEB = fileURLToPath(new URL('../../client/web/', import.meta.url));
const START_MS = 60_000;

// { url, does(how), stop() }: `how` has the parameters of /mock.
export async function startMock() {
  const run = ['test/mock-server.ts', '--', '--port', '0', '--web-root', WEB_ROOT];
  const program = join(WEB, 'node_modules/.bin/vite-node');
  const child = spawn(program, run, { cwd: WEB, stdio: ['ignore', 'pipe', 'inherit'] });
  const exited = new Promise((resolve) => child.once('exit', resolve));
  const url = await new Promise((resolve, reject) => {
    let output = '';
    const timer = setTimeout(() => reject(new Error('the stand-in does not start in time')), START_MS);
    child.once('error', reject);
    void exited.then((code) => reject(new Error(`the stand-in ended with ${code}`)));
    child.stdout.on('data', (chunk) => {
      output += chunk;
      const found = /listening on (http:\S+)/.exec(output);
      if (!found) return;
      clearTimeout(timer);
      resolve(found[1]);
    });
  });
  return {
    url,
    does: async (how) => void (await fetch(`${url}/mock?${new URLSearchParams(how)}`)),
    async stop() {
      child.kill();
      await exited;
    },
  };
}
