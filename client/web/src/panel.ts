// The panel: settings that all viewers share (light, medium, method, simulation), and this viewer's own (picture).
import { axes } from './camera';
import type { Camera } from './camera';
import { el, setText } from './dom';
import { button, group, select, toggle } from './fields';
import type { Choosable } from './handle';
import { listGroup } from './lists';
import type { ListGroup } from './lists';
import { planText } from './plan';
import type { ErrorLine } from './plan';
import type { People } from './people';
import type { RoomsPanel } from './rooms';
import { peoplePanel } from './people-panel';
import type { Command, Plan, SettingValue, Welcome } from './protocol';
import { mayOperate } from './role';
import { UNITS, UPS } from './scenes';
import type { FileFrame } from './scenes';
import type { Still } from './save-picture';
import type { Settings } from './settings';
import { settingGroups, valuesOf } from './shared-settings';
import type { SettingGroup, Values } from './shared-settings';
import { SIZE_CAPS } from './size';
import { VIEWS, VIEW_TEXTS, viewOf, viewText } from './views';
import type { View } from './views';

const AUTOMATIC = 'auto'; // of the sizes
const IRRADIANCE = 'light.irradiance'; // path of the sun's

export interface PanelHost {
  command(command: Command): void;
  camera(): Camera;
  people(): People;
  rooms: RoomsPanel;
  setCap(index: number | undefined): void; // undefined: automatic
  setQuality(quality: number): void;
  setEyes(eyes: string): void;
  setReprojection(way: string): void;
  setDraw(wish: string): void;
  compare(): void; // what is drawn here with the server's picture
  setPredict(on: boolean): void;
  setBox(on: boolean): void;
  setView(view: View): void;
  showScene(name: string): void;
  openCloud(): void;
  saveScene(): void;
  resetAll(): void;
  undo(): void;
  savePicture(kind: Still): void;
  close(): void;
}

export interface Panel {
  welcome(welcome: Welcome, cap: number | undefined): void;
  // `changed`: true if a setting that this viewer may change is not as the scene began.
  // `error`: of what is shown, if it is measured.
  follow(values: Values, inUse: Plan | undefined, error: ErrorLine | undefined, changed: boolean): void;
  people(): void; // people have changed
  drawn(here: boolean): void; // whether what is shown is drawn here
  follows(own: Settings): void; // what is this viewer's own
  lists(elements: readonly (readonly Values[])[]): void; // of Welcome.lists, in that order
  handles(age: number): Choosable[]; // of the lists that are open; `age`: of what was told of them, s
  scene(name: string): void; // the one that is shown
  undoable(what: string | undefined): void; // what an undo would do; undefined: nothing
  busy(text: string): void; // what is being done with the scene; empty: nothing
  fileFrame(): FileFrame; // of a file that is opened next
}

const QUALITIES = [0, 50, 65, 80, 90, 95];
const NUDGE = 0.03; // step that moves the volume, over the camera's distance to the pivot

const KEYS = [
  ['W A S D Q E', 'fly, Shift is faster'],
  ['Arrows', 'orbit or look; with Push: push'],
  ['C', 'orbit or fly'],
  ['X', 'Push on or off'],
  ['Ctrl, Alt', 'push while dragging'],
  ['T', 'point at something for everyone'],
  ['R', 'first camera'],
  ['B', 'box, scale and axes'],
  ['P', 'pause for everyone'],
  ['L', 'copy a link with this camera'],
  ['K · V', 'add a key view · play the key views'],
  ['Ctrl Z', 'undo the last change, for everyone'],
  ['I · O', 'statistics · settings'],
] as const;

const keyList = (): HTMLElement =>
  el('dl', { class: 'keys' }, ...KEYS.map(([key, does]) => el('div', {}, el('dt', {}, key), el('dd', {}, does))));

// `keyViews`: their group.
export function buildPanel(root: HTMLElement, host: PanelHost, chosen: Settings, keyViews: HTMLElement): Panel {
  const plan = el('small', {
    id: 'plan',
    title: 'What is rendered with now, its predicted error, and how many steps of accuracy overload has taken',
  });
  const measured = el('small', {
    id: 'measured',
    title: 'The error of your pictures of the last half minute, measured, with its bounds of 95 %',
  });

  const restart = button('Restart', 'Start the scene again, for everyone', () => host.command({ kind: 'restart' }));
  const nudge = (text: string, title: string, side: number, up: number, ahead: number): HTMLButtonElement => {
    const element = button(text, title, () => {
      const camera = host.camera();
      const { right, forward } = axes(camera);
      const step = NUDGE * camera.distance;
      const flat = Math.hypot(forward[0], forward[2]) || 1;
      const x = (right[0] * side + (forward[0] / flat) * ahead) * step;
      const z = (right[2] * side + (forward[2] / flat) * ahead) * step;
      host.command({ kind: 'move', offset: [x, up * step, z] });
    });
    element.setAttribute('aria-label', title);
    return element;
  };
  const nudges = el(
    'div',
    { class: 'nudges', role: 'group', 'aria-label': 'Move the cloud' },
    el('span', {}, 'Move'),
    nudge('←', 'Left', -1, 0, 0),
    nudge('→', 'Right', 1, 0, 0),
    nudge('↑', 'Up', 0, 1, 0),
    nudge('↓', 'Down', 0, -1, 0),
    nudge('↗', 'Away from you', 0, 0, 1),
    nudge('↙', 'Toward you', 0, 0, -1),
  );

  const size = select('Size', (value) => host.setCap(value === AUTOMATIC ? undefined : Number(value)));
  size.options([
    { value: AUTOMATIC, text: 'Automatic' },
    ...SIZE_CAPS.map(({ name, width, height }, index) => ({
      value: String(index),
      text: `${name} · ${width}×${height}`,
    })),
  ]);
  const quality = select('Quality', (value) => host.setQuality(Number(value)));
  quality.options(QUALITIES.map((q) => ({ value: String(q), text: q === 0 ? 'Server’s choice' : String(q) })));
  quality.follow(String(chosen.quality));
  const eyes = select('Eyes', (value) => host.setEyes(value));
  eyes.options([
    { value: 'one', text: 'One' },
    { value: 'side', text: 'Two, side by side' },
  ]);
  eyes.follow(chosen.eyes);
  const reprojection = select('Reprojection', (value) => host.setReprojection(value));
  reprojection.options([
    { value: 'auto', text: 'Automatic' },
    { value: 'off', text: 'Off' },
    { value: 'rotation', text: 'Turns, what is far stays' },
    { value: 'plane', text: 'Turns and moves, the middle stays' },
    { value: 'layers', text: 'Turns and moves, by layers with depth' },
  ]);
  reprojection.follow(chosen.reprojection);
  const draw = select('Drawing', (value) => host.setDraw(value));
  draw.options([
    { value: 'auto', text: 'Automatic' },
    { value: 'client', text: 'Here, by this device' },
    { value: 'server', text: 'By the server' },
  ]);
  draw.follow(chosen.draw);
  const compare = button('Compare', 'What is drawn here beside the server’s picture', () => host.compare());
  compare.hidden = true;
  const predict = select('Prediction', (value) => host.setPredict(value === 'on'));
  predict.options([
    { value: 'off', text: 'Off' },
    { value: 'on', text: 'Asks for where you will be' },
  ]);
  predict.follow(chosen.predict ? 'on' : 'off');

  const view = select('View', (value) => host.setView(viewOf(value)));
  view.options(VIEWS.map((value) => ({ value, text: VIEW_TEXTS[value][0] })));
  const viewSays = el('small', { role: 'status' });
  let irradiance: SettingValue | undefined; // of the sun
  let viewed: View = chosen.view;
  const sayView = (): void => setText(viewSays, viewText(viewed, irradiance));
  const box = toggle('Box, scale', (on) => host.setBox(on), 'The medium’s box, a scale in metres, and the axes (B)');

  const stills = (
    [
      ['png', 'Save picture', 'As a PNG, with the box, scale and axes where they are shown'],
      ['cut', 'Without sky', 'As a PNG with alpha: the medium over nothing'],
      ['exr', 'EXR', 'Linear radiance and alpha, without the sky'],
    ] as const
  ).map(([kind, text, title]) => button(text, title, () => host.savePicture(kind)));

  const scene = select('Scene', (name) => host.showScene(name), 'What everybody sees');
  const open = button(
    'Open file…',
    'Show a point cloud or volume of yours (PLY, NRRD) to everyone; or drop the file here',
    () => host.openCloud(),
  );
  const frame: FileFrame = { unit: 'auto', up: 'y' };
  const unit = select('File’s unit', (value) => (frame.unit = value), 'Of a file that is opened or dropped');
  unit.options(UNITS.map((value) => ({ value, text: value })));
  const up = select('File’s up axis', (value) => (frame.up = value), 'Of a file that is opened or dropped');
  up.options(UPS.map((value) => ({ value, text: value })));
  const save = button('Save TOML', 'The scene as it is set now, with this camera, as a file', () => host.saveScene());
  const reset = button('Reset all', 'All settings back to what the scene began with', () => host.resetAll());
  reset.disabled = true;
  const undo = button('Undo', 'Nothing to undo', () => host.undo());
  undo.disabled = true;
  const doing = el('small'); // a note says the same

  const close = button('', 'Close (O)', () => host.close());
  close.append(el('span', { 'aria-hidden': 'true' }, '×'));
  close.className = 'close';
  close.setAttribute('aria-label', 'Close settings');
  // Groups of the server's settings stand here.
  const place = el('div', { class: 'shared' });
  let shared: SettingGroup[] = [];
  let lists: ListGroup[] = [];
  const actions = el('div', { class: 'actions' }, open, save, reset, undo);
  const scenes = group('Scene', true, scene.element, unit.element, up.element, actions, doing);
  const people = peoplePanel(host.people);
  root.append(
    el('header', {}, el('h2', {}, 'Settings'), el('small', {}, 'shared by all viewers'), close),
    scenes,
    people.element,
    host.rooms.element,
    place,
    group(
      'Picture, yours alone',
      true,
      size.element,
      quality.element,
      eyes.element,
      reprojection.element,
      draw.element,
      el('div', { class: 'actions' }, compare),
      predict.element,
      box.element,
      view.element,
      viewSays,
      el('div', { class: 'actions' }, ...stills),
    ),
    keyViews,
    group('Keys', false, keyList()),
  );

  return {
    welcome: (welcome, cap) => {
      size.follow(cap === undefined ? AUTOMATIC : String(cap));
      const send = (path: string, value: SettingValue): void =>
        host.command({ kind: 'set', changes: [{ path, value }] });
      const operates = mayOperate(welcome.role);
      scene.options([...new Set([...welcome.scenes, welcome.scene])].map((value) => ({ value, text: value })));
      scene.follow(welcome.scene, true);
      scene.element.inert = unit.element.inert = up.element.inert = open.disabled = !operates;
      const starts = valuesOf(welcome.settings, welcome.starts);
      shared = settingGroups(welcome.settings, welcome.medium, starts, welcome.role, send, {
        render: [plan, measured],
        simulation: [el('div', { class: 'actions' }, restart), nudges],
      });
      lists = welcome.lists.map((list) => listGroup(list, welcome.role, host.camera, host.command));
      place.replaceChildren(...[...shared, ...lists].map(({ element }) => element));
      restart.disabled = !operates;
      host.rooms.update();
    },
    follow: (values, inUse, error, changed) => {
      reset.disabled = !changed;
      for (const one of shared) one.follow(values);
      irradiance = values.get(IRRADIANCE);
      sayView();
      setText(plan, planText(values.get('render.method') as string | undefined, inUse));
      setText(measured, error ? `measured ${error.text}` : '');
      measured.classList.toggle('broken', error?.broken ?? false);
    },
    people: people.update,
    drawn: (here) => (compare.hidden = !here),
    follows: (own) => {
      box.follow(own.box);
      view.follow(own.view);
      viewed = own.view;
      sayView();
    },
    lists: (elements) => lists.forEach((list, i) => list.follow(elements[i] ?? [])),
    handles: (age) => (root.hidden ? [] : lists.flatMap((list) => list.handles(age))),
    scene: (name) => scene.follow(name, true),
    busy: (text) => setText(doing, text),
    undoable: (what) => {
      undo.disabled = what === undefined;
      undo.title = what === undefined ? 'Nothing to undo' : `For everyone: ${what} (Ctrl+Z)`;
    },
    fileFrame: () => frame,
  };
}
