// The camera that nobody touches.
import { beforeEach, describe, expect, test } from 'vitest';
import { lookAt, orbit, pivot, zoom } from '../src/camera';
import type { Camera } from '../src/camera';
import { IdleCamera, idleOf, towards } from '../src/idle';
import type { IdleHost } from '../src/idle';

const DT = 1 / 60; // s
const WISH = { idle: 20, turn: 120, home: 60 };
const HOME = lookAt([0, 6, 26], [0, 1, 0]);

type Mutable = { -readonly [K in keyof IdleHost]: IdleHost[K] };
let host: Mutable;
let idle: IdleCamera;
let now: number; // ms

beforeEach(() => {
  now = 1000;
  host = { camera: HOME, home: HOME, busy: false, live: true, still: false };
  idle = new IdleCamera(host, WISH, now);
});

const far = (a: Camera, b: Camera): number => Math.hypot(...a.position.map((x, k) => x - (b.position[k] ?? NaN)));

// Lets seconds pass. Returns the longest way of one animation frame, in m, and the largest change of it.
function pass(seconds: number): { step: number; jerk: number } {
  let [step, jerk, before] = [0, 0, NaN];
  for (const end = now + 1000 * seconds; now < end; ) {
    const was = host.camera;
    now += 1000 * DT;
    idle.update(now, DT);
    const way = far(was, host.camera);
    step = Math.max(step, way);
    if (before >= 0) jerk = Math.max(jerk, Math.abs(way - before));
    before = way;
  }
  return { step, jerk };
}

// The way of one animation frame of the drift.
const PACE = ((2 * Math.PI) / WISH.turn) * DT * Math.hypot(5, 26);

describe('nobody touches the camera', () => {
  test('it stands until its time, then turns about the pivot in the time of a turn', () => {
    pass(19);
    expect(host.camera).toEqual(HOME);
    pass(20); // the beginning
    const begin = host.camera;
    const { step, jerk } = pass(WISH.turn / 2);
    expect(step).toBeLessThan(1.01 * PACE);
    expect(jerk).toBeLessThan(0.01 * PACE);
    const turned = Math.abs(host.camera.yaw - begin.yaw) % (2 * Math.PI);
    expect(Math.abs(turned - Math.PI)).toBeLessThan(0.02);
    for (const [k, x] of pivot(host.camera).entries()) expect(x).toBeCloseTo(pivot(HOME)[k] ?? NaN, 9);
  });

  test('it begins and ends without a jerk', () => {
    expect(pass(40).jerk).toBeLessThan(0.02 * PACE); // of 60 pictures a second, in 2.5 s
    idle.touch(now);
    expect(pass(2).jerk).toBeLessThan(0.1 * PACE);
    expect(pass(10).step).toBe(0);
  });

  test('a touch stops it where it is, and it goes on from there', () => {
    pass(30);
    host.camera = zoom(orbit(host.camera, 0.4, 0.2), 0.5); // by hand
    const left = host.camera;
    pass(19);
    expect(far(host.camera, left)).toBeLessThan(15 * PACE); // what is left of the drift
    const standing = host.camera;
    pass(1.2);
    expect(far(host.camera, standing)).toBeLessThan(12 * PACE);
    pass(10);
    expect(host.camera.distance).toBe(left.distance);
    expect(host.camera.pitch).toBe(left.pitch);
    expect(far(host.camera, standing)).toBeGreaterThan(0.5);
  });

  test('after a longer while it is back on the first camera’s circle, without a jump', () => {
    host.camera = zoom(orbit(HOME, 1, -0.3), 2);
    pass(1);
    const { step } = pass(WISH.home + 12);
    expect(step).toBeLessThan(0.2); // 30 m in 8 s, eased
    expect(host.camera.distance).toBeCloseTo(HOME.distance, 6);
    expect(host.camera.pitch).toBeCloseTo(HOME.pitch, 6);
    for (const [k, x] of pivot(host.camera).entries()) expect(x).toBeCloseTo(pivot(HOME)[k] ?? NaN, 6);
    const { step: later } = pass(300);
    expect(later).toBeLessThan(1.01 * PACE);
    host.camera = zoom(host.camera, 2); // the next visitor's
    pass(WISH.home + 12);
    expect(host.camera.distance).toBeCloseTo(HOME.distance, 6);
  });

  test('it comes back once: then the drift has it alone', () => {
    idle = new IdleCamera(host, WISH, now, (camera, s) => ({ ...camera, pitch: camera.pitch + s / 1000 }));
    pass(WISH.home + 12);
    const { pitch } = host.camera;
    pass(20);
    expect(host.camera.pitch - pitch).toBeCloseTo(0.02, 6);
  });

  test('who has the camera keeps it, and the time begins anew after', () => {
    pass(40);
    host.busy = true;
    const led = orbit(HOME, 2, 0);
    host.camera = led;
    expect(pass(100).step).toBe(0);
    host.busy = false;
    expect(pass(19).step).toBe(0);
    expect(host.camera).toEqual(led);
    pass(10);
    expect(far(host.camera, led)).toBeGreaterThan(0.1);
  });

  test('without pictures it waits, and goes on at once when they come', () => {
    pass(40);
    host.live = false;
    pass(2);
    expect(pass(1000).step).toBe(0);
    host.live = true;
    expect(pass(10).step).toBeGreaterThan(0.9 * PACE);
  });

  test('who wants no motion gets none: it comes back in one step', () => {
    host.still = true;
    host.camera = zoom(orbit(HOME, 1, -0.3), 2);
    const left = host.camera;
    pass(WISH.home - 1);
    expect(host.camera).toEqual(left);
    pass(2);
    expect(host.camera).toEqual(HOME);
    expect(pass(200).step).toBe(0);
  });

  test('another way to drift has the circle’s place', () => {
    const seconds: number[] = [];
    idle = new IdleCamera(host, WISH, now, (camera, s) => {
      seconds.push(s);
      return { ...camera, yaw: camera.yaw + s };
    });
    pass(30);
    expect(seconds.length).toBeGreaterThan(500);
    expect(Math.max(...seconds)).toBeLessThanOrEqual(DT);
    expect(host.camera.position).toEqual(HOME.position);
  });
});

test('the way back keeps the side that the camera looks from', () => {
  const from = zoom(orbit(HOME, 1, -0.3), 2);
  for (const part of [0, 0.5, 1, 2]) expect(towards(from, from, HOME, part).yaw).toBe(from.yaw);
  expect(far(towards(from, from, HOME, 0), from)).toBeLessThan(1e-9);
});

test('seconds have their bounds', () => {
  const read = (query: string) => {
    const asked = new URLSearchParams(query);
    return idleOf((name) => asked.get(name));
  };
  expect(read('idle=5&turn=60&home=30')).toEqual({ wish: { idle: 5, turn: 60, home: 30 }, faults: [] });
  for (const wrong of ['1', '3601', '', 'NaN', 'soon']) {
    const { wish, faults } = read(`idle=${wrong}`);
    expect(wish.idle).toBe(20);
    expect(faults).toEqual(['idle takes seconds from 2 to 3600: idle=20.']);
  }
});
