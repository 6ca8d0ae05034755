// Camera maths; uses nothing of the page. Metres, radians, right-handed, +Y up; a camera looks down its own -Z.
// Orbiting turns the camera about the point `distance` ahead, its pivot; flying moves the camera itself.
import type { Quat, Vec3 } from './protocol';

export interface Camera {
  readonly position: Vec3;
  readonly yaw: number; // about +Y, 0 looks along -Z
  readonly pitch: number; // up is positive, within MAX_PITCH
  readonly distance: number; // to the point that orbiting turns about
}

export interface Ray {
  origin: Vec3;
  direction: Vec3; // unit
}

// The largest pitch: a camera that looks straight up or down has no yaw.
export const MAX_PITCH = Math.PI / 2 - 0.01;
export const MIN_DISTANCE = 0.05;
export const MAX_DISTANCE = 10_000;
// m from the origin on each axis; the server refuses positions further out.
const MAX_COORDINATE = 50_000;

export const add = (a: Vec3, b: Vec3): Vec3 => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const subtract = (a: Vec3, b: Vec3): Vec3 => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scale = (a: Vec3, s: number): Vec3 => [a[0] * s, a[1] * s, a[2] * s];
export const dot = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a: Vec3, b: Vec3): Vec3 => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
export const length = (a: Vec3): number => Math.hypot(a[0], a[1], a[2]);
export const clamp = (x: number, lo: number, hi: number): number => Math.min(hi, Math.max(lo, x));

export function normalize(a: Vec3): Vec3 {
  const size = length(a);
  return size > 0 ? scale(a, 1 / size) : [0, 0, -1];
}

export function lookAt(position: Vec3, target: Vec3): Camera {
  const ahead = subtract(target, position);
  const distance = length(ahead);
  if (!(distance > 0)) return { position, yaw: 0, pitch: 0, distance: 1 };
  return {
    position,
    yaw: Math.atan2(-ahead[0], -ahead[2]),
    pitch: clamp(Math.asin(clamp(ahead[1] / distance, -1, 1)), -MAX_PITCH, MAX_PITCH),
    distance: clamp(distance, MIN_DISTANCE, MAX_DISTANCE),
  };
}

// The camera's orientation, world from view, a unit quaternion: yaw about +Y after pitch about +X.
export function orientation(camera: Camera): Quat {
  const cy = Math.cos(camera.yaw / 2);
  const sy = Math.sin(camera.yaw / 2);
  const cp = Math.cos(camera.pitch / 2);
  const sp = Math.sin(camera.pitch / 2);
  return [cy * sp, sy * cp, -sy * sp, cy * cp];
}

export interface Axes {
  right: Vec3;
  up: Vec3;
  forward: Vec3;
}

export function axes(camera: Camera): Axes {
  const cy = Math.cos(camera.yaw);
  const sy = Math.sin(camera.yaw);
  const cp = Math.cos(camera.pitch);
  const sp = Math.sin(camera.pitch);
  return { right: [cy, 0, -sy], up: [sy * sp, cp, cy * sp], forward: [-sy * cp, sp, -cy * cp] };
}

export const pivot = (camera: Camera): Vec3 => add(camera.position, scale(axes(camera).forward, camera.distance));

const bounded = (p: Vec3): Vec3 => [
  clamp(p[0], -MAX_COORDINATE, MAX_COORDINATE),
  clamp(p[1], -MAX_COORDINATE, MAX_COORDINATE),
  clamp(p[2], -MAX_COORDINATE, MAX_COORDINATE),
];

// Turns the view in place.
export function look(camera: Camera, yaw: number, pitch: number): Camera {
  const turned = (camera.yaw + yaw) % (2 * Math.PI);
  return { ...camera, yaw: turned, pitch: clamp(camera.pitch + pitch, -MAX_PITCH, MAX_PITCH) };
}

// Moves the camera around its pivot, the point `distance` ahead, which does not move.
export function orbit(camera: Camera, yaw: number, pitch: number): Camera {
  const centre = pivot(camera);
  const turned = look(camera, yaw, pitch);
  return { ...turned, position: bounded(subtract(centre, scale(axes(turned).forward, turned.distance))) };
}

// Moves the camera and its pivot along the camera's own axes, in metres.
export function move(camera: Camera, right: number, up: number, forward: number): Camera {
  const a = axes(camera);
  const step = add(add(scale(a.right, right), scale(a.up, up)), scale(a.forward, forward));
  return { ...camera, position: bounded(add(camera.position, step)) };
}

// Multiplies the distance to the pivot, which does not move.
export function zoom(camera: Camera, factor: number): Camera {
  const distance = clamp(camera.distance * factor, MIN_DISTANCE, MAX_DISTANCE);
  const position = add(camera.position, scale(axes(camera).forward, camera.distance - distance));
  return { ...camera, distance, position: bounded(position) };
}

// Metres on the plane through the pivot that one pixel covers, in a picture `height` pixels high.
export const metresPerPixel = (camera: Camera, fovY: number, height: number): number =>
  (2 * camera.distance * Math.tan(fovY / 2)) / Math.max(1, height);

// The ray through a point of the picture; x and y run from -1 to 1, right and up.
export function rayThrough(camera: Camera, fovY: number, aspect: number, x: number, y: number): Ray {
  const a = axes(camera);
  const half = Math.tan(fovY / 2);
  const sideways = add(scale(a.right, x * half * aspect), scale(a.up, y * half));
  return { origin: camera.position, direction: normalize(add(a.forward, sideways)) };
}

// The same view from further back if the picture is narrower than high: it then shows all that the scene's camera
// frames. A camera that looks up goes back at its own height: straight back would be below the ground.
export function fitAspect(camera: Camera, aspect: number): Camera {
  if (aspect >= 1) return camera;
  const far = zoom(camera, Math.min(1 / aspect, 2.5));
  if (camera.pitch <= 0) return far;
  const target = pivot(camera);
  const up = target[1] - camera.position[1];
  const along = Math.sqrt(far.distance ** 2 - up ** 2);
  const back: Vec3 = [Math.sin(camera.yaw) * along, -up, Math.cos(camera.yaw) * along];
  return lookAt(bounded(add(target, back)), target);
}

export const same = (a: Camera, b: Camera): boolean =>
  a.yaw === b.yaw &&
  a.pitch === b.pitch &&
  a.position[0] === b.position[0] &&
  a.position[1] === b.position[1] &&
  a.position[2] === b.position[2];
