// A camera that nobody touches: after a while it turns slowly about its pivot, after a longer while it comes back to the
// circle of the first camera. Uses nothing of the page.
import { axes, orbit, pivot, same, scale, subtract } from './camera';
import type { Camera } from './camera';
import type { Vec3 } from './protocol';

export interface IdleWish {
  idle: number; // s without a touch, after which the camera drifts
  turn: number; // s of a whole turn
  home: number; // s without a touch, after which it comes back
}

export const IDLE: IdleWish = { idle: 20, turn: 120, home: 120 };
const RANGES = { idle: [2, 3600], turn: [20, 3600], home: [10, 86_400] } as const;
export const idleNames = ['idle', 'turn', 'home'] as const;

// Moves a camera while nobody does. `seconds`: since the last call; they pass more slowly at the beginning and at the
// end. A camera path can take the circle's place.
export type Drift = (camera: Camera, seconds: number) => Camera;

export const circle =
  (turn: number): Drift =>
  (camera, seconds) =>
    orbit(camera, (2 * Math.PI * seconds) / turn, 0);

export interface IdleHost {
  camera: Camera;
  readonly home: Camera; // the first camera, for the window's shape
  readonly busy: boolean; // true: a hand, a headset or somebody else has the camera
  readonly live: boolean; // false: no pictures come, which would show where it goes
  readonly still: boolean; // true: this person wants no motion
}

const START_S = 2.5; // time constant of the drift's beginning
const STOP_S = 0.2; // and of its end
const GLIDE_S = 8; // of the way back

const smooth = (t: number): number => t * t * (3 - 2 * t);
const mix = (a: number, b: number, t: number): number => a + (b - a) * t;
const mixed = (a: Vec3, b: Vec3, t: number): Vec3 => [mix(a[0], b[0], t), mix(a[1], b[1], t), mix(a[2], b[2], t)];

// The camera `at` looks from the side that it has, at the pivot, height and distance of `home`.
export function towards(at: Camera, from: Camera, home: Camera, part: number): Camera {
  const t = smooth(Math.min(1, part));
  const distance = Math.exp(mix(Math.log(from.distance), Math.log(home.distance), t));
  const turned = { ...at, pitch: mix(from.pitch, home.pitch, t), distance };
  const target = mixed(pivot(from), pivot(home), t);
  return { ...turned, position: subtract(target, scale(axes(turned).forward, distance)) };
}

export class IdleCamera {
  private touchedAt: number; // ms
  private pace = 0; // 0 ... 1, of the drift
  private back: { from: Camera; seconds: number } | undefined; // the way back
  private isBack = false; // true: nobody has touched it since it was
  private last: Camera | undefined; // as this has left it

  constructor(
    private readonly host: IdleHost,
    private readonly wish: IdleWish,
    now: number, // ms
    readonly drift: Drift = circle(wish.turn),
  ) {
    this.touchedAt = now;
  }

  touch(now: number): void {
    this.touchedAt = now;
    this.back = undefined;
    this.isBack = false;
  }

  // To be called once per animation frame; `dt` in seconds.
  update(now: number, dt: number): void {
    const { host, wish } = this;
    // Whoever moved it otherwise has touched it: keys, a button, a presenter, another scene.
    if (host.busy || (this.last && !same(this.last, host.camera))) this.touch(now);
    this.last = host.camera;
    if (host.busy) {
      this.pace = 0;
      return;
    }
    const untouched = (now - this.touchedAt) / 1000;
    const goal = untouched >= wish.idle && host.live && !host.still ? 1 : 0;
    this.pace += (goal - this.pace) * (1 - Math.exp(-dt / (goal > 0 ? START_S : STOP_S)));
    if (goal === 0 && this.pace < 1e-3) this.pace = 0;
    if (this.pace > 0) host.camera = this.drift(host.camera, dt * this.pace);
    if (untouched >= Math.max(wish.home, wish.idle) && host.live && !this.isBack) this.goBack(dt);
    this.last = host.camera;
  }

  private goBack(dt: number): void {
    const { host } = this;
    if (host.still) {
      host.camera = host.home;
      this.isBack = true;
      return;
    }
    this.back ??= { from: host.camera, seconds: 0 };
    this.back.seconds += dt;
    host.camera = towards(host.camera, this.back.from, host.home, this.back.seconds / GLIDE_S);
    if (this.back.seconds >= GLIDE_S) [this.back, this.isBack] = [undefined, true];
  }
}

// The wishes of texts by name. What cannot be used is a sentence of `faults`, and the default holds.
export function idleOf(get: (name: string) => string | null): { wish: IdleWish; faults: string[] } {
  const wish = { ...IDLE };
  const faults: string[] = [];
  for (const name of idleNames) {
    const text = get(name);
    if (text === null) continue;
    const [least, most] = RANGES[name];
    const value = text.trim() === '' ? NaN : Number(text);
    if (value >= least && value <= most) wish[name] = value;
    else faults.push(`${name} takes seconds from ${least} to ${most}: ${name}=${IDLE[name]}.`);
  }
  return { wish, faults };
}
