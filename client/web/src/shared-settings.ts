// The settings that all viewers share, as groups of fields: one group for each table of a scene. The server describes
// them in its welcome, so that the page names none of them.
import { fromAngles, fromHex, joinIrradiance, splitIrradiance, toAngles, toHex } from './colour';
import { el } from './dom';
import { button, colour, group, select, slider, toggle } from './fields';
import type { Change, Setting, SettingValue, Vec3 } from './protocol';
import { atLeast } from './role';
import type { Role } from './role';

export type Values = ReadonlyMap<string, SettingValue>; // by path
type Send = (value: SettingValue) => void;

// The controls of one setting.
export interface Controls {
  elements: HTMLElement[];
  follow(value: SettingValue): void;
}

export interface SettingGroup {
  element: HTMLDetailsElement;
  follow(values: Values): void;
}

export const PAUSED = 'simulation.paused'; // path of the setting
const METHOD = 'render.method';
// Settings of the medium that mean nothing in a medium of a model. An unknown model has none.
const IDLE: Readonly<Record<string, readonly string[]>> = {
  sum: ['medium.union_radius', 'medium.union_extinction'],
  union: ['medium.extinction', 'medium.falloff'],
  tetrahedra: ['medium.union_radius', 'medium.union_extinction', 'medium.falloff'],
};
export const isIdle = (path: string, medium: string): boolean => IDLE[medium]?.includes(path) ?? false;

// Ratio of a slider's ends above which it is logarithmic.
const WIDE = 200;
// The light has no azimuth at 90 degrees.
const HIGHEST = 89.9;

export const sentence = (key: string): string => key.charAt(0).toUpperCase() + key.slice(1).replaceAll('_', ' ');
const keyOf = (path: string): string => path.slice(path.lastIndexOf('.') + 1);
const tableOf = (path: string): string => path.slice(0, path.lastIndexOf('.'));
const degrees = (value: number): string => `${Math.round(value)}°`;

// 1, 2 or 5 times a power of ten, at least 200 of which make up the range.
export function stepOf(range: number): number {
  const decade = 10 ** Math.floor(Math.log10(range / 200));
  return [5, 2, 1].map((times) => times * decade).find((step) => step <= range / 200) ?? decade;
}

function numberControls(setting: Setting, label: string, send: Send): Controls {
  const { usualLowest: min, usualHighest: max } = setting;
  const step = setting.kind === 'whole' ? 1 : stepOf(max - min);
  const logarithmic = setting.kind !== 'whole' && min > 0 && max / min > WIDE;
  const digits = Math.max(0, Math.ceil(-Math.log10(logarithmic ? min : step) - 1e-9));
  const field = slider({
    label,
    min,
    max,
    step,
    logarithmic,
    grows: max < setting.highest,
    format: (value) => value.toFixed(digits),
    hint: setting.unit ? `${setting.help} (${setting.unit})` : setting.help,
    change: send,
  });
  return { elements: [field.element], follow: (value) => typeof value === 'number' && field.follow(value) };
}

function colourControls(setting: Setting, label: string, send: Send): Controls {
  if (setting.highest <= 1) {
    const field = colour(label, (hex) => send(fromHex(hex)), setting.help);
    return { elements: [field.element], follow: (value) => field.follow(toHex(value as Vec3)) };
  }
  // What the fields show. A change of the colour sends the intensity too, and the other way round.
  let tint: Vec3 = [1, 1, 1];
  let intensity = 1;
  const both = (): void => send(joinIrradiance(tint, intensity));
  const strength = numberControls(setting, label, (value) => {
    intensity = value as number;
    both();
  });
  const field = colour(
    'Colour',
    (hex) => {
      tint = fromHex(hex);
      both();
    },
    setting.help,
  );
  return {
    elements: [...strength.elements, field.element],
    follow: (value) => {
      const shown = splitIrradiance(value as Vec3);
      strength.follow(shown.intensity);
      field.follow(toHex(shown.colour));
      if (shown.intensity > 0) ({ colour: tint, intensity } = shown);
    },
  };
}

function directionControls(setting: Setting, send: Send): Controls {
  let direction: Vec3 = [0, 1, 0];
  const turn = (change: { azimuth?: number; elevation?: number }): void => {
    const angles = { ...toAngles(direction), ...change };
    direction = fromAngles(angles.azimuth, Math.max(-HIGHEST, Math.min(HIGHEST, angles.elevation)));
    send(direction);
  };
  const shared = { step: 1, format: degrees, hint: setting.help };
  const azimuth = slider({
    ...shared,
    label: 'Azimuth',
    min: 0,
    max: 360,
    change: (value) => turn({ azimuth: value }),
  });
  const elevation = slider({
    ...shared,
    label: 'Elevation',
    min: -90,
    max: 90,
    change: (value) => turn({ elevation: value }),
  });
  return {
    elements: [azimuth.element, elevation.element],
    follow: (value) => {
      direction = value as Vec3;
      const angles = toAngles(direction);
      azimuth.follow(angles.azimuth);
      elevation.follow(angles.elevation);
    },
  };
}

function vectorControls(setting: Setting, label: string, send: Send): Controls {
  let shown: Vec3 = [0, 0, 0];
  const axes = (['x', 'y', 'z'] as const).map((axis, i) =>
    numberControls(setting, `${label} ${axis}`, (value) => {
      shown = shown.map((old, j) => (i === j ? (value as number) : old)) as unknown as Vec3;
      send(shown);
    }),
  );
  return {
    elements: axes.flatMap((axis) => axis.elements),
    follow: (value) => {
      shown = value as Vec3;
      axes.forEach((axis, i) => axis.follow(shown[i] ?? 0));
    },
  };
}

function textControls(setting: Setting, label: string, send: Send): Controls {
  const field = select(label, send, setting.help);
  field.options(setting.choices.map((value) => ({ value, text: value })));
  return { elements: [field.element], follow: (value) => field.follow(String(value)) };
}

function booleanControls(setting: Setting, label: string, send: Send): Controls {
  const field = toggle(label, (on) => send(on ? 1 : 0), setting.help);
  return { elements: [field.element], follow: (value) => field.follow(value === 1) };
}

// Undefined for a kind that this page does not know.
export function controlsOf(setting: Setting, send: Send): Controls | undefined {
  const label = sentence(keyOf(setting.path));
  switch (setting.kind) {
    case 'boolean':
      return booleanControls(setting, label, send);
    case 'whole':
    case 'number':
      return numberControls(setting, label, send);
    case 'vector':
      return vectorControls(setting, label, send);
    case 'colour':
      return colourControls(setting, label, send);
    case 'direction':
      return directionControls(setting, send);
    case 'text':
      return textControls(setting, label, send);
    default:
      return undefined;
  }
}

const differs = (value: SettingValue | undefined, start: SettingValue | undefined): boolean =>
  value !== undefined && start !== undefined && String(value) !== String(start);

// The changes that bring the settings back to what the scene began with, as far as `role` may make them. What is paused
// stays paused: that is no setting of the scene's look.
export function changesBack(settings: readonly Setting[], values: Values, starts: Values, role: Role): Change[] {
  return settings.flatMap(({ path, leastRole }) => {
    const start = starts.get(path);
    const due = path !== PAUSED && atLeast(role, leastRole) && differs(values.get(path), start);
    return due && start !== undefined ? [{ path, value: start }] : [];
  });
}

// The groups of all settings, in the server's order. What `role` may not change is shown, but cannot be used. The
// settings of one method (table render.NAME) are shown while that method is asked for. Those that mean nothing in
// `medium`, the model of the scene's medium, are not there. `starts`: what the scene began with. `more`: what stands
// below the settings of a table.
export function settingGroups(
  settings: readonly Setting[],
  medium: string,
  starts: Values,
  role: Role,
  send: (path: string, value: SettingValue) => void,
  more: Readonly<Record<string, readonly HTMLElement[]>>,
): SettingGroup[] {
  return [...new Set(settings.map(({ path }) => tableOf(path)))].map((table) => {
    const own = settings
      .filter(({ path }) => tableOf(path) === table && !isIdle(path, medium))
      .flatMap((setting) => {
        const controls = controlsOf(setting, (value) => send(setting.path, value));
        if (!controls) return [];
        const allowed = atLeast(role, setting.leastRole);
        for (const element of controls.elements) element.inert = !allowed;
        const start = starts.get(setting.path);
        const reset = button('↺', `${keyOf(setting.path)}: back to the scene’s value`, () => {
          if (start === undefined) return;
          send(setting.path, start);
          controls.follow(start);
        });
        reset.setAttribute('aria-label', reset.title);
        reset.className = 'reset';
        reset.hidden = true;
        const row = el('div', { class: 'setting' }, reset, ...controls.elements);
        return [{ path: setting.path, allowed, row, reset, ...controls }];
      });
    const rows = own.map((one) => one.row);
    const element = group(sentence(table.replace('.', ' · ')), true, ...rows, ...(more[table] ?? []));
    element.inert = own.every((one) => !one.allowed);
    const method = /^render\.(.+)$/.exec(table)?.[1];
    return {
      element,
      follow: (values) => {
        const asked = values.get(METHOD) as string | undefined;
        if (method !== undefined) element.hidden = asked !== method;
        for (const { path, follow, allowed, row, reset } of own) {
          const value = values.get(path);
          if (value !== undefined) follow(value);
          reset.hidden = !allowed || !differs(value, starts.get(path));
        }
      },
    };
  });
}

// The values of a report under their paths. Both lists come from one server and have one order.
export const valuesOf = (settings: readonly Setting[], values: readonly SettingValue[]): Values =>
  new Map(settings.flatMap(({ path }, i) => (values[i] === undefined ? [] : [[path, values[i]] as const])));
