import { readFileSync } from 'node:fs';
import { describe, expect, test } from 'vitest';
import { lookAt, orbit, orientation } from '../src/camera';
import { KeyPath, MOST_KEYS, cameraOf, keyOf, pathOf, pathText, viewOf } from '../src/camera-keys';
import type { CameraKey } from '../src/camera-keys';
import type { Vec3 } from '../src/protocol';

interface Example {
  name: string;
  keys: { position: Vec3; target: Vec3; fov_y: number; seconds: number }[];
  seconds: number;
  views: { seconds: number; position: Vec3; yaw: number; pitch: number; distance: number; fov_y: number }[];
}
const table = new URL('../../../protocol/examples/camera_path.json', import.meta.url);
const examples = JSON.parse(readFileSync(table, 'utf8')) as Example[];

describe('a path through key views', () => {
  // tests/unit/camera_keys_test.cpp reads the same table.
  test.each(examples)('is that of the shared table: $name', ({ keys, seconds, views }) => {
    const path = new KeyPath(keys.map(({ fov_y, ...key }) => ({ ...key, fovY: fov_y })));
    expect(path.seconds).toBeCloseTo(seconds, 12);
    for (const like of views) {
      const view = path.at(like.seconds);
      view.position.forEach((x, i) => expect(x).toBeCloseTo(like.position[i] ?? NaN, 9));
      const turns = (view.yaw - like.yaw) / (2 * Math.PI);
      expect(turns - Math.round(turns)).toBeCloseTo(0, 9);
      expect(view.pitch).toBeCloseTo(like.pitch, 9);
      expect(view.distance).toBeCloseTo(like.distance, 9);
      expect(view.fovY).toBeCloseTo(like.fov_y, 9);
    }
  });

  test('begins with the camera that a key was made of', () => {
    const camera = orbit(lookAt([3, 7, 26.5], [0.5, 1, -2]), 1.234, -0.4);
    const again = cameraOf(viewOf(keyOf(camera, 0.8, 3)));
    again.position.forEach((x, i) => expect(x).toBeCloseTo(camera.position[i] ?? NaN, 9));
    orientation(again).forEach((x, i) => expect(x).toBeCloseTo(orientation(camera)[i] ?? NaN, 9));
    expect(again.distance).toBeCloseTo(camera.distance, 9);
  });
});

describe('a path in an address', () => {
  const keys: CameraKey[] = [
    { position: [0, 2, 26], target: [0, 0, 0], fovY: 0.8, seconds: 0 },
    { position: [10.1234, 2, -20], target: [0, 1, 0], fovY: 0.75, seconds: 2.5 },
  ];

  test('is short, and gives the same path', () => {
    expect(pathText(keys)).toBe('0,2,26,0,0,0,0.8,0_10.123,2,-20,0,1,0,0.75,2.5');
    expect(pathOf(pathText(keys))).toEqual([keys[0], { ...keys[1], position: [10.123, 2, -20] }]);
    expect(new URL(`http://a/?path=${pathText(keys)}`).search).toBe(`?path=${pathText(keys)}`);
  });

  test('that cannot be used is told in a sentence with the number of the key', () => {
    const [good, other] = pathText(keys).split('_') as [string, string];
    for (const bad of [
      '',
      '1,2,3',
      other.replace('2.5', '0'),
      other.replace('2.5', '601'),
      other.replace('0.75', '3.1'),
      other.replace('-20', '-50001'),
      other.replace('-20', 'NaN'),
      '1,2,3,1,2,3,0.8,1',
      `${other},1`,
    ])
      expect(pathOf(`${good}_${bad}`), bad).toMatch(/^Key view 2 of path is wrong/);
    expect(pathOf(other)).toMatch(/^Key view 1 of path is wrong/);
    expect(pathOf([good, ...Array<string>(MOST_KEYS).fill(other)].join('_'))).toMatch(/at most 64/);
    expect(pathOf([good, ...Array<string>(MOST_KEYS - 1).fill(other)].join('_'))).toHaveLength(64);
    expect(pathOf('1'.repeat(9000))).toMatch(/at most 64/);
  });
});
