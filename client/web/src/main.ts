// The page: connects camera, connection, picture, panel and overlay.
import { fitAspect, lookAt, same } from './camera';
import type { Camera } from './camera';
import { Connection, socketAddress } from './connection';
import type { LinkState } from './connection';
import { Controls, onKeys } from './controls';
import type { ControlsHost, Mode } from './controls';
import { find, setPressed, setText } from './dom';
import { Headset, headsetSupported } from './headset';
import { hintText } from './hint';
import type { Presented } from './latency';
import { addressAt, cameraIn } from './move';
import { Notices, sentence } from './notices';
import { Overlay } from './overlay';
import { buildPanel } from './panel';
import { Picture } from './picture';
import type { Command, Frame, SceneState, ServerMessage, Welcome } from './protocol';
import { Pusher } from './pusher';
import { mayControl, takeToken } from './role';
import { valuesOf } from './shared-settings';
import type { Values } from './shared-settings';
import { followAddress, loadSettings, saveSettings } from './settings';
import { Predictor } from './predict';
import { publishReport } from './report';
import { SIZE_CAPS, defaultCap } from './size';
import type { Size } from './size';
import { Statistics } from './statistics';
import { Viewing } from './viewing';
import { Visibility } from './visibility';

// A still camera sends its pose again this often: the latency shown is then never older.
const PAUSED = 'simulation.paused'; // path of the setting
const POSE_REFRESH_MS = 500;
const OVERLAY_MS = 250;
const RESIZE_SETTLE_MS = 150;
const ERROR_FULL = 5; // ErrorCode.full; the connection's state shows it, no note does
const CLIENT = 'brume-web 0.1.0';

let arrived = cameraIn(location.hash); // camera of a viewer that another server sent here
const token = takeToken();
if (arrived) history.replaceState(history.state, '', location.pathname + location.search);

const canvas = find<HTMLCanvasElement>('view');
const settings = loadSettings();
followAddress(settings, location.search);

let welcome: Welcome | undefined;
let scene: SceneState | undefined;
let values: Values = new Map(); // of the scene's settings, as last reported
let camera: Camera = lookAt([0, 2, 26], [0, 0, 0]);
let home = camera; // the scene's own
let mode: Mode = 'orbit';
let pushing = false;
let linkState: LinkState['name'] = 'connecting';
let movedAt: number | undefined; // ms, of the first input since the last pose that was sent
// The last pose that was sent. `said`: its numbers as the server reads them, in float32. `pose`: number of the first
// pose with the same numbers, since the server draws a still picture only once.
let sent: { camera: Camera; size: Size; at: number; pose: number; said: string } | undefined;
let headset: Headset | undefined;
const statistics = new Statistics();
const predictor = new Predictor();

function chosenCap(): number {
  return settings.cap ?? defaultCap(welcome?.device ?? '');
}

const aspect = (): number => canvas.clientWidth / Math.max(1, canvas.clientHeight);
const place = {
  get camera() {
    return camera;
  },
  get fovY() {
    return welcome?.camera.fovY ?? 0.8;
  },
  get cap() {
    return SIZE_CAPS[chosenCap()] ?? { width: 960, height: 540 };
  },
};
const viewing = new Viewing(canvas, find<HTMLCanvasElement>('warped'), place);
let size: Size = viewing.size();

// ---- connection ----

const notices = new Notices(() => link.retryNow());

const link = new Connection(socketAddress(token), {
  hello: () => ({ client: CLIENT, ...size, views: headset ? 2 : viewing.views, quality: settings.quality }),
  state: (state) => {
    linkState = state.name;
    if (state.name !== 'connected') headset?.end('The connection was lost: the headset’s session has ended.');
    if (state.name === 'connected') enter(state.welcome);
    notices.link(state);
  },
  message: receive,
  roundTrip: (ms) => statistics.roundTrip(ms),
  moved: (page) => location.assign(addressAt(page, location.search, token, camera)),
});

function enter(greeting: Welcome): void {
  // The camera starts at the scene's own; in the same scene it stays where it was.
  if (welcome?.scene !== greeting.scene) {
    home = lookAt(greeting.camera.position, greeting.camera.target);
    camera = arrived ?? fitAspect(home, aspect());
    arrived = undefined;
  }
  welcome = greeting;
  sent = undefined;
  statistics.reset();
  predictor.reset();
  picture.clear();
  viewing.clear();
  panel.welcome(greeting, chosenCap());
  for (const tool of ['push', 'pause']) find<HTMLButtonElement>(`tool-${tool}`).disabled = !mayPush();
  if (!mayPush()) setPushing(false);
  size = viewing.size();
  setText(find('brand-scene'), greeting.scene);
  if (visibility.hidden) ask(performance.now());
}

function receive(message: ServerMessage, bytes: number): void {
  statistics.byteRate.add(performance.now(), bytes);
  switch (message.kind) {
    case 'frame':
      picture.show(message);
      break;
    case 'scene':
      scene = message;
      values = valuesOf(welcome?.settings ?? [], message.settings);
      panel.follow(values, message.plan);
      setPressed(find('tool-pause'), paused());
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

const picture = new Picture(viewing, {
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
  const latency = statistics.presented(frame, at);
  if (latency) overlay.sample(latency);
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
    movedAt ??= performance.now();
  },
  get mode() {
    return mode;
  },
  set mode(value) {
    mode = value;
  },
  get fovY() {
    return place.fovY;
  },
  get pushing() {
    return pushing;
  },
  get mayPush() {
    return mayPush();
  },
  touched: () => document.body.classList.add('touched'),
  pushed: (active, x, y) => {
    cursor.classList.toggle('active', active);
    cursor.style.transform = `translate(${x}px, ${y}px)`;
  },
};
// Pushes that are made without a connection are lost.
const pusher = new Pusher((impulse) => void link.sendInput(impulse));
const controls = new Controls(canvas, host, pusher);

function setMode(value: Mode): void {
  mode = value;
  setPressed(find('tool-orbit'), mode === 'orbit');
  setPressed(find('tool-fly'), mode === 'fly');
  hint();
}

const paused = (): boolean => values.get(PAUSED) === 1;
const mayPush = (): boolean => mayControl(welcome?.role ?? 'operator');

function setPushing(on: boolean): void {
  pushing = on && mayPush();
  setPressed(find('tool-push'), pushing);
  document.body.classList.toggle('pushing', pushing);
  hint();
}

const hint = (): void => setText(find('hint'), hintText(mode, pushing, mayPush()));

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

// Chooses eyes and reprojection. The number of eyes is part of the hello, so a change of it connects again.
function look(change: Partial<Pick<typeof settings, 'eyes' | 'reprojection'>>): void {
  const { eyes, reprojection } = { ...settings, ...change };
  const views = viewing.views;
  if (!viewing.choose(eyes, reprojection))
    return notices.note('This browser has no WebGL 2, which that needs.', 'error');
  Object.assign(settings, change);
  saveSettings(settings);
  size = viewing.size();
  if (viewing.views !== views && link.connected) link.reopen();
}

async function toggleHeadset(): Promise<void> {
  if (headset) return headset.end();
  try {
    headset = await Headset.start(place, {
      ask: (wish) => {
        if (link.connected && link.sendPose(wish)) statistics.sent(link.lastPose, 0);
      },
      beforeFrame: () => picture.draw(),
      ended: leaveHeadset,
    });
  } catch (error) {
    notices.note(sentence(error instanceof Error ? error.message : String(error)), 'error');
    return;
  }
  setPressed(find('tool-vr'), true);
  picture.drawOn(headset);
  if (link.connected) link.reopen();
}

function leaveHeadset(why: string): void {
  headset = undefined;
  setPressed(find('tool-vr'), false);
  picture.drawOn(viewing);
  notices.note(why);
  if (link.connected) link.reopen();
}

const actions: Record<string, () => void> = {
  orbit: () => setMode('orbit'),
  fly: () => setMode('fly'),
  push: () => setPushing(!pushing),
  pause: () => mayPush() && command({ kind: 'set', changes: [{ path: PAUSED, value: paused() ? 0 : 1 }] }),
  reset: () => (camera = fitAspect(home, aspect())), // for the shape that the window has now
  vr: () => void toggleHeadset(),
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
onKeys(keys);

// ---- panel and overlay ----

const panel = buildPanel(
  find('panel'),
  {
    command,
    camera: () => camera,
    setCap: (index) => {
      settings.cap = index;
      saveSettings(settings);
      size = viewing.size();
    },
    setQuality: (quality) => {
      settings.quality = quality;
      saveSettings(settings);
      link.reopen(); // the quality is part of the hello
    },
    setEyes: (eyes) => look({ eyes: eyes === 'side' ? 'side' : 'one' }),
    setReprojection: (way) => look({ reprojection: way === 'rotation' || way === 'plane' ? way : 'off' }),
    setPredict: (predict) => {
      settings.predict = predict;
      saveSettings(settings);
    },
    close: () => toggles.panel(false),
  },
  settings,
);
const overlay = new Overlay(find('overlay'));

function refreshOverlay(): void {
  const now = performance.now();
  overlay.update({
    fps: statistics.shownRate.perSecond(now),
    bytesPerSecond: statistics.byteRate.perSecond(now),
    roundTripMs: statistics.roundTripMs,
    latency: statistics.average.get(),
    percentiles: settings.stats ? statistics.percentiles() : undefined,
    frame: statistics.lastFrame,
    scene,
    welcome,
  });
}

// ---- once per animation frame ----

let before = performance.now();
function animate(now: number): void {
  requestAnimationFrame(animate);
  if (headset) return; // the headset's own animation frames do all of this
  picture.draw();
  controls.update(now, Math.min(0.1, Math.max(0, (now - before) / 1000)));
  before = now;
  viewing.draw();
  predictor.add(now, camera);
  const due = !sent || !same(sent.camera, camera) || sent.size !== size || now - sent.at > POSE_REFRESH_MS;
  if (due && link.connected) ask(now);
}

function ask(now: number): void {
  const lead = settings.predict ? (statistics.average.get()?.total ?? 0) : 0;
  const foreseen = (lead > 0 && predictor.predict(lead)) || camera;
  const wish = viewing.wish(foreseen, size);
  if (!link.sendPose({ ...wish, hidden: visibility.hidden })) return;
  statistics.sent(link.lastPose, movedAt === undefined ? 0 : performance.now() - movedAt);
  movedAt = undefined;
  const said = [...wish.position, ...wish.orientation, wish.fovY, wish.width, wish.height].map(Math.fround).join();
  sent = { camera, size, at: now, pose: sent?.said === said ? sent.pose : link.lastPose, said };
}

// The server draws nothing for a hidden page. Animation frames, which send the other poses, stop in it too.
const visibility = new Visibility(() => !headset && link.connected && ask(performance.now()));
document.addEventListener('visibilitychange', () => {
  statistics.answeredPose = link.lastPose; // frames of poses from before were not presented when they came
  visibility.update(document.hidden);
});

let settle: number | undefined;
new ResizeObserver(() => {
  window.clearTimeout(settle);
  settle = window.setTimeout(() => {
    const next = viewing.size();
    if (next.width !== size.width || next.height !== size.height) size = next;
  }, RESIZE_SETTLE_MS);
}).observe(canvas);

setMode('orbit');
look({});
void headsetSupported().then((supported) => (find('tool-vr').hidden = !supported));
toggles.stats(settings.stats);
toggles.panel(settings.panel);
window.setInterval(refreshOverlay, OVERLAY_MS);
requestAnimationFrame(animate);
link.start();

publishReport({
  statistics,
  viewing,
  state: () => linkState,
  viewer: () => welcome?.viewer,
  sentPose: () => (sent && same(sent.camera, camera) ? sent.pose : undefined), // undefined while a newer one is due
  camera: () => camera,
  scene: () => scene,
  values: () => values,
  headset: () => headset,
});
