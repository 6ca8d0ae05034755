// The lists of the scene that all viewers share, lights and fogs for example: a group for each, where one element is
// chosen, changed, added or removed. The server describes the elements' settings in its welcome.
import type { Camera } from './camera';
import { pivot } from './camera';
import { el } from './dom';
import { button, group, select } from './fields';
import type { Choosable, Handle } from './handle';
import type { Change, Command, List, Setting, SettingValue, Vec3 } from './protocol';
import { atLeast } from './role';
import type { Role } from './role';
import { controlsOf, sentence } from './shared-settings';
import type { Controls, Values } from './shared-settings';

interface Row {
  setting: Setting;
  row: HTMLElement;
  controls: Controls;
}

export interface ListGroup {
  element: HTMLDetailsElement;
  follow(elements: readonly Values[]): void;
  handles(age: number): Choosable[]; // of the elements, while the group is open and the viewer may move them
}

// The key of a setting that is one element's kind; it stands beside the element's number.
const TYPE = 'type';
// Keys of settings that are an element's place.
const PLACES = ['position', 'centre'];
// Elements of a list up to which each has a handle; of more, the chosen one alone has.
const MOST_HANDLES = 128;
// Irradiance that a light adds where the camera looks, and optical depth of a fog, when they are new.
const NEW_IRRADIANCE = 10; // W/m²
const NEW_DEPTH = 1.5;

const widthOf = ({ kind }: Setting): number => (kind === 'vector' || kind === 'colour' || kind === 'direction' ? 3 : 1);

// The elements of a list from the numbers of a report: by setting, under their paths without an index.
export function elementsOf(list: List, values: readonly number[]): Values[] {
  const width = list.settings.reduce((sum, setting) => sum + widthOf(setting), 0);
  const count = width > 0 ? Math.floor(values.length / width) : 0;
  return Array.from({ length: count }, (_, element) => {
    let at = element * width;
    return new Map(
      list.settings.map((setting) => {
        const own = values.slice(at, (at += widthOf(setting)));
        const [x = 0, y = 0, z = 0] = own;
        const value: SettingValue =
          own.length === 3 ? [x, y, z] : setting.kind === 'text' ? (setting.choices[x] ?? '') : x;
        return [setting.path, value] as const;
      }),
    );
  });
}

// What a new element begins with, so that it is seen: where the camera looks, a light above that, and as large as suits
// the distance.
export function beginnings(list: List, camera: Camera): Change[] {
  const [x, y, z] = pivot(camera);
  const size = camera.distance / 4;
  const all: Change[] = [
    { path: 'light.position', value: [x, y + size, z] },
    { path: 'light.intensity', value: [1, 1, 1].map(() => NEW_IRRADIANCE * size * size) as [number, number, number] },
    { path: 'fog.centre', value: [x, y, z] },
    { path: 'fog.radius', value: size },
    { path: 'fog.extinction', value: NEW_DEPTH / size },
    { path: 'box.centre', value: [x, y, z] },
    { path: 'box.size', value: [size / 2, size / 2, size / 2] },
    { path: 'sphere.centre', value: [x, y, z] },
    { path: 'sphere.radius', value: size / 4 },
  ];
  const known = new Set(list.settings.map(({ path }) => path));
  return all.filter(({ path }) => known.has(path));
}

// True: elements of this kind have the setting.
const applies = (setting: Setting, type: SettingValue | undefined): boolean =>
  setting.onlyType === '' || type === undefined || setting.onlyType === type;

// Where a light that goes round the vertical through its pivot is, so many seconds after a report.
export function orbited(at: Vec3, values: Values, seconds: number): Vec3 {
  const [speed, pivot] = [values.get('light.orbit'), values.get('light.pivot')];
  if (typeof speed !== 'number' || speed === 0 || !Array.isArray(pivot)) return at;
  const [c, s] = [Math.cos(speed * seconds), Math.sin(speed * seconds)];
  const [x, z] = [at[0] - pivot[0], at[2] - pivot[2]];
  return [pivot[0] + c * x + s * z, at[1], pivot[2] - s * x + c * z];
}

// The handle of an element, for who may move it. Fog that is no ball has no place. `age`: the seconds since the
// elements were told.
export function handleOf(
  list: List,
  elements: readonly Values[],
  number: number,
  role: Role,
  age = 0,
): Handle | undefined {
  const { name, settings } = list;
  const values = elements[number];
  const place = settings.find(({ path, kind }) => kind === 'vector' && PLACES.includes(path.slice(name.length + 1)));
  if (!values || !place || !atLeast(role, place.leastRole) || !applies(place, values.get(`${name}.${TYPE}`)))
    return undefined;
  const at = values.get(place.path);
  if (!Array.isArray(at) || (name === 'fog' && values.get('fog.radius') === 0)) return undefined;
  const { lowest, highest } = place;
  const path = `${name}[${number}]${place.path.slice(name.length)}`;
  return { path, name: `${name} ${number + 1}`, at: orbited(at as unknown as Vec3, values, age), lowest, highest };
}

export function listGroup(
  list: List,
  role: Role,
  camera: () => Camera,
  command: (command: Command) => void,
): ListGroup {
  const { name, settings } = list;
  const allowed = settings.every(({ leastRole }) => atLeast(role, leastRole));
  let chosen = 0;
  let elements: readonly Values[] = [];
  let awaited = false; // true: one was added here, and is chosen once it is there
  let shown = ''; // the options of `which`

  const which = select(sentence(name), (value) => {
    chosen = Number(value);
    show();
  });
  // New ones for each element: what the viewer does to one is not held against what another has.
  const rowsOf = (number: number): Row[] =>
    settings.flatMap((setting) => {
      const key = setting.path.slice(name.length + 1);
      const controls = controlsOf(setting, (value) =>
        command({ kind: 'set', changes: [{ path: `${name}[${number}].${key}`, value }] }),
      );
      if (!controls) return [];
      const row = el('div', { class: 'setting' }, ...controls.elements);
      row.inert = !allowed;
      return [{ setting, row, controls }];
    });
  let rows: Row[] = [];
  let rowsAre = ''; // of which element of how many
  const place = el('div', { class: 'setting' });
  const add = button('Add', `Another ${name}, for everyone`, () => {
    awaited = true;
    command({ kind: 'add', list: name, changes: beginnings(list, camera()) });
  });
  const remove = button('Remove', `This ${name}, for everyone`, () =>
    command({ kind: 'remove', path: `${name}[${chosen}]` }),
  );
  const element = group(
    sentence(name) + (name.endsWith('x') ? 'es' : 's'),
    false,
    which.element,
    place,
    el('div', { class: 'actions' }, add, remove),
  );

  const typeOf = (values: Values | undefined): SettingValue | undefined => values?.get(`${name}.${TYPE}`);
  const show = (): void => {
    const options = elements.map((one, i) => ({ value: String(i), text: [i + 1, typeOf(one)].join(' ').trim() }));
    const text = JSON.stringify(options);
    if (text !== shown) which.options(options);
    shown = text;
    which.follow(String(chosen), true);
    which.element.hidden = elements.length === 0;
    add.disabled = !allowed || elements.length >= list.most;
    remove.disabled = !allowed || elements.length === 0;
    const values = elements[chosen];
    const are = `${chosen} of ${elements.length}`;
    if (are !== rowsAre) place.replaceChildren(...(rows = values ? rowsOf(chosen) : []).map(({ row }) => row));
    rowsAre = are;
    for (const { setting, row, controls } of rows) {
      const value = values?.get(setting.path);
      row.hidden = value === undefined || !applies(setting, typeOf(values));
      if (value !== undefined) controls.follow(value);
    }
  };
  show();
  return {
    element,
    follow: (now) => {
      if (awaited && now.length > elements.length) {
        chosen = now.length - 1;
        awaited = false;
      }
      elements = now;
      chosen = Math.max(0, Math.min(chosen, elements.length - 1));
      show();
    },
    handles: (age) => {
      if (!element.open) return [];
      return elements.flatMap((_, i) => {
        if (i !== chosen && elements.length > MOST_HANDLES) return [];
        const handle = handleOf(list, elements, i, role, age);
        const choose = (): void => {
          chosen = i;
          show();
        };
        return handle ? [{ ...handle, chosen: i === chosen, choose }] : [];
      });
    },
  };
}
