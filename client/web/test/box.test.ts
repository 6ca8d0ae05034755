import { describe, expect, test } from 'vitest';
import { axesOf, barOf, cornersOf, edgesOf, lengthText } from '../src/box';
import { lookAt, orientation } from '../src/camera';
import type { Vec3 } from '../src/protocol';

const box = { lo: [-1, -1, -1] as Vec3, hi: [1, 1, 1] as Vec3 };
const eyeAt = (position: Vec3, target: Vec3 = [0, 0, 0]) => ({
  position,
  orientation: orientation(lookAt(position, target)),
  fovY: Math.PI / 2, // a picture 200 pixels high shows 2 m at a distance of 1 m: 100 pixels a metre
});
const [width, height] = [400, 200];

describe('the box', () => {
  test('has its corners and twelve edges where they are seen', () => {
    expect(new Set(cornersOf(box).map(String)).size).toBe(8);
    const edges = edgesOf(box, eyeAt([0, 0, 3]), width, height);
    expect(edges.length).toBe(12);
    const near = edges.filter(({ from, to }) => [from, to].every(({ x }) => Math.abs(Math.abs(x - 200) - 50) < 1e-6));
    expect(near.length).toBe(4); // of the face at z = 1, 2 m away: 50 pixels to each side
    for (const { from } of near) expect(Math.abs(Math.abs(from.y - 100) - 50)).toBeLessThan(1e-6);
  });

  test('has up above and right on the right', () => {
    const thin = { lo: [0, 0, 0] as Vec3, hi: [1, 0.5, 0.001] as Vec3 };
    const points = edgesOf(thin, eyeAt([0, 0, 2], [0, 0, 0]), width, height).flatMap(({ from, to }) => [from, to]);
    expect(Math.max(...points.map(({ x }) => x))).toBeCloseTo(250, 0);
    expect(Math.min(...points.map(({ y }) => y))).toBeCloseTo(75, 0);
    expect(Math.min(...points.map(({ x }) => x))).toBeCloseTo(200, 0);
  });

  test('has three faint edges, at the corner that is furthest', () => {
    const edges = edgesOf(box, eyeAt([3, 4, 5]), width, height);
    expect(edges.filter(({ behind }) => behind).length).toBe(3);
  });

  test('is cut off at the eye, and gone behind it', () => {
    for (const { from, to } of edgesOf(box, eyeAt([0, 0, 0], [0, 0, -1]), width, height))
      for (const point of [from, to]) expect(Number.isFinite(point.x) && Number.isFinite(point.y)).toBe(true);
    expect(edgesOf(box, eyeAt([0, 0, 0], [0, 0, -1]), width, height).length).toBe(8);
    expect(edgesOf(box, eyeAt([0, 0, 5], [0, 0, 9]), width, height)).toEqual([]);
  });
});

describe('the scale', () => {
  test('is a round length at the depth of the middle', () => {
    expect(barOf(box, eyeAt([0, 0, 4]), width, height)).toEqual({ metres: 2, pixels: expect.closeTo(50, 6) });
    expect(barOf(box, eyeAt([0, 0, 40]), width, height)).toEqual({ metres: 20, pixels: expect.closeTo(50, 6) });
    expect(barOf(box, eyeAt([0, 0, 11]), width, height)).toEqual({ metres: 10, pixels: expect.closeTo(1000 / 11, 6) });
    expect(barOf(box, eyeAt([0, 0, 4], [0, 0, 9]), width, height)).toBeUndefined();
  });

  test('has its unit', () => {
    expect(lengthText(5)).toBe('5 m');
    expect(lengthText(13.84, 7, 0.25)).toBe('13.8 × 7 × 0.25 m');
    expect(lengthText(2000)).toBe('2 km');
    expect(lengthText(0.05)).toBe('50 mm');
  });
});

describe('the axes', () => {
  const middle = { x: 100, y: 100 };
  const tips = (position: Vec3) =>
    Object.fromEntries(axesOf(eyeAt(position), middle, 30).map(({ name, tip, toward }) => [name, { tip, toward }]));

  test('point where the world’s do', () => {
    const front = tips([0, 0, 5]);
    expect(front['x']?.tip.x).toBeCloseTo(130, 9);
    expect(front['y']?.tip.y).toBeCloseTo(70, 9);
    expect(front['z']?.tip.x).toBeCloseTo(100, 9);
    expect(front['z']?.toward).toBe(true);
    const right = tips([5, 0, 0]);
    expect(right['z']?.tip.x).toBeCloseTo(70, 9);
    expect(right['x']?.toward).toBe(true);
    const behind = tips([0, 0, -5]);
    expect(behind['x']?.tip.x).toBeCloseTo(70, 9);
    expect(behind['z']?.toward).toBe(false);
  });

  test('are drawn from the furthest to the nearest', () => {
    expect(axesOf(eyeAt([3, 2, 5]), middle, 30).map(({ name }) => name)).toEqual(['y', 'x', 'z']);
    expect(axesOf(eyeAt([-3, 2, 5]), middle, 30).map(({ name }) => name)).toEqual(['x', 'y', 'z']);
  });
});
