// The page around the view: settings, statistics, notices, tools and keys.
import { reprojectionOf } from './viewing';
import { BrumeView, defineBrumeView } from './brume-view';
import { pathText } from './camera-keys';
import { compare } from './compare';
import { onKeys } from './controls';
import type { Mode } from './controls';
import { find, setPressed, setText } from './dom';
import { drawWishOf } from './draw-choice';
import { Age } from './handle';
import { Handles } from './handles';
import { headsetSupported } from './headset';
import { hintText } from './hint';
import { KeyViews, pathAsked, useLens } from './key-views';
import { Kiosk, kioskOf } from './kiosk';
import { copyLink } from './link';
import { elementsOf } from './lists';
import { LiveLine } from './live-line';
import { keepCamera, keptCamera } from './memory';
import { addressAt, cameraIn } from './move';
import { Notices } from './notices';
import { Overlay } from './overlay';
import { buildPanel } from './panel';
import { keptName, leaderText } from './people-panel';
import { placeOf } from './place';
import { shownError } from './plan';
import { Pointing } from './pointing';
import type { Report } from './report';
import { keepToken, mayOperate, takeToken } from './role';
import { RoomsPanel } from './rooms';
import { doing, saveScene, saveStill } from './saving';
import { sentence } from './sentence';
import { followAddress, loadSettings, saveSettings, settingsText } from './settings';
import { Scenes, chooseFile, cloudName, onDrop } from './scenes';
import { PAUSED, changesBack, valuesOf } from './shared-settings';
import type { Values } from './shared-settings';
import { SIZE_CAPS } from './size';
import { onUndo, undoLast } from './undo';
import type { Viewer } from './viewer';
import { legendPart } from './views';

const REFRESH_MS = 250;

const sentHere = cameraIn(location.hash); // camera of a viewer that another server sent here
const first = takeToken(); // attributes keep it: another one makes the view anew
let token = first; // the newest
if (sentHere) history.replaceState(history.state, '', location.pathname + location.search);

const settings = loadSettings();
const notices = new Notices(() => viewer().link.retryNow());
const query = new URLSearchParams(location.search);
const { place, faults } = placeOf((name) => query.get(name));
faults.push(...followAddress(settings, location.search));
let path = pathAsked(query, faults); // of the first scene
if (faults.length > 0) notices.note(faults.join(' '), 'error');
const alone = kioskOf(query);
const kiosk = alone && new Kiosk(() => view.viewer?.link, [...faults, ...alone.faults]);

// ---- the view ----

const view = find<BrumeView>('view');
view.addEventListener('statechange', ({ detail: state }) => {
  notices.link(state);
  kiosk?.follow(state);
  if (state.name !== 'connected') notices.standstill(undefined); // nobody says so any more
});
view.addEventListener('note', ({ detail: { text, kind } }) => notices.note(text, kind));
view.addEventListener('touched', () => {
  document.body.classList.add('touched');
  keyViews.stop();
});
view.addEventListener('picture', ({ detail: { frame, latency } }) => {
  document.body.style.setProperty('--legend-part', String(legendPart(frame)));
  if (latency) overlay.sample(latency);
  notices.picture();
});
view.addEventListener('drawn', () => notices.picture());
let sceneName: string | undefined;
let elements: Values[][] = []; // of the scene's lists, as last reported
let age = new Age(); // of those
view.addEventListener('welcome', ({ detail: welcome }) => {
  if (sceneName !== undefined && sceneName !== welcome.scene) notices.note(`Another scene is shown: ${welcome.scene}.`);
  if (sceneName !== welcome.scene) keyViews.use(path ?? welcome.path);
  path = undefined;
  sceneName = welcome.scene;
  elements = [];
  age = new Age(welcome.tickHz);
  panel.welcome(welcome, settings.cap);
  setText(find('brand-scene'), welcome.scene);
  panel.people();
  setText(find('leader'), '');
});
view.addEventListener('scenechange', ({ detail: scene }) => {
  const { values, statistics } = viewer();
  if (scene.lists)
    elements = (viewer().welcome?.lists ?? []).map((list, i) => elementsOf(list, scene.lists?.[i] ?? []));
  age.report(scene.tick, paused(), scene.lists !== undefined);
  panel.lists(elements);
  panel.undoable(viewer().mayControl ? scene.undo : undefined);
  const error = statistics.last?.measured && shownError(statistics.last, scene.plan);
  panel.follow(values, scene.plan, error, settingsBack().length > 0);
  setPressed(find('tool-pause'), paused());
  notices.standstill(scene.standstill);
  tellLack();
});
view.addEventListener('modechange', showMode);
view.addEventListener('people', () => {
  if (!view.viewer) return;
  panel.people();
  setText(find('leader'), leaderText(viewer().people));
});
view.addEventListener('token', ({ detail }) => keepToken((token = detail.token)));
view.addEventListener('moved', (event) => {
  event.preventDefault(); // the whole page goes there, not the view alone
  location.assign(addressAt(event.detail.page, location.search, token, viewer().camera));
});

function attributes(): Record<string, string | undefined> {
  const cap = settings.cap === undefined ? undefined : SIZE_CAPS[settings.cap];
  const named = ['position', 'target', 'fov'].filter((name) => name in place);
  return {
    ...Object.fromEntries(named.map((name) => [name, query.get(name) ?? undefined])),
    token: first,
    'token-url': query.get('token_url') ?? undefined,
    quality: String(settings.quality),
    size: cap && `${cap.width}x${cap.height}`,
    eyes: settings.eyes,
    reproject: settings.reprojection,
    draw: settings.draw,
    predict: settings.predict ? '' : undefined,
    box: settings.box ? '' : undefined,
    view: settings.view,
    name: keptName() || undefined,
    ...alone?.attributes,
  };
}

function apply(): void {
  document.body.classList.toggle('viewed', settings.view !== 'picture');
  for (const [name, value] of Object.entries(attributes())) {
    if (value === undefined) view.removeAttribute(name);
    else view.setAttribute(name, value);
  }
}

// It has a src from the beginning on, so there is one.
const viewer = (): Viewer => view.viewer as Viewer;
const paused = (): boolean => viewer().values.get(PAUSED) === 1;

// ---- tools and keys ----

function showMode(): void {
  if (!view.viewer) return; // it is being made
  const { mode, pushing, mayPush, headset } = viewer();
  setPressed(find('tool-orbit'), mode === 'orbit');
  setPressed(find('tool-fly'), mode === 'fly');
  setPressed(find('tool-push'), pushing);
  setPressed(find('tool-vr'), headset?.mode === 'vr');
  setPressed(find('tool-ar'), headset?.mode === 'ar');
  find<HTMLButtonElement>('tool-push').disabled = !mayPush;
  find<HTMLButtonElement>('tool-pause').disabled = !viewer().mayControl;
  find<HTMLButtonElement>('tool-point').disabled = !viewer().people.there;
  setPressed(find('tool-point'), pointing.on);
  document.body.classList.toggle('pushing', pushing);
  document.body.classList.toggle('pointing', pointing.on);
  setText(find('hint'), hintText(mode, pushing, mayPush));
}

const pointing = new Pointing(view, viewer);
const setMode = (mode: Mode): void => viewer().setMode(mode);

const toggles = {
  stats: (on: boolean): void => {
    settings.stats = on;
    find('overlay').hidden = !on;
    setPressed(find('tool-stats'), on);
    saveSettings(settings);
    refresh();
  },
  panel: (on: boolean): void => {
    settings.panel = on;
    if (!on && find('panel').contains(document.activeElement)) find('tool-panel').focus();
    find('panel').hidden = !on;
    setPressed(find('tool-panel'), on);
    saveSettings(settings);
  },
};

const actions: Record<string, () => void> = {
  orbit: () => setMode('orbit'),
  fly: () => setMode('fly'),
  push: () => (viewer().pushing = !viewer().pushing),
  point: () => {
    pointing.on = !pointing.on;
    showMode();
  },
  pause: () =>
    viewer().mayControl && viewer().command({ kind: 'set', changes: [{ path: PAUSED, value: paused() ? 0 : 1 }] }),
  reset: () => {
    keyViews.stop();
    useLens(viewer(), place.fov);
    viewer().goHome();
  },
  link: () => {
    const path: [string, string][] = keyViews.keys.length > 0 ? [['path', pathText(keyViews.keys)]] : [];
    const more = [...settingsText(settings), ...path];
    void copyLink(viewer().camera, viewer().fovY, more).then((text) => notices.note(text));
  },
  key: () => keyViews.add(),
  play: () => keyViews.toggle(),
  undo: () => undoLast(viewer(), (text) => notices.note(text)),
  box: () => change({ box: !settings.box }),
  vr: () => void viewer().toggleHeadset(),
  ar: () => void viewer().toggleHeadset('ar'),
  stats: () => toggles.stats(!settings.stats),
  panel: () => toggles.panel(!settings.panel),
};
for (const [name, action] of Object.entries(actions))
  document.getElementById(`tool-${name}`)?.addEventListener('click', action);

if (!kiosk) {
  onKeys({
    KeyC: () => setMode(viewer().mode === 'orbit' ? 'fly' : 'orbit'),
    KeyX: () => actions['push']?.(),
    KeyT: () => actions['point']?.(),
    KeyP: () => actions['pause']?.(),
    KeyR: () => actions['reset']?.(),
    KeyB: () => actions['box']?.(),
    KeyL: () => actions['link']?.(),
    KeyK: () => actions['key']?.(),
    KeyV: () => actions['play']?.(),
    KeyI: () => actions['stats']?.(),
    KeyO: () => actions['panel']?.(),
    Escape: () => (viewer().pushing ? (viewer().pushing = false) : toggles.panel(false)),
  });
  onUndo(() => actions['undo']?.());
}

function change(wish: Partial<typeof settings>): void {
  const was = { ...settings };
  Object.assign(settings, wish);
  apply();
  // What this browser cannot do, the view has refused.
  const { eyes, wished } = viewer().viewing;
  if (eyes !== settings.eyes || wished !== settings.reprojection) {
    Object.assign(settings, was);
    apply();
  }
  saveSettings(settings);
  panel.follows(settings);
}

// ---- scenes ----

const scenes = new Scenes(location.href, () => token);
const settingsBack = () => {
  const { welcome, values } = viewer();
  if (!welcome) return [];
  return changesBack(welcome.settings, values, valuesOf(welcome.settings, welcome.starts), welcome.role);
};
const mayChoose = (): boolean => mayOperate(viewer().welcome?.role ?? 'viewer');

const tells = {
  busy: (text: string) => panel.busy(text),
  note: (text: string, kind?: 'info' | 'error') => notices.note(text, kind),
  failed: () => viewer().welcome && panel.scene(viewer().welcome?.scene ?? ''),
};
const does = (what: string, work: Promise<unknown>): void => void doing(what, work, tells);

const showCloud = (file: File): void =>
  does(`Uploading ${file.name} as “${cloudName(file.name)}”…`, scenes.showCloud(file, panel.fileFrame()));
onDrop(
  () => !kiosk && mayChoose(),
  (over) => document.body.classList.toggle('dropping', over),
  showCloud,
);

// ---- panel and overlay ----

const keyViews = new KeyViews({
  camera: () => viewer().camera,
  fovY: () => viewer().fovY,
  look: (camera, fov) => {
    if (!viewer().people.takesBack()) return keyViews.stop(); // somebody presents
    viewer().camera = camera;
    useLens(viewer(), fov);
  },
  note: (text, kind) => notices.note(text, kind),
  copyLink: () => actions['link']?.(),
  playing: (on, possible) => {
    find('tool-play').hidden = !possible;
    setPressed(find('tool-play'), on);
  },
});

const panel = buildPanel(
  find('panel'),
  {
    command: (order) => viewer().command(order),
    camera: () => viewer().camera,
    people: () => viewer().people,
    rooms: new RoomsPanel({
      token: () => token,
      mayOpen: mayChoose,
      scenes: () => viewer().welcome?.scenes ?? [],
      note: (text, kind) => notices.note(sentence(text), kind),
    }),
    setCap: (cap) => change({ cap }),
    setQuality: (quality) => change({ quality }),
    setEyes: (eyes) => change({ eyes: eyes === 'side' ? 'side' : 'one' }),
    setReprojection: (way) => change({ reprojection: reprojectionOf(way) }),
    setDraw: (wish) => change({ draw: drawWishOf(wish) }),
    compare: () =>
      void compare(viewer(), token).catch((error: unknown) => notices.note(sentence(String(error)), 'error')),
    setPredict: (predict) => change({ predict }),
    setBox: (box) => change({ box }),
    setView: (view) => change({ view }),
    showScene: (name) => does(`Loading ${name}…`, scenes.show(name)),
    openCloud: () => chooseFile(showCloud),
    saveScene: () => does('Saving the scene…', saveScene(viewer(), scenes, keyViews.keys)),
    undo: () => actions['undo']?.(),
    savePicture: (kind) => does('Saving the picture…', saveStill(kind, viewer(), view, settings, token)),
    resetAll: () => viewer().command({ kind: 'set', changes: settingsBack() }),
    close: () => toggles.panel(false),
  },
  settings,
  keyViews.element,
);
const handles = new Handles(find('handles'), {
  handles: () =>
    viewer().linkState === 'connected' ? panel.handles(age.at(viewer().statistics.last?.tick ?? 0n)) : [],
  eye: () => {
    const { viewing, fovY, headset } = viewer();
    return viewing.shown && viewing.parts === 1 && !headset ? { ...viewing.shown, fovY } : undefined;
  },
  lens: () => ({ camera: viewer().camera, fovY: viewer().fovY, height: view.clientHeight }),
  free: ({ x, y }) => document.elementFromPoint(x, y)?.matches('#view, #handles *') ?? false,
  move: (path, value) => viewer().command({ kind: 'set', changes: [{ path, value }] }),
});
const overlay = new Overlay(find('overlay'));
const liveLine = new LiveLine((lacking, live) => notices.lack(lacking, live));
const tellLack = (): void => liveLine.tell(viewer(), settings.draw === 'client');

function animate(): void {
  requestAnimationFrame(animate);
  if (!view.viewer) return;
  keyViews.animate(performance.now());
  handles.draw();
}

function refresh(): void {
  if (!view.viewer) return;
  const { statistics, scene, welcome, drawing } = viewer();
  panel.drawn(drawing.shown);
  const now = performance.now();
  overlay.update({
    fps: (drawing.shown ? drawing.rate : statistics.shownRate).perSecond(now),
    bytesPerSecond: statistics.byteRate.perSecond(now),
    roundTripMs: statistics.roundTripMs,
    latency: statistics.average.get(),
    percentiles: settings.stats ? statistics.percentiles() : undefined,
    shown: statistics.last,
    drawn: drawing.drawn,
    scene,
    welcome,
  });
  tellLack();
}

// ---- beginning and end ----

apply();
defineBrumeView();
view.arrived = sentHere ? { camera: sentHere } : keptCamera();
view.setAttribute('src', location.href);
showMode();
window.addEventListener('pagehide', () => {
  const { welcome, camera } = viewer();
  if (welcome) keepCamera(welcome.scene, camera);
});
for (const mode of ['vr', 'ar'] as const)
  void headsetSupported(mode).then((supported) => (find(`tool-${mode}`).hidden = !supported));
toggles.stats(settings.stats);
toggles.panel(settings.panel);
panel.follows(settings);
window.setInterval(refresh, REFRESH_MS);
requestAnimationFrame(animate);

declare global {
  interface Window {
    readonly brume: Report;
  }
}
Object.defineProperty(window, 'brume', { get: () => view.report });
