// The page: puts camera, connection, picture, panel and overlay together.
import { fitAspect, lookAt, orientation, same } from './camera';
import type { Camera } from './camera';
import { Connection } from './connection';
import type { LinkState } from './connection';
import { Controls, isField } from './controls';
import type { ControlsHost, Mode } from './controls';
import { find, setPressed, setText } from './dom';
import { LatencyAverage, Rate, splitLatency } from './latency';
import type { Latency, Presented } from './latency';
import { Notices, sentence } from './notices';
import { Overlay } from './overlay';
import { buildPanel } from './panel';
import { Picture } from './picture';
import type { Command, Frame, SceneState, ServerMessage, Welcome } from './protocol';
import { Pusher } from './pusher';
import { loadSettings, saveSettings } from './settings';
import { SIZE_CAPS, defaultCap, requestedSize } from './size';
import type { Size } from './size';

// A still camera sends its pose again this often, so that the latency shown stays true.
const POSE_REFRESH_MS = 500;
const OVERLAY_MS = 250;
const RESIZE_SETTLE_MS = 150;
const RECENT_TICKS = 240;
const ERROR_FULL = 5; // shown as a state, not as a note
const CLIENT = 'brume-web 0.1.0';

const canvas = find<HTMLCanvasElement>('view');
const settings = loadSettings();

let welcome: Welcome | undefined;
let scene: SceneState | undefined;
let camera: Camera = lookAt([0, 2, 26], [0, 0, 0]);
let home = camera;
let mode: Mode = 'orbit';
let pushing = false;
let linkState: LinkState['name'] = 'connecting';
let size: Size = wantedSize();
let sent: { camera: Camera; size: Size; at: number } | undefined;

let frames = 0;
let lastFrame: Frame | undefined;
let lastLatency: Latency | undefined;
let answeredPose = 0;
let roundTripMs: number | undefined;
const recent: { tick: number; hash: string }[] = [];
const shownRate = new Rate(2000);
const byteRate = new Rate();
const latency = new LatencyAverage();

function chosenCap(): number {
  return settings.cap ?? defaultCap(welcome?.device ?? '');
}

function wantedSize(): Size {
  const cap = SIZE_CAPS[chosenCap()] ?? { width: 960, height: 540 };
  return requestedSize(canvas.clientWidth, canvas.clientHeight, window.devicePixelRatio, cap);
}

const aspect = (): number => canvas.clientWidth / Math.max(1, canvas.clientHeight);
const hash = (value: bigint): string => value.toString(16).padStart(16, '0');

// ---- connection ----

const notices = new Notices(() => link.retryNow());

// Beside the page, wherever a proxy has put it.
const address = new URL('ws', location.href);
address.protocol = location.protocol === 'https:' ? 'wss:' : 'ws:';
address.search = address.hash = '';
const link = new Connection(address.href, {
  hello: () => ({ client: CLIENT, ...size, quality: settings.quality }),
  state: (state) => {
    linkState = state.name;
    if (state.name === 'connected') enter(state.welcome);
    notices.link(state);
  },
  message: receive,
  roundTrip: (ms) => (roundTripMs = roundTripMs === undefined ? ms : roundTripMs + (ms - roundTripMs) * 0.3),
});

function enter(greeting: Welcome): void {
  // The same scene again: the viewer stays where they were.
  if (welcome?.scene !== greeting.scene) {
    home = fitAspect(lookAt(greeting.camera.position, greeting.camera.target), aspect());
    camera = home;
  }
  welcome = greeting;
  sent = undefined;
  answeredPose = 0;
  roundTripMs = undefined;
  latency.reset();
  picture.clear();
  panel.welcome(greeting, chosenCap());
  size = wantedSize();
  setText(find('brand-scene'), greeting.scene);
}

function receive(message: ServerMessage, bytes: number): void {
  byteRate.add(performance.now(), bytes);
  switch (message.kind) {
    case 'frame':
      picture.show(message);
      break;
    case 'scene':
      scene = message;
      panel.follow(message);
      setPressed(find('tool-pause'), message.paused);
      break;
    case 'error':
      if (message.code !== ERROR_FULL) notices.note(sentence(message.text || 'The server refused that.'), 'error');
      break;
  }
}

const command = (order: Command): void => {
  if (!link.sendInput(order)) notices.note('Not connected: that change was not sent.', 'error');
};

// ---- picture ----

const picture = new Picture(canvas, {
  presented: (frame, at) => {
    link.acknowledge(frame.id);
    present(frame, at);
  },
  dropped: (frame) => link.acknowledge(frame.id),
  failed: (frame) => {
    link.acknowledge(frame.id);
    notices.note('A picture could not be read.', 'error');
  },
});

function present(frame: Frame, at: Presented): void {
  frames += 1;
  lastFrame = frame;
  shownRate.add(at.presented);
  recent.push({ tick: Number(frame.tick), hash: hash(frame.stateHash) });
  if (recent.length > RECENT_TICKS) recent.shift();
  // Only the first frame that shows a pose tells how long that pose took.
  if (frame.poseSeq > answeredPose) {
    answeredPose = frame.poseSeq;
    lastLatency = splitLatency(frame, at);
    latency.add(lastLatency);
    overlay.sample(lastLatency);
  }
  notices.picture();
}

// ---- camera, pushing, keys ----

const cursor = find('cursor');
const host: ControlsHost = {
  get camera() {
    return camera;
  },
  set camera(value) {
    camera = value;
  },
  get mode() {
    return mode;
  },
  set mode(value) {
    mode = value;
  },
  get fovY() {
    return welcome?.camera.fovY ?? 0.8;
  },
  get pushing() {
    return pushing;
  },
  touched: () => document.body.classList.add('touched'),
  pushed: (active, x, y) => {
    cursor.classList.toggle('active', active);
    cursor.style.transform = `translate(${x}px, ${y}px)`;
  },
};
// Pushes made while the connection is away are moot.
const pusher = new Pusher((impulse) => void link.sendInput(impulse));
const controls = new Controls(canvas, host, pusher);

function setMode(value: Mode): void {
  mode = value;
  setPressed(find('tool-orbit'), mode === 'orbit');
  setPressed(find('tool-fly'), mode === 'fly');
  hint();
}

function setPushing(on: boolean): void {
  pushing = on;
  setPressed(find('tool-push'), on);
  document.body.classList.toggle('pushing', on);
  hint();
}

function hint(): void {
  const touch = matchMedia('(pointer: coarse)').matches;
  // Many window managers keep Alt-drag to themselves, and a Mac's Ctrl-click is another click.
  const key = /^(Mac|iP)/.test(navigator.platform) ? 'Option' : 'Ctrl';
  const turn = mode === 'orbit' ? 'orbit' : 'look around';
  const travel = mode === 'orbit' ? 'scroll to zoom' : 'WASD to fly';
  const text = pushing
    ? 'Drag to push the cloud'
    : touch
      ? `Drag to ${turn} · pinch to zoom · hold, then drag to push`
      : `Drag to ${turn} · ${travel} · ${key}-drag to push the cloud`;
  setText(find('hint'), text);
}

const toggles = {
  stats: (on: boolean): void => {
    settings.stats = on;
    find('overlay').hidden = !on;
    setPressed(find('tool-stats'), on);
    saveSettings(settings);
    refreshOverlay();
  },
  panel: (on: boolean): void => {
    settings.panel = on;
    find('panel').hidden = !on;
    setPressed(find('tool-panel'), on);
    saveSettings(settings);
  },
};

const actions: Record<string, () => void> = {
  orbit: () => setMode('orbit'),
  fly: () => setMode('fly'),
  push: () => setPushing(!pushing),
  pause: () => command({ kind: 'simulation', paused: !(scene?.paused ?? false) }),
  reset: () => (camera = home),
  stats: () => toggles.stats(!settings.stats),
  panel: () => toggles.panel(!settings.panel),
};
for (const [name, action] of Object.entries(actions)) find(`tool-${name}`).addEventListener('click', action);

const keys: Record<string, () => void> = {
  KeyC: () => setMode(mode === 'orbit' ? 'fly' : 'orbit'),
  KeyX: () => actions['push']?.(),
  KeyP: () => actions['pause']?.(),
  KeyR: () => actions['reset']?.(),
  KeyI: () => actions['stats']?.(),
  KeyO: () => actions['panel']?.(),
  Escape: () => (pushing ? setPushing(false) : toggles.panel(false)),
};
window.addEventListener('keydown', (event) => {
  if (event.repeat || event.ctrlKey || event.altKey || event.metaKey) return;
  if (isField(event.target) && event.code !== 'Escape') return;
  keys[event.code]?.();
});

// ---- panel and overlay ----

const panel = buildPanel(
  find('panel'),
  {
    command,
    camera: () => camera,
    setCap: (index) => {
      settings.cap = index;
      saveSettings(settings);
      size = wantedSize();
    },
    setQuality: (quality) => {
      settings.quality = quality;
      saveSettings(settings);
      link.reopen(); // the quality is part of the hello
    },
    close: () => toggles.panel(false),
  },
  settings.quality,
);
const overlay = new Overlay(find('overlay'));

function refreshOverlay(): void {
  const now = performance.now();
  overlay.update({
    fps: shownRate.perSecond(now),
    bytesPerSecond: byteRate.perSecond(now),
    roundTripMs,
    latency: latency.get(),
    frame: lastFrame,
    scene,
    welcome,
  });
}

// ---- once per animation frame ----

let before = performance.now();
function animate(now: number): void {
  requestAnimationFrame(animate);
  controls.update(now, Math.min(0.1, Math.max(0, (now - before) / 1000)));
  before = now;
  const due = !sent || !same(sent.camera, camera) || sent.size !== size || now - sent.at > POSE_REFRESH_MS;
  if (due && link.connected) {
    const { position } = camera;
    if (link.sendPose({ position, orientation: orientation(camera), fovY: host.fovY, ...size })) {
      sent = { camera, size, at: now };
    }
  }
}

// A hidden page presents nothing: what it was shown of poses from before says nothing about the way here.
document.addEventListener('visibilitychange', () => (answeredPose = link.lastPose));

let settle: number | undefined;
new ResizeObserver(() => {
  window.clearTimeout(settle);
  settle = window.setTimeout(() => {
    const next = wantedSize();
    if (next.width !== size.width || next.height !== size.height) size = next;
  }, RESIZE_SETTLE_MS);
}).observe(canvas);

setMode('orbit');
toggles.stats(settings.stats);
toggles.panel(settings.panel);
window.setInterval(refreshOverlay, OVERLAY_MS);
requestAnimationFrame(animate);
link.start();

// ---- for tests and the curious: read-only ----

const report = Object.freeze({
  get state() {
    return linkState;
  },
  get viewer() {
    return welcome?.viewer;
  },
  get tick() {
    return lastFrame && Number(lastFrame.tick);
  },
  get stateHash() {
    return lastFrame && hash(lastFrame.stateHash);
  },
  get frames() {
    return frames;
  },
  get sentPose() {
    return sent && same(sent.camera, camera) ? link.lastPose : undefined; // undefined while a newer one is due
  },
  get recent() {
    return recent.map((entry) => ({ ...entry }));
  },
  get camera() {
    return { ...camera };
  },
  get scene() {
    return scene && { ...scene, tick: Number(scene.tick), stateHash: hash(scene.stateHash) };
  },
  get lastFrame() {
    if (!lastFrame) return undefined;
    const { id, tick, stateHash, poseSeq, width, height, quality, stages, jpeg } = lastFrame;
    const bytes = jpeg.reduce((sum, view) => sum + view.length, 0);
    const shown = { id, tick: Number(tick), stateHash: hash(stateHash), poseSeq, width, height, quality, bytes };
    return { ...shown, stages: { ...stages }, latency: lastLatency && { ...lastLatency } };
  },
});
declare global {
  interface Window {
    readonly brume: typeof report;
  }
}
Object.defineProperty(window, 'brume', { value: report });
