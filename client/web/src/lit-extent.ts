// Where the particles of a moment are, and how finely a view must draw them. Places are m from the moment's origin.
import { add, clamp, cross, dot, length, normalize, scale, subtract } from './camera';
import { strideOf } from './lit-moment';
import type { Moment } from './lit-moment';
import { rotate } from './projection';
import type { View } from './projection';
import type { Vec3 } from './protocol';

const OUTLINE = 3; // standard deviations of a particle that count as the medium's
const DEVIATION = 0.1; // of a particle, in parts of scale * falloff
const LOOKED_AT = 2048; // particles at most, to choose the spacing of rays
const FINEST_PART = 0.1; // of the particles may be finer than what rays are spaced for
const SPACINGS = 1.5; // between rays, in a standard deviation of a particle as it is seen
export const COARSEST = 8; // pixels between rays
const MOST_RAYS = 600_000;
const STEADY = 0.15; // of a spacing, by which a finer or coarser one must be due to be taken

export interface Extent {
  lo: Vec3;
  hi: Vec3;
  middle: Vec3;
  radius: number; // m
}

// The box of what `along` says of places, out to OUTLINE deviations.
function boxOf({ values, count, layout, message }: Moment, along: readonly [Vec3, Vec3, Vec3]): { lo: Vec3; hi: Vec3 } {
  const stride = strideOf(layout);
  const reach = OUTLINE * DEVIATION * message.falloff;
  const lo: [number, number, number] = [Infinity, Infinity, Infinity];
  const hi: [number, number, number] = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < 3; ++i) {
    const [x, y, z] = along[i] ?? [0, 0, 0];
    for (let at = 0; at < count * stride; at += stride) {
      const place = x * (values[at] ?? 0) + y * (values[at + 1] ?? 0) + z * (values[at + 2] ?? 0);
      const own = reach * (values[at + 3] ?? 0);
      lo[i] = Math.min(lo[i] ?? 0, place - own);
      hi[i] = Math.max(hi[i] ?? 0, place + own);
    }
  }
  return count > 0 ? { lo, hi } : { lo: [0, 0, 0], hi: [0, 0, 0] };
}

export function extentOf(moment: Moment): Extent {
  const { lo, hi } = boxOf(moment, [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
  ]);
  return { lo, hi, middle: scale(add(lo, hi), 0.5), radius: Math.max(length(subtract(hi, lo)) / 2, 1e-3) };
}

// Light space, and what the medium covers of it.
export interface LightSpace {
  x: Vec3;
  y: Vec3;
  lo: Vec3;
  hi: Vec3;
}

export function lightSpaceOf(moment: Moment): LightSpace {
  const { toLight } = moment.message;
  const aside: Vec3 = Math.abs(toLight[1]) < 0.9 ? [0, 1, 0] : [1, 0, 0];
  const x = normalize(cross(aside, toLight));
  const y = cross(toLight, x);
  return { x, y, ...boxOf(moment, [x, y, toLight]) };
}

// Chooses pixels between rays for a picture of `width` and `height`, and counts the particles in it, by a sample.
// `before`: what was chosen for the picture before.
export function rateOf(
  moment: Moment,
  eye: Vec3,
  { orientation, frustum }: View,
  width: number,
  height: number,
  before: number,
): { rate: number; proxies: number } {
  const { values, count, layout, message } = moment;
  const stride = strideOf(layout);
  const [right, up, ahead] = [
    rotate(orientation, [1, 0, 0]),
    rotate(orientation, [0, 1, 0]),
    rotate(orientation, [0, 0, -1]),
  ];
  const pixel = (frustum.up + frustum.down) / height; // at a depth of 1 m
  const step = Math.max(1, Math.ceil(count / LOOKED_AT)) * stride;
  const seen: number[] = []; // deviations, pixels
  let looked = 0;
  for (let at = 0; at < count * stride; at += step) {
    const off: Vec3 = [(values[at] ?? 0) - eye[0], (values[at + 1] ?? 0) - eye[1], (values[at + 2] ?? 0) - eye[2]];
    const deviation = DEVIATION * message.falloff * (values[at + 3] ?? 0);
    const [x, y, depth] = [dot(right, off), dot(up, off), Math.max(dot(ahead, off), 1e-6)];
    looked += 1;
    const reach = OUTLINE * deviation;
    if (dot(ahead, off) < -reach) continue;
    if (x < -frustum.left * depth - reach || x > frustum.right * depth + reach) continue;
    if (y < -frustum.down * depth - reach || y > frustum.up * depth + reach) continue;
    seen.push(deviation / (pixel * length(off)));
  }
  seen.sort((a, b) => a - b);
  const wanted = (seen[Math.floor(FINEST_PART * seen.length)] ?? Infinity) / SPACINGS;
  const least = Math.ceil(Math.sqrt((width * height) / MOST_RAYS));
  const stays = wanted > before * (1 - STEADY) && wanted < (before + 1) * (1 + STEADY);
  const rate = clamp(stays ? before : Math.floor(wanted), Math.min(least, COARSEST), COARSEST);
  return { rate: Math.max(1, rate || 1), proxies: Math.round((count * seen.length) / Math.max(1, looked)) };
}
