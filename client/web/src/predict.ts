// Predicts where a camera or a head will be when the picture of a pose that is sent now is seen: it goes on as it moved
// just before.
import { add, clamp, scale, subtract } from './camera';
import type { Camera } from './camera';
import { conjugate, multiply } from './projection';
import type { Quat, Vec3 } from './protocol';

const SPAN_MS = 80; // of movement is extrapolated: more would lag behind, less would follow single events
const LEAST_MS = 12;
// Longest prediction: a hand changes its direction after that.
const LONGEST_MS = 150;

export interface Head {
  position: Vec3;
  orientation: Quat;
}

// Where it is after `part` times the way from `from` to `to`, counted from `to`.
type GoOn<T> = (from: T, to: T, part: number) => T;

export class Predictor<T> {
  private readonly past: { at: number; pose: T }[] = [];

  constructor(private readonly goOn: GoOn<T>) {}

  // To be called once per animation frame. `at`: ms, growing.
  add(at: number, pose: T): void {
    this.past.push({ at, pose });
    while (this.past.length > 2 && at - (this.past[1]?.at ?? at) >= SPAN_MS) this.past.shift();
  }

  // The pose `ahead` ms after the newest one that was added; the newest itself while too few are known.
  predict(ahead: number): T | undefined {
    const first = this.past[0];
    const last = this.past[this.past.length - 1];
    if (!first || !last || last.at - first.at < LEAST_MS) return last?.pose;
    return this.goOn(first.pose, last.pose, clamp(ahead, 0, LONGEST_MS) / (last.at - first.at));
  }

  reset(): void {
    this.past.length = 0;
  }
}

const positionOf = (from: Vec3, to: Vec3, part: number): Vec3 => add(to, scale(subtract(to, from), part));

export const cameraGoesOn: GoOn<Camera> = (from, to, part) => ({
  position: positionOf(from.position, to.position, part),
  yaw: to.yaw + Math.atan2(Math.sin(to.yaw - from.yaw), Math.cos(to.yaw - from.yaw)) * part,
  pitch: to.pitch + (to.pitch - from.pitch) * part,
  distance: to.distance,
});

export const headGoesOn: GoOn<Head> = (from, to, part) => {
  const turn = multiply(to.orientation, conjugate(from.orientation));
  const [x, y, z, w] = turn[3] < 0 ? ([-turn[0], -turn[1], -turn[2], -turn[3]] as const) : turn;
  const sine = Math.hypot(x, y, z);
  const half = Math.atan2(sine, w) * part;
  const along = sine > 1e-9 ? Math.sin(half) / sine : 0;
  const further: Quat = [x * along, y * along, z * along, Math.cos(half)];
  return {
    position: positionOf(from.position, to.position, part),
    orientation: multiply(further, to.orientation),
  };
};
