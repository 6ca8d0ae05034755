// The panel: settings that all viewers share (light, medium, method, simulation), and this viewer's own (picture).
import { axes } from './camera';
import type { Camera } from './camera';
import { fromAngles, fromHex, joinIrradiance, splitIrradiance, toAngles, toHex } from './colour';
import { el, setText } from './dom';
import { button, colour, group, select, slider } from './fields';
import { planText } from './plan';
import type { Command, SceneState, Vec3, Welcome } from './protocol';
import { mayControl, mayOperate } from './role';
import type { Settings } from './settings';
import { SIZE_CAPS } from './size';

export interface PanelHost {
  command(command: Command): void;
  camera(): Camera;
  setCap(index: number): void;
  setQuality(quality: number): void;
  setEyes(eyes: string): void;
  setReprojection(way: string): void;
  setPredict(on: boolean): void;
  close(): void;
}

export interface Panel {
  welcome(welcome: Welcome, cap: number): void;
  follow(scene: SceneState): void;
}

const METHOD_NAMES: Record<string, string> = {
  auto: 'By error budget',
  slabs: 'Slabs',
  grid: 'Grid',
  tiles: 'Tiles',
  isv: 'Interval shading',
  sphere: 'Sphere proxies',
};
const QUADRATURES: Record<string, { text: string; steps: number }> = {
  simpson: { text: 'Simpson', steps: 10 },
  transmittance: { text: 'Transmittance space', steps: 3 },
  analytic: { text: 'Analytical', steps: 0 },
};
// The method that the quadratures belong to.
const FREE_QUADRATURE = 'isv';
const QUALITIES = [0, 50, 65, 80, 90, 95];
const NUDGE = 0.03; // step that moves the volume, over the camera's distance to the pivot

const degrees = (value: number): string => `${Math.round(value)}°`;
const fixed =
  (digits: number) =>
  (value: number): string =>
    value.toFixed(digits);

const KEYS = [
  ['W A S D Q E', 'fly, Shift is faster'],
  ['Arrows', 'orbit or look'],
  ['C', 'orbit or fly'],
  ['X, Ctrl, Alt', 'push while dragging'],
  ['R', 'first view'],
  ['P', 'pause for everyone'],
  ['I · O', 'statistics · settings'],
] as const;

const keyList = (): HTMLElement =>
  el('dl', { class: 'keys' }, ...KEYS.map(([key, does]) => el('div', {}, el('dt', {}, key), el('dd', {}, does))));

export function buildPanel(root: HTMLElement, host: PanelHost, chosen: Settings): Panel {
  // The light of the last report. A change of its colour sends its intensity too, and the other way round.
  let toLight: Vec3 = [0, 1, 0];
  let tint: Vec3 = [1, 1, 1];
  let intensity = 1;

  const light = (change: { azimuth?: number; elevation?: number }): void => {
    toLight = fromAngles(
      change.azimuth ?? toAngles(toLight).azimuth,
      // Not up to 90 degrees, where the light has no azimuth.
      Math.max(-89.9, Math.min(89.9, change.elevation ?? toAngles(toLight).elevation)),
    );
    host.command({ kind: 'light', toLight });
  };
  const irradiance = (): void => host.command({ kind: 'light', irradiance: joinIrradiance(tint, intensity) });

  const azimuth = slider({
    label: 'Azimuth',
    min: 0,
    max: 360,
    step: 1,
    format: degrees,
    change: (value) => light({ azimuth: value }),
  });
  const elevation = slider({
    label: 'Elevation',
    min: -90,
    max: 90,
    step: 1,
    format: degrees,
    change: (value) => light({ elevation: value }),
  });
  const strength = slider({
    label: 'Irradiance',
    min: 0,
    max: 40,
    step: 0.1,
    grows: true,
    format: fixed(1),
    hint: 'W/m² per channel on a surface that faces the light',
    change: (value) => {
      intensity = value;
      irradiance();
    },
  });
  const lightColour = colour('Colour', (hex) => {
    tint = fromHex(hex);
    irradiance();
  });
  const rotate = slider({
    label: 'Rotation',
    min: -2,
    max: 2,
    step: 0.05,
    format: (value) => value.toFixed(2),
    hint: 'Radians a second about the vertical',
    change: (value) => host.command({ kind: 'light', rotate: value }),
  });

  const extinction = slider({
    label: 'Extinction',
    min: 0,
    max: 100,
    step: 0.5,
    grows: true,
    format: fixed(1),
    change: (value) => host.command({ kind: 'medium', extinction: value }),
  });
  const falloff = slider({
    label: 'Falloff',
    min: 0.1,
    max: 10,
    step: 0.05,
    format: fixed(2),
    hint: 'How softly a particle fades toward its edge',
    change: (value) => host.command({ kind: 'medium', falloff: value }),
  });
  const albedo = colour('Albedo', (hex) => host.command({ kind: 'medium', albedo: fromHex(hex) }));
  const anisotropy = slider({
    label: 'Anisotropy',
    min: 0,
    max: 1,
    step: 0.01,
    format: fixed(2),
    hint: 'How much of the scattered light prefers a direction',
    change: (value) => host.command({ kind: 'medium', anisotropy: value }),
  });
  const asymmetry = slider({
    label: 'Asymmetry',
    min: -0.95,
    max: 0.95,
    step: 0.01,
    format: fixed(2),
    hint: 'Backward (below 0) or forward scattering',
    change: (value) => host.command({ kind: 'medium', asymmetry: value }),
  });

  const method = select('Method', (value) => host.command({ kind: 'render', method: value }));
  const quadrature = select('Quadrature', (value) => host.command({ kind: 'render', quadrature: value }));
  const steps = slider({
    label: 'Steps',
    min: 1,
    max: 10,
    step: 1,
    format: fixed(0),
    change: (value) => host.command({ kind: 'render', steps: value }),
  });
  const exposure = slider({
    label: 'Exposure',
    min: 0.05,
    max: 20,
    step: 0.01,
    logarithmic: true,
    format: (value) => `${value.toFixed(2)}×`,
    change: (value) => host.command({ kind: 'render', exposure: value }),
  });

  const plan = el('small', {
    id: 'plan',
    title: 'What is rendered with now, its predicted error, and how many steps of accuracy overload has taken',
  });

  let paused = false;
  const pause = button('Pause', 'Stop the particles, for everyone', () =>
    host.command({ kind: 'simulation', paused: !paused }),
  );
  const restart = button('Restart', 'Start the scene again, for everyone', () => host.command({ kind: 'restart' }));
  const nudge = (text: string, title: string, side: number, up: number, ahead: number): HTMLButtonElement =>
    button(text, title, () => {
      const camera = host.camera();
      const { right, forward } = axes(camera);
      const step = NUDGE * camera.distance;
      const flat = Math.hypot(forward[0], forward[2]) || 1;
      const x = (right[0] * side + (forward[0] / flat) * ahead) * step;
      const z = (right[2] * side + (forward[2] / flat) * ahead) * step;
      host.command({ kind: 'move', offset: [x, up * step, z] });
    });
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

  const size = select('Size', (value) => host.setCap(Number(value)));
  size.options(
    SIZE_CAPS.map(({ name, width, height }, index) => ({ value: String(index), text: `${name} · ${width}×${height}` })),
  );
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
    { value: 'off', text: 'Off' },
    { value: 'rotation', text: 'Turns, what is far stays' },
    { value: 'plane', text: 'Turns and moves, the middle stays' },
  ]);
  reprojection.follow(chosen.reprojection);
  const predict = select('Prediction', (value) => host.setPredict(value === 'on'));
  predict.options([
    { value: 'off', text: 'Off' },
    { value: 'on', text: 'Asks for where you will be' },
  ]);
  predict.follow(chosen.predict ? 'on' : 'off');

  const close = button('×', 'Close (O)', () => host.close());
  close.className = 'close';
  close.setAttribute('aria-label', 'Close settings');
  const shared = [
    group('Light', true, azimuth.element, elevation.element, strength.element, lightColour.element, rotate.element),
    group('Medium', true, extinction.element, falloff.element, albedo.element, anisotropy.element, asymmetry.element),
    group('Cloud', true, el('div', { class: 'actions' }, pause, restart), nudges),
  ];
  const rendering = group('Method', true, method.element, plan, quadrature.element, steps.element, exposure.element);
  root.append(
    el('header', {}, el('h2', {}, 'Settings'), el('small', {}, 'shared by all viewers'), close),
    ...shared.slice(0, 2),
    rendering,
    ...shared.slice(2),
    group(
      'Picture, yours alone',
      true,
      size.element,
      quality.element,
      eyes.element,
      reprojection.element,
      predict.element,
    ),
    group('Keys', false, keyList()),
  );

  return {
    welcome: (welcome, cap) => {
      size.follow(String(cap));
      for (const part of shared) part.inert = !mayControl(welcome.role);
      rendering.inert = !mayOperate(welcome.role);
      restart.disabled = !mayOperate(welcome.role);
      method.options(welcome.methods.map((value) => ({ value, text: METHOD_NAMES[value] ?? value })));
      quadrature.options(welcome.quadratures.map((value) => ({ value, text: QUADRATURES[value]?.text ?? value })));
    },
    follow: (scene) => {
      const { colour: shown, intensity: power } = splitIrradiance(scene.irradiance);
      toLight = scene.toLight;
      const angles = toAngles(toLight);
      azimuth.follow(angles.azimuth);
      elevation.follow(angles.elevation);
      strength.follow(power);
      lightColour.follow(toHex(shown));
      if (power > 0) [tint, intensity] = [shown, power];
      rotate.follow(scene.rotate);
      extinction.follow(scene.extinction);
      falloff.follow(scene.falloff);
      albedo.follow(toHex(scene.albedo));
      anisotropy.follow(scene.anisotropy);
      asymmetry.follow(scene.asymmetry);
      method.follow(scene.method);
      quadrature.follow(scene.quadrature);
      const most = QUADRATURES[scene.quadrature]?.steps ?? 10;
      const free = scene.method === FREE_QUADRATURE;
      quadrature.enable(free);
      steps.enable(free && most > 0);
      steps.range(Math.max(most, 1));
      steps.follow(scene.steps);
      exposure.follow(scene.exposure);
      setText(plan, planText(scene));
      paused = scene.paused;
      pause.textContent = paused ? 'Resume' : 'Pause';
      pause.setAttribute('aria-pressed', String(paused));
    },
  };
}
