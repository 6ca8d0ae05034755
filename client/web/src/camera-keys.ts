// Key views of a camera, and the smooth path through them: the same as common/camera_keys.cpp. Tests hold both to
// protocol/examples/camera_path.json.
import { MAX_DISTANCE, MIN_DISTANCE, clamp, pivot, subtract } from './camera';
import type { Camera } from './camera';
import type { Vec3 } from './protocol';

export interface CameraKey {
  readonly position: Vec3;
  readonly target: Vec3;
  readonly fovY: number; // rad
  readonly seconds: number; // from the key before; the first key's is not used
}

// A camera of a moment, and its lens.
export interface View {
  readonly position: Vec3;
  readonly yaw: number; // rad, not within one turn
  readonly pitch: number;
  readonly distance: number; // m, to what is looked at
  readonly fovY: number; // rad
}

export const MOST_KEYS = 64;
export const KEY_SECONDS = { lowest: 0.1, highest: 600 };

// A camera that looks straight up or down has no yaw.
const MOST_PITCH = Math.PI / 2 - 0.015;
const LEAST_DISTANCE = 1e-3; // m

export const keyOf = (camera: Camera, fovY: number, seconds: number): CameraKey => ({
  position: camera.position,
  target: pivot(camera),
  fovY,
  seconds,
});

export const cameraOf = ({ position, yaw, pitch, distance }: View): Camera => ({
  position,
  yaw,
  pitch,
  distance: clamp(distance, MIN_DISTANCE, MAX_DISTANCE),
});

export function viewOf({ position, target, fovY }: CameraKey): View {
  const ahead = subtract(target, position);
  const distance = Math.max(Math.hypot(...ahead), LEAST_DISTANCE);
  const yaw = Math.atan2(-ahead[0], -ahead[2]);
  return {
    position,
    yaw,
    pitch: clamp(Math.asin(clamp(ahead[1] / distance, -1, 1)), -MOST_PITCH, MOST_PITCH),
    distance,
    fovY,
  };
}

type Numbers = readonly number[];
// What moves by itself: place, yaw, pitch, logarithm of the distance, field of view.
type Groups = readonly [place: Numbers, yaw: Numbers, pitch: Numbers, logDistance: Numbers, fovY: Numbers];
const groups = ({ position, yaw, pitch, distance, fovY }: View): Groups => [
  position,
  [yaw],
  [pitch],
  [Math.log(distance)],
  [fovY],
];
const mix = (a: Numbers, b: Numbers, f: (x: number, y: number) => number): Numbers => a.map((x, i) => f(x, b[i] ?? 0));

// The tangent at a key between two ways of mean velocity; camera_keys.cpp says why.
function between(before: Numbers, after: Numbers): Numbers {
  const [a, b] = [Math.hypot(...before), Math.hypot(...after)];
  return mix(before, after, (x, y) => (a + b > 0 ? (b * x + a * y) / (a + b) : 0));
}

// The tangent at the other end of a symmetric curve along `way`.
function mirrored(tangent: Numbers, way: Numbers): Numbers {
  const along = mix(tangent, way, (x, y) => x * y).reduce((sum, x) => sum + x, 0);
  const square = way.reduce((sum, x) => sum + x * x, 0);
  return mix(tangent, way, (x, y) => (square > 0 ? (2 * along * y) / square - x : 0));
}

function eased(u: number, first: boolean, last: boolean): number {
  if (first && last) return u * u * (3 - 2 * u);
  if (first) return u * u * (2 - u);
  if (last) return u + u * u - u * u * u;
  return u;
}

export class KeyPath {
  readonly times: readonly number[]; // s, of the keys
  private readonly nodes: readonly Groups[];
  private readonly tangents: readonly Groups[]; // per second

  // There is a key at least, and all but the first have seconds above 0.
  constructor(keys: readonly CameraKey[]) {
    const times: number[] = [];
    const views: View[] = [];
    for (const key of keys) {
      const [view, before] = [viewOf(key), views.at(-1)];
      const turn = 2 * Math.PI;
      const yaw = before ? view.yaw + turn * Math.floor((before.yaw - view.yaw) / turn + 0.5) : view.yaw;
      times.push(before ? (times.at(-1) ?? 0) + key.seconds : 0);
      views.push({ ...view, yaw });
    }
    this.times = times;
    this.nodes = views.map(groups);
    const last = keys.length - 1;
    const inner = this.nodes.map((_, i) => this.each((g) => this.inner(g, i)));
    this.tangents = inner.map((own, i) => {
      if (last === 0 || (i > 0 && i < last)) return own;
      const next = inner[i === 0 ? 1 : last - 1];
      const segment = i === 0 ? 0 : last - 1;
      return this.each((g) => (last === 1 ? this.way(g, segment) : mirrored(next?.[g] ?? [], this.way(g, segment))));
    });
  }

  get seconds(): number {
    return this.times.at(-1) ?? 0;
  }

  at(seconds: number): View {
    const { times } = this;
    const last = times.length - 1;
    const from = clamp(times.filter((time) => time <= seconds).length - 1, 0, last);
    const to = Math.min(from + 1, last);
    const h = (times[to] ?? 0) - (times[from] ?? 0);
    const part = to > from ? clamp((seconds - (times[from] ?? 0)) / h, 0, 1) : 0;
    const u = eased(part, from === 0, to === last);
    const [v, w] = [u * u, u * u * u];
    const [place, yaw, pitch, log, fovY] = this.each((g) => {
      const [a, b] = [this.nodes[from]?.[g] ?? [], this.nodes[to]?.[g] ?? []];
      const [m, n] = [this.tangents[from]?.[g] ?? [], this.tangents[to]?.[g] ?? []];
      const ends = mix(a, b, (x, y) => (2 * w - 3 * v + 1) * x + (3 * v - 2 * w) * y);
      return mix(
        ends,
        mix(m, n, (x, y) => (w - 2 * v + u) * h * x + (w - v) * h * y),
        (x, y) => x + y,
      );
    });
    const [x = 0, y = 0, z = 0] = place;
    return {
      position: [x, y, z],
      yaw: yaw[0] ?? 0,
      pitch: pitch[0] ?? 0,
      distance: Math.exp(log[0] ?? 0),
      fovY: fovY[0] ?? 0,
    };
  }

  private each(f: (group: 0 | 1 | 2 | 3 | 4) => Numbers): Groups {
    return [f(0), f(1), f(2), f(3), f(4)];
  }

  // Mean velocity from a key to the next.
  private way(g: 0 | 1 | 2 | 3 | 4, from: number): Numbers {
    const h = (this.times[from + 1] ?? 0) - (this.times[from] ?? 0);
    return mix(this.nodes[from]?.[g] ?? [], this.nodes[from + 1]?.[g] ?? [], (x, y) => (y - x) / h);
  }

  private inner(g: 0 | 1 | 2 | 3 | 4, key: number): Numbers {
    if (key === 0 || key + 1 >= this.nodes.length) return (this.nodes[key]?.[g] ?? []).map(() => 0);
    return between(this.way(g, key - 1), this.way(g, key));
  }
}

// ---- as a part of an address: ?path=x,y,z,tx,ty,tz,fov,seconds_x,y,z,... ----

const BETWEEN = '_';
const LONGEST = 8000; // characters
const FURTHEST = 50_000; // m on each axis
const FOV = { lowest: 0.05, highest: 3 };

const short = (value: number, digits: number): string => String(Number(value.toFixed(digits)));

export const pathText = (keys: readonly CameraKey[]): string =>
  keys
    .map(({ position, target, fovY, seconds }, i) =>
      [...[...position, ...target].map((x) => short(x, 3)), short(fovY, 4), short(i === 0 ? 0 : seconds, 2)].join(),
    )
    .join(BETWEEN);

function keyIn(text: string, first: boolean): CameraKey | undefined {
  const parts = text.split(',');
  const numbers = parts.map((part) => (part.trim() === '' ? NaN : Number(part)));
  const [x = NaN, y = NaN, z = NaN, tx = NaN, ty = NaN, tz = NaN, fovY = NaN, seconds = NaN] = numbers;
  const near = [x, y, z, tx, ty, tz].every((n) => Math.abs(n) <= FURTHEST);
  const apart = Math.hypot(tx - x, ty - y, tz - z) > LEAST_DISTANCE;
  const timed = first ? seconds === 0 : seconds >= KEY_SECONDS.lowest && seconds <= KEY_SECONDS.highest;
  if (parts.length !== 8 || !near || !apart || !timed || !(fovY >= FOV.lowest && fovY <= FOV.highest)) return undefined;
  return { position: [x, y, z], target: [tx, ty, tz], fovY, seconds };
}

// The key views of a text, or a sentence that says which of them cannot be used and what is allowed.
export function pathOf(text: string): CameraKey[] | string {
  const parts = text.length > LONGEST ? [] : text.split(BETWEEN);
  if (parts.length === 0 || parts.length > MOST_KEYS) return `path has at most ${MOST_KEYS} key views.`;
  const keys = parts.map((part, i) => keyIn(part, i === 0));
  const wrong = keys.indexOf(undefined);
  if (wrong >= 0)
    return (
      `Key view ${wrong + 1} of path is wrong: x,y,z,tx,ty,tz,fov,seconds takes places of −50,000 to 50,000 m ` +
      `that differ, 0.05 to 3 rad and ${KEY_SECONDS.lowest} to ${KEY_SECONDS.highest} s, of the first 0.`
    );
  return keys as CameraKey[];
}
