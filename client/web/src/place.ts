// Where a camera stands and looks, as an address says it: ?position=x,y,z&target=x,y,z&fov=radians, the same names as
// those of /snapshot.jpg.
import { fitAspect, length, lookAt, pivot, subtract } from './camera';
import type { Camera } from './camera';
import type { Vec3 } from './protocol';

export interface Place {
  position?: Vec3; // m
  target?: Vec3; // m
  fov?: number; // rad, the full vertical angle
}

type Own = { position: Vec3; target: Vec3 }; // a scene's camera, m

const FURTHEST = 50_000; // m on each axis
const FOV = { lowest: 0.05, highest: 3 };
const LEAST_DISTANCE = 1e-3; // m between position and target

const pointOf = (text: string): Vec3 | undefined => {
  const parts = text.split(',');
  const [x, y, z] = parts.map((part) => (part.trim() === '' ? NaN : Number(part)));
  const holds = (n: number | undefined): n is number => n !== undefined && Math.abs(n) <= FURTHEST;
  return parts.length === 3 && holds(x) && holds(y) && holds(z) ? [x, y, z] : undefined;
};

// The place that those texts name; each may be missing. What cannot be used is left out; for each of these a sentence
// of `faults` says what is allowed.
export function placeOf(get: (name: string) => string | null): { place: Place; faults: string[] } {
  const place: Place = {};
  const faults: string[] = [];
  for (const name of ['position', 'target'] as const) {
    const text = get(name);
    if (text === null) continue;
    const point = pointOf(text);
    if (point) place[name] = point;
    else faults.push(`${name} takes three numbers from −50,000 to 50,000, in metres: ${name}=0,6,26.`);
  }
  const angle = get('fov');
  if (angle !== null) {
    const fov = angle.trim() === '' ? NaN : Number(angle);
    if (fov >= FOV.lowest && fov <= FOV.highest) place.fov = fov;
    else faults.push('fov takes an angle from 0.05 to 3, in radians: fov=0.8.');
  }
  const { position, target } = place;
  if (position && target && length(subtract(target, position)) < LEAST_DISTANCE) {
    faults.push('position and target are the same place: they must differ by a millimetre.');
    delete place.position;
    delete place.target;
  }
  return { place, faults };
}

// The camera at that place; what the place leaves out is the scene's own.
export function placed(place: Place, own: Own): Camera {
  return lookAt(place.position ?? own.position, place.target ?? own.target);
}

// A number in as few digits as show the same picture.
const short = (value: number, digits: number): string => String(Number(value.toFixed(digits)));
const pointText = (point: Vec3): string => point.map((one) => short(one, 4)).join();

// The same camera as parameters of an address.
export const placeText = (camera: Camera, fov: number): [name: string, value: string][] => [
  ['position', pointText(camera.position)],
  ['target', pointText(pivot(camera))],
  ['fov', short(fov, 4)],
];

// The camera that a viewer begins with, and the one it comes back to. A place that was named is that place, whatever
// the window's shape.
export function firstCamera(place: Place, own: Own, aspect: number): { home: Camera; camera: Camera } {
  const home = placed(place, own);
  return { home, camera: place.position || place.target ? home : fitAspect(home, aspect) };
}
