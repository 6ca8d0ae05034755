// A brume-server for a test: started, found by the line it prints, and stopped.
import { spawn } from 'node:child_process';
import { existsSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

const ROOT = fileURLToPath(new URL('../../', import.meta.url));
export const BINARY = process.env.BRUME_SERVER ?? join(ROOT, 'build/release/bin/brume-server');
export const WEB_ROOT = process.env.BRUME_WEB_ROOT ?? join(ROOT, 'client/web/dist');
const START_MS = 120_000; // a driver may compile shaders first, beside other work
const STOP_MS = 10_000;

export async function startServer(...options) {
  for (const path of [BINARY, join(WEB_ROOT, 'index.html')]) {
    if (!existsSync(path)) throw new Error(`${path} is missing: build first, with ./dev`);
  }
  const flags = ['--scene', 'cloud', '--web-root', WEB_ROOT, '--ahead', 'off', ...options];
  if (!options.includes('--port')) flags.push('--port', '0');
  const child = spawn(BINARY, flags, { cwd: ROOT, stdio: ['ignore', 'pipe', 'pipe'] });
  let output = '';
  const exited = new Promise((resolve) => child.once('exit', (code, signal) => resolve({ code, signal })));
  const url = await new Promise((resolve, reject) => {
    const fail = (why) => reject(new Error(`the server ${why}; it said:\n${output}`));
    const timer = setTimeout(() => fail('did not start in time'), START_MS);
    const read = (chunk) => {
      output += chunk;
      const found = /listening on (https?:\/\/\S+)/.exec(output);
      if (!found) return;
      clearTimeout(timer);
      resolve(found[1]);
    };
    child.stdout.on('data', read);
    child.stderr.on('data', (chunk) => (output += chunk));
    child.once('error', (error) => fail(`cannot be run (${error.message})`));
    void exited.then(({ code }) => fail(`ended with ${code}`));
  });
  return {
    url,
    pid: child.pid,
    port: new URL(url).port,
    output: () => output,
    // As an operator would: the server says goodbye to its viewers. Resolves with its exit code.
    async stop(signalled = 'SIGTERM') {
      if (child.exitCode === null && child.signalCode === null) child.kill(signalled);
      const timer = setTimeout(() => child.kill('SIGKILL'), STOP_MS);
      const { code, signal } = await exited;
      clearTimeout(timer);
      return signal ?? code;
    },
  };
}
