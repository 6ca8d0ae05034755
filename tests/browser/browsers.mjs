// The browser that the tests drive: Debian's Chromium, or its Firefox where BRUME_BROWSER is firefox. The tests are the
// same. CHROMIUM and FIREFOX name others than Debian's.
import { spawn } from 'node:child_process';
import { copyFileSync, existsSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { chromium, firefox } from 'playwright-core';

const CHROMIUM = process.env.CHROMIUM ?? '/usr/bin/chromium';
const FIREFOX = process.env.FIREFOX ?? '/usr/bin/firefox-esr';
const XVFB = '/usr/bin/Xvfb';
export const IS_FIREFOX = process.env.BRUME_BROWSER === 'firefox';

function mustBeThere(path, what) {
  if (!existsSync(path)) throw new Error(`${path} is missing: install ${what}`);
}

// Firefox draws with WebGL only where it has a display.
export async function startDisplay() {
  mustBeThere(XVFB, 'xvfb');
  const options = ['-displayfd', '3', '-screen', '0', '1920x1200x24', '-nolisten', 'tcp'];
  const server = spawn(XVFB, options, { stdio: ['ignore', 'ignore', 'ignore', 'pipe'] });
  process.once('exit', () => server.kill());
  const number = await new Promise((resolve, reject) => {
    server.stdio[3].once('data', (line) => resolve(Number(line)));
    server.once('exit', (code) => reject(new Error(`Xvfb ended with ${code}`)));
  });
  return { name: `:${number}`, stop: () => server.kill() };
}

async function startFirefox() {
  mustBeThere(FIREFOX, 'firefox-esr, or name another with FIREFOX');
  const display = await startDisplay();
  const downloads = mkdtempSync(join(tmpdir(), 'brume-'));
  const leave = () => {
    display.stop();
    rmSync(downloads, { recursive: true, force: true });
  };
  try {
    const browser = await firefox.launch({
      channel: 'moz-firefox', // unpatched, by WebDriver BiDi
      executablePath: FIREFOX,
      headless: false,
      env: { ...process.env, DISPLAY: display.name },
      firefoxUserPrefs: { 'browser.download.folderList': 2, 'browser.download.dir': downloads },
    });
    browser.once('disconnected', leave);
    return browser;
  } catch (error) {
    leave();
    throw error;
  }
}

async function startChromium() {
  mustBeThere(CHROMIUM, 'chromium, or name another with CHROMIUM');
  const args = ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-sync'];
  args.push('--disable-background-networking', '--disable-component-update');
  return chromium.launch({ executablePath: CHROMIUM, args, headless: true });
}

export const startBrowser = () => (IS_FIREFOX ? startFirefox() : startChromium());

// Playwright's own connection to a page of Firefox, for what it does not offer there.
const sessionOf = (page) => page._connection.toImpl(page).delegate._session;

// The next file that the page lets the browser save, as Playwright's Download.
export function nextDownload(page) {
  if (!IS_FIREFOX) return page.waitForEvent('download');
  const session = sessionOf(page);
  return new Promise((resolve) => {
    session.once('browsingContext.downloadWillBegin', ({ suggestedFilename }) =>
      session.once('browsingContext.downloadEnd', ({ filepath }) =>
        resolve({ suggestedFilename: () => suggestedFilename, saveAs: (path) => copyFileSync(filepath, path) }),
      ),
    );
  });
}

// Fingers on the page: fingers.put(points), fingers.move(points), fingers.lift(); a point is [x, y] in CSS pixels.
export async function fingersOn(page) {
  if (!IS_FIREFOX) {
    const device = await page.context().newCDPSession(page);
    const touch = (type, points = []) =>
      device.send('Input.dispatchTouchEvent', { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
    return {
      put: (points) => touch('touchStart', points),
      move: (points) => touch('touchMove', points),
      lift: () => touch('touchEnd'),
    };
  }
  const session = sessionOf(page);
  const touch = (actionsOf) =>
    session.send('input.performActions', {
      context: session.sessionId,
      actions: actionsOf.map((actions, i) => {
        return { type: 'pointer', id: `finger ${i}`, parameters: { pointerType: 'touch' }, actions };
      }),
    });
  const to = ([x, y]) => ({ type: 'pointerMove', x: Math.round(x), y: Math.round(y) });
  let down = 0;
  return {
    put: (points) => {
      down = points.length;
      // One after the other: of two in one event the second is lost where the page prevents what the first does.
      const wait = (i) => Array.from({ length: 2 * i }, () => ({ type: 'pause' }));
      return touch(points.map((point, i) => [...wait(i), to(point), { type: 'pointerDown', button: 0 }]));
    },
    move: (points) => touch(points.map((point) => [to(point)])),
    lift: () => touch(Array.from({ length: down }, () => [{ type: 'pointerUp', button: 0 }])),
  };
}
