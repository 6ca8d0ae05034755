// Handles in the picture: where they are, where a drag takes them, and who has one.
import { describe, expect, test, vi } from 'vitest';
import { axes, dot, lookAt, orientation, rayThrough, subtract } from '../src/camera';
import type { Camera } from '../src/camera';
import { throttled } from '../src/fields';
import { Age, dragged, handleAt, within } from '../src/handle';
import { elementsOf, handleOf } from '../src/lists';
import type { List, Setting, Vec3 } from '../src/protocol';

const [width, height, fovY] = [400, 200, Math.PI / 2]; // 100 pixels a metre at a distance of 1 m
const eyeOf = (camera: Camera) => ({ position: camera.position, orientation: orientation(camera), fovY });
const oblique = lookAt([3, 4, 5], [0, 1, -1]);
const seen = (place: Vec3, camera = oblique) => handleAt(place, eyeOf(camera), width, height);

describe('a handle', () => {
  test('is where its place is seen', () => {
    const camera = lookAt([0, 0, 5], [0, 0, 0]);
    expect(seen([0, 0, 0], camera)).toEqual({ x: 200, y: 100 });
    expect(seen([1, 2, 0], camera)).toEqual({ x: expect.closeTo(220), y: expect.closeTo(60) });
    // The ray through that pixel meets the place.
    const at = seen([1, 0, -2]);
    const [x, y] = [((at?.x ?? 0) / width) * 2 - 1, 1 - ((at?.y ?? 0) / height) * 2];
    const ray = rayThrough(oblique, fovY, width / height, x, y);
    const away = subtract([1, 0, -2], oblique.position);
    expect(dot(away, ray.direction)).toBeCloseTo(Math.hypot(...away), 6);
  });

  test('is away behind the eye and beside the picture', () => {
    const camera = lookAt([0, 0, 5], [0, 0, 0]);
    expect(seen([0, 0, 6], camera)).toBeUndefined();
    expect(seen([0, 0, 5], camera)).toBeUndefined();
    expect(seen([11, 0, 0], camera)).toBeUndefined();
    expect(seen([9, 0, 0], camera)).toBeDefined();
    expect(seen([0, 6, 0], camera)).toBeUndefined();
  });
});

describe('a drag', () => {
  const lens = { camera: oblique, fovY, height };
  const place: Vec3 = [1, 0.5, -2];

  test('moves in the plane that faces the camera, and the place stays below the cursor', () => {
    const [before, now] = [seen(place), dragged(place, lens, { x: 31, y: -17 }, false)];
    expect(seen(now)).toEqual({
      x: expect.closeTo((before?.x ?? 0) + 31, 6),
      y: expect.closeTo((before?.y ?? 0) - 17, 6),
    });
    expect(dot(subtract(now, place), axes(oblique).forward)).toBeCloseTo(0, 9);
  });

  test('along the line of sight moves away with the cursor going up, and is undone by going down', () => {
    const away = dragged(place, lens, { x: 40, y: -60 }, true);
    const distance = (p: Vec3): number => Math.hypot(...subtract(p, oblique.position));
    expect(distance(away)).toBeGreaterThan(1.2 * distance(place));
    const [before, now] = [seen(place), seen(away)];
    expect(now?.x).toBeCloseTo(before?.x ?? NaN, 6);
    expect(now?.y).toBeCloseTo(before?.y ?? NaN, 6);
    const back = dragged(away, lens, { x: 0, y: 60 }, true);
    for (const i of [0, 1, 2] as const) expect(back[i]).toBeCloseTo(place[i], 9);
  });

  test('never reaches the eye, nor what the setting does not allow', () => {
    const near = dragged(place, lens, { x: 0, y: 1e5 }, true);
    expect(Math.hypot(...subtract(near, oblique.position))).toBeCloseTo(0.05, 6);
    expect(within([7, -60_000, 60_000], { lowest: -50_000, highest: 50_000 })).toEqual([7, -50_000, 50_000]);
  });
});

test('places go to the server at most 20 times a second, and the last one always', () => {
  vi.useFakeTimers();
  vi.stubGlobal('window', globalThis);
  try {
    const sent: number[] = [];
    const send = throttled((place: number) => sent.push(place));
    for (let ms = 1; ms <= 1000; ms += 4, vi.advanceTimersByTime(4)) send(ms);
    expect(sent.length).toBeGreaterThan(15);
    expect(sent.length).toBeLessThanOrEqual(21);
    vi.advanceTimersByTime(100);
    expect(sent.at(-1)).toBe(997);
  } finally {
    vi.unstubAllGlobals();
    vi.useRealTimers();
  }
});

describe('who has a handle', () => {
  const setting = (path: string, kind: Setting['kind'], more: Partial<Setting> = {}): Setting => ({
    ...{ path, kind, choices: [], unit: '', help: '', leastRole: 'controller', onlyType: '' },
    ...{ lowest: -50, highest: 50, usualLowest: 0, usualHighest: 1, ...more },
  });
  const lights: List = {
    name: 'light',
    most: 9,
    settings: [
      setting('light.type', 'text', { choices: ['point', 'spot'] }),
      setting('light.pivot', 'vector'),
      setting('light.position', 'vector'),
    ],
  };
  const two = elementsOf(lights, [0, 9, 9, 9, 1, 2, 3, 1, 8, 8, 8, 4, 5, 6]);

  test('the chosen element, by the setting that is its place', () => {
    expect(handleOf(lights, two, 1, 'controller')).toEqual({
      ...{ path: 'light[1].position', name: 'light 2', at: [4, 5, 6], lowest: -50, highest: 50 },
    });
    expect(handleOf(lights, two, 2, 'controller')).toBeUndefined();
  });

  test('that goes round its pivot is where the picture has it', () => {
    const orbiting: List = {
      ...{ name: 'light', most: 9 },
      settings: [
        setting('light.position', 'vector'),
        setting('light.orbit', 'number'),
        setting('light.pivot', 'vector'),
      ],
    };
    const one = elementsOf(orbiting, [3, 7, 1, Math.PI / 4, 1, 0, 1]);
    expect(handleOf(orbiting, one, 0, 'operator')?.at).toEqual([3, 7, 1]);
    const later = handleOf(orbiting, one, 0, 'operator', 2)?.at;
    expect(later).toEqual([expect.closeTo(1, 9), 7, expect.closeTo(-1, 9)]); // a quarter, from +x to -z
  });

  test('what is told of elements ages with the ticks of the scene, and not while it is paused', () => {
    const age = new Age(60);
    age.report(1000n, false, true);
    expect(age.at(1030n)).toBeCloseTo(0.5);
    expect(age.at(970n)).toBe(0); // a picture from before
    age.report(1060n, false, false);
    expect(age.at(1060n)).toBeCloseTo(1);
    expect(age.at(1030n)).toBeCloseTo(0.5);
    age.report(1090n, true, false);
    expect(age.at(1200n)).toBeCloseTo(1.5);
    age.report(1300n, false, false);
    expect(age.at(1330n)).toBeCloseTo(2);
    age.report(1360n, false, true);
    expect(age.at(1360n)).toBe(0);
  });

  test('for those alone who may move it', () => {
    expect(handleOf(lights, two, 0, 'viewer')).toBeUndefined();
    expect(handleOf(lights, two, 0, 'operator')).toBeDefined();
  });

  test('a ball of fog has one, fog everywhere and a plane have none', () => {
    const fogs: List = {
      ...{ name: 'fog', most: 4 },
      settings: [setting('fog.centre', 'vector'), setting('fog.radius', 'number')],
    };
    const elements = elementsOf(fogs, [1, 2, 3, 0, 1, 2, 3, 5]);
    expect(handleOf(fogs, elements, 0, 'operator')).toBeUndefined();
    expect(handleOf(fogs, elements, 1, 'operator')?.path).toBe('fog[1].centre');
    const planes: List = { name: 'plane', most: 4, settings: [setting('plane.height', 'number')] };
    expect(handleOf(planes, elementsOf(planes, [1]), 0, 'operator')).toBeUndefined();
  });
});
