import { expect, test } from 'vitest';
import { lookAt } from '../src/camera';
import { stillAddress, stillName } from '../src/save-picture';
import type { Shown } from '../src/save-picture';

const shown: Shown = {
  camera: lookAt([0, 2, 26], [0, 0, 0]),
  fovY: 0.8,
  window: { width: 640, height: 360 },
  scene: 'cloud',
  view: 'depth',
  figure: undefined,
};
const size = { width: 320, height: 180 };
const camera = 'position=0,2,26&target=0,0,0&fov=0.8';

test('a still is asked for from this camera, in its format', () => {
  expect(stillAddress('png', shown, size)).toBe(`snapshot.png?${camera}&w=320&h=180&view=depth`);
  expect(stillAddress('png', { ...shown, view: 'picture' }, size)).toBe(`snapshot.png?${camera}&w=320&h=180`);
  expect(stillAddress('cut', shown, size)).toBe(`snapshot.png?${camera}&w=320&h=180&alpha=1`);
  expect(stillAddress('exr', shown, size)).toBe(`snapshot.exr?${camera}&w=320&h=180`);
});

test('its file has the scene’s name', () => {
  expect(stillName('png', 'cloud')).toBe('cloud.png');
  expect(stillName('cut', 'cloud')).toBe('cloud-cut-out.png');
  expect(stillName('exr', 'cloud')).toBe('cloud.exr');
});
