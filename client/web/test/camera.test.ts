import { describe, expect, test } from 'vitest';
import {
  MAX_DISTANCE,
  MAX_PITCH,
  MIN_DISTANCE,
  axes,
  dot,
  fitAspect,
  length,
  look,
  lookAt,
  metresPerPixel,
  move,
  normalize,
  orbit,
  orientation,
  pivot,
  rayThrough,
  subtract,
  zoom,
} from '../src/camera';
import type { Camera } from '../src/camera';
import type { Quat, Vec3 } from '../src/protocol';

const close = (found: Vec3, wanted: Vec3): void => {
  for (const k of [0, 1, 2] as const) expect(found[k]).toBeCloseTo(wanted[k], 9);
};

// v' = q v q*, written out from the definition of the quaternion product.
function rotate([x, y, z, w]: Quat, v: Vec3): Vec3 {
  const product = (a: Quat, b: Quat): Quat => [
    a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
    a[3] * b[1] + a[1] * b[3] + a[2] * b[0] - a[0] * b[2],
    a[3] * b[2] + a[2] * b[3] + a[0] * b[1] - a[1] * b[0],
    a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2],
  ];
  const [rx, ry, rz] = product(product([x, y, z, w], [v[0], v[1], v[2], 0]), [-x, -y, -z, w]);
  return [rx, ry, rz];
}

const cameras: Camera[] = [
  lookAt([0, 2, 26], [0, 0, 0]),
  lookAt([5, -3, 2], [-1, 4, 7]),
  lookAt([-8, 1, -9], [0, 0, 0]),
  { position: [1, 2, 3], yaw: 2.5, pitch: -1.2, distance: 4 },
];

describe('camera', () => {
  test('looks at its target', () => {
    const camera = lookAt([5, -3, 2], [-1, 4, 7]);
    close(pivot(camera), [-1, 4, 7]);
    close(axes(camera).forward, normalize([-6, 7, 5]));
    close(axes(lookAt([0, 0, 10], [0, 0, 0])).forward, [0, 0, -1]);
  });

  test('orientation turns the view’s axes into the world’s', () => {
    for (const camera of cameras) {
      const q = orientation(camera);
      expect(Math.hypot(...q)).toBeCloseTo(1, 12);
      const { right, up, forward } = axes(camera);
      close(rotate(q, [1, 0, 0]), right);
      close(rotate(q, [0, 1, 0]), up);
      close(rotate(q, [0, 0, -1]), forward);
      expect(up[1]).toBeGreaterThan(0); // never upside down
      expect(right[1]).toBe(0); // never rolled
    }
  });

  test('orbiting keeps the pivot and the distance, and a whole turn comes home', () => {
    for (const camera of cameras) {
      const turned = orbit(camera, 0.7, 0.2);
      close(pivot(turned), pivot(camera));
      expect(length(subtract(turned.position, pivot(camera)))).toBeCloseTo(camera.distance, 9);
      close(orbit(camera, 2 * Math.PI, 0).position, camera.position);
    }
  });

  test('dragging to the right carries the scene to the right', () => {
    const camera = lookAt([0, 0, 10], [0, 0, 0]);
    // A drag to the right turns by a negative yaw; what is near then appears further right.
    const turned = orbit(camera, -0.1, 0);
    const near = subtract([0, 0, 3], turned.position);
    expect(dot(near, axes(turned).right)).toBeGreaterThan(0);
  });

  test('pitch stops short of the poles', () => {
    const camera = cameras[0] as Camera;
    expect(orbit(camera, 0, 10).pitch).toBe(MAX_PITCH);
    expect(look(camera, 0, -10).pitch).toBe(-MAX_PITCH);
  });

  test('zoom moves toward the pivot within limits', () => {
    const camera = cameras[0] as Camera;
    const near = zoom(camera, 0.5);
    close(pivot(near), pivot(camera));
    expect(near.distance).toBeCloseTo(camera.distance / 2, 9);
    expect(zoom(camera, 0).distance).toBe(MIN_DISTANCE);
    expect(zoom(camera, Infinity).distance).toBe(MAX_DISTANCE);
  });

  test('moving goes along the camera’s own axes and stays finite', () => {
    const camera = lookAt([0, 0, 10], [0, 0, 0]);
    close(move(camera, 1, 2, 3).position, [1, 2, 7]);
    close(pivot(move(camera, 1, 0, 0)), [1, 0, 0]);
    for (const x of move(camera, 1e30, 0, 0).position) expect(Math.abs(x)).toBeLessThanOrEqual(5e4);
  });

  test('rays go through their pixels', () => {
    const fovY = 0.8;
    const aspect = 16 / 9;
    for (const camera of cameras) {
      close(rayThrough(camera, fovY, aspect, 0, 0).direction, axes(camera).forward);
      const { right, up, forward } = axes(camera);
      const corner = rayThrough(camera, fovY, aspect, 1, -1).direction;
      expect(length(corner)).toBeCloseTo(1, 12);
      const ahead = dot(corner, forward);
      expect(dot(corner, up) / ahead).toBeCloseTo(-Math.tan(fovY / 2), 9);
      expect(dot(corner, right) / ahead).toBeCloseTo(aspect * Math.tan(fovY / 2), 9);
    }
  });

  test('panning by a picture’s height moves by what the picture shows at the pivot', () => {
    const camera = cameras[0] as Camera;
    const shown = 2 * camera.distance * Math.tan(0.4);
    expect(metresPerPixel(camera, 0.8, 540) * 540).toBeCloseTo(shown, 9);
  });

  test('a narrow picture looks from further back', () => {
    const camera = cameras[0] as Camera;
    expect(fitAspect(camera, 1.5)).toBe(camera);
    expect(fitAspect(camera, 0.8).distance).toBeCloseTo(camera.distance / 0.8, 9);
    expect(fitAspect(camera, 0.01).distance).toBeCloseTo(camera.distance * 2.5, 9);
  });

  test('a narrow picture of a camera that looks up is not from below the ground', () => {
    const camera = lookAt([-4, 3.5, 19], [1.2, 6.6, 0]); // of the scene plume
    const narrow = fitAspect(camera, 320 / 800);
    expect(narrow.position[1]).toBeCloseTo(3.5, 9);
    expect(narrow.distance).toBeCloseTo(camera.distance * 2.5, 9);
    expect(narrow.yaw).toBeCloseTo(camera.yaw, 9);
    pivot(narrow).forEach((x, i) => expect(x).toBeCloseTo(pivot(camera)[i] as number, 9));
  });
});
