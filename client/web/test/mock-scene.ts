// A stand-in for the real simulation and renderer: a few dozen soft blobs on springs, drawn small in plain code.
import jpeg from 'jpeg-js';
import { SettingKind } from '../src/wire/brume/wire/setting-kind';

type V3 = [number, number, number];

export interface View {
  position: V3;
  orientation: [number, number, number, number];
  fovY: number;
  width: number;
  height: number;
}

const BLOBS = 60;
const RADIUS = 1.7; // m, standard deviation of a blob's picture
const PIXELS = 160 * 90;

// The same blobs every time.
function* random(): Generator<number, never> {
  let state = 12345;
  for (;;) {
    state = (Math.imul(state, 1103515245) + 12345) & 0x7fffffff;
    yield state / 0x7fffffff;
  }
}

function rotateBack([x, y, z, w]: View['orientation'], v: V3): V3 {
  // The conjugate quaternion takes the world to the view.
  const [a, b, c] = [-x, -y, -z];
  const tx = 2 * (b * v[2] - c * v[1]);
  const ty = 2 * (c * v[0] - a * v[2]);
  const tz = 2 * (a * v[1] - b * v[0]);
  return [v[0] + w * tx + b * tz - c * ty, v[1] + w * ty + c * tx - a * tz, v[2] + w * tz + a * ty - b * tx];
}

// A few of the real server's live settings.
export const SETTINGS: readonly {
  path: string;
  kind: SettingKind;
  value: number | V3 | string;
  range: [lowest: number, highest: number];
  choices?: string[];
}[] = [
  { path: 'light.to_light', kind: SettingKind.direction, value: [0.4, 0.8, 0.45], range: [-1, 1] },
  { path: 'light.irradiance', kind: SettingKind.colour, value: [10, 9.4, 8.6], range: [0, 40] },
  { path: 'light.rotate', kind: SettingKind.number, value: 0, range: [-2, 2] },
  { path: 'medium.extinction', kind: SettingKind.number, value: 15, range: [0, 100] },
  { path: 'medium.albedo', kind: SettingKind.colour, value: [0.92, 0.94, 0.97], range: [0, 1] },
  { path: 'simulation.paused', kind: SettingKind.boolean, value: 0, range: [0, 1] },
  { path: 'render.method', kind: SettingKind.text, value: 'sphere', range: [0, 0], choices: ['sphere', 'isv'] },
  { path: 'render.exposure', kind: SettingKind.number, value: 1, range: [0.05, 20] },
  { path: 'render.isv.steps', kind: SettingKind.whole, value: 2, range: [1, 10] },
];

export class MockScene {
  tick = 0;
  readonly settings = new Map<string, number | V3 | string>(SETTINGS.map(({ path, value }) => [path, value]));
  private readonly home: V3[] = [];
  private readonly at: V3[] = [];
  private readonly speed: V3[] = [];

  private number(path: string): number {
    return Number(this.settings.get(path));
  }
  private vector(path: string): V3 {
    return this.settings.get(path) as V3;
  }

  constructor() {
    const dice = random();
    const roll = (): number => dice.next().value * 2 - 1;
    for (let i = 0; i < BLOBS; ++i) {
      const x = roll() * 5.5;
      const lift = Math.cos((x / 5.5) * 1.3);
      this.home.push([x, roll() * 2.6 * lift + lift - 0.6, roll() * 3.2]);
      this.at.push([...(this.home[i] as V3)]);
      this.speed.push([0, 0, 0]);
    }
  }

  // FNV-1a over what the scene shows; only equal states have equal hashes, which is all that a page can check.
  hash(): bigint {
    let value = 0xcbf29ce484222325n;
    for (const blob of this.at) {
      for (const x of blob)
        value = ((value ^ BigInt(Math.round(x * 1e6) & 0xffffffff)) * 0x100000001b3n) & ((1n << 64n) - 1n);
    }
    return ((value ^ BigInt(this.tick)) * 0x100000001b3n) & ((1n << 64n) - 1n);
  }

  step(dt: number): void {
    this.tick += 1;
    if (this.number('simulation.paused') === 1) return;
    const turn = this.number('light.rotate') * dt;
    const [x, y, z] = this.vector('light.to_light');
    this.settings.set('light.to_light', [
      x * Math.cos(turn) + z * Math.sin(turn),
      y,
      z * Math.cos(turn) - x * Math.sin(turn),
    ]);
    this.at.forEach((blob, i) => {
      const speed = this.speed[i] as V3;
      const home = this.home[i] as V3;
      for (const k of [0, 1, 2] as const) {
        speed[k] = (speed[k] + 4 * (home[k] - blob[k]) * dt) * (1 - 1.5 * dt);
        blob[k] += speed[k] * dt;
      }
    });
  }

  impulse(origin: V3, direction: V3, push: V3 | undefined, strength: number): void {
    this.at.forEach((blob, i) => {
      const d: V3 = [blob[0] - origin[0], blob[1] - origin[1], blob[2] - origin[2]];
      const ahead = d[0] * direction[0] + d[1] * direction[1] + d[2] * direction[2];
      const off = d.map((x, k) => x - ahead * (direction[k] ?? 0)) as V3;
      const size = Math.hypot(...off);
      const weight = Math.max(0, 1 - (size / 2.5) ** 2) ** 2 * strength;
      for (const k of [0, 1, 2] as const) {
        (this.speed[i] as V3)[k] += weight * (push ? push[k] : (8 * off[k]) / (size + 0.2));
      }
    });
  }

  draw(view: View, quality: number): { width: number; height: number; bytes: Uint8Array } {
    const [toLight, irradiance] = [this.vector('light.to_light'), this.vector('light.irradiance')];
    const [albedo, exposure] = [this.vector('medium.albedo'), this.number('render.exposure')];
    const extinction = this.number('medium.extinction');
    const shrink = Math.min(1, Math.sqrt(PIXELS / (view.width * view.height)));
    const width = Math.max(2, Math.round(view.width * shrink));
    const height = Math.max(2, Math.round(view.height * shrink));
    const depth = new Float32Array(width * height);
    const lit = new Float32Array(width * height);
    const focal = height / 2 / Math.tan(view.fovY / 2);
    this.at.forEach((blob) => {
      const v = rotateBack(view.orientation, blob.map((x, k) => x - (view.position[k] ?? 0)) as V3);
      if (v[2] > -0.5) return;
      const cx = width / 2 + (focal * v[0]) / -v[2];
      const cy = height / 2 - (focal * v[1]) / -v[2];
      const sigma = (focal * RADIUS) / 2 / -v[2];
      const bright = 0.75 + 0.09 * (blob[0] * toLight[0] + blob[1] * toLight[1] + blob[2] * toLight[2]);
      const reach = Math.min(2.4 * sigma, width);
      for (let y = Math.max(0, Math.floor(cy - reach)); y < Math.min(height, cy + reach); ++y) {
        for (let x = Math.max(0, Math.floor(cx - reach)); x < Math.min(width, cx + reach); ++x) {
          const g = Math.exp(-((x - cx) ** 2 + (y - cy) ** 2) / (2 * sigma * sigma)) * extinction * 0.02;
          depth[y * width + x] = (depth[y * width + x] ?? 0) + g;
          lit[y * width + x] = (lit[y * width + x] ?? 0) + g * bright;
        }
      }
    });
    const data = new Uint8Array(width * height * 4);
    const sky = (y: number, k: number): number => [62 + 80 * y, 98 + 72 * y, 150 + 48 * y][k] ?? 0;
    for (let i = 0; i < width * height; ++i) {
      const d = depth[i] ?? 0;
      const through = Math.exp(-d);
      const light = d > 0 ? ((lit[i] ?? 0) / d) * 22 : 0;
      for (const k of [0, 1, 2] as const) {
        const cloud = Math.min(255, light * irradiance[k] * albedo[k] * exposure);
        data[4 * i + k] = sky(Math.floor(i / width) / height, k) * through + cloud * (1 - through);
      }
      data[4 * i + 3] = 255;
    }
    return { width, height, bytes: jpeg.encode({ data, width, height }, quality).data };
  }
}
