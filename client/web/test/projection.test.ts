import { describe, expect, test } from 'vitest';
import { add, lookAt, normalize, orientation, scale, subtract } from '../src/camera';
import { Predictor, cameraGoesOn, headGoesOn } from '../src/predict';
import type { View } from '../src/projection';
import {
  angleBetween,
  apply,
  conjugate,
  covering,
  fromProjection,
  meanDepth,
  multiply,
  rotate,
  shaped,
  symmetric,
  warp,
  widened,
} from '../src/projection';
import type { Quat, Vec3 } from '../src/protocol';

// Numbers that are the same everywhere.
function dice(seed: number): () => number {
  let state = seed;
  return () => (state = (state * 16807) % 2147483647) / 2147483647;
}

function about(axis: Vec3, angle: number): Quat {
  const [x, y, z] = scale(normalize(axis), Math.sin(angle / 2));
  return [x, y, z, Math.cos(angle / 2)];
}

// Where `view` sees a point: texture coordinates, right and down; the camera's own maths, not the matrix's.
function seen(view: View, point: Vec3): [number, number] {
  const [x, y, z] = rotate(conjugate(view.orientation), subtract(point, view.position));
  const { left, right, up, down } = view.frustum;
  return [(x / -z + left) / (left + right), (up - y / -z) / (up + down)];
}

const toPlace = ([u, v]: readonly [number, number]): [number, number] => [2 * u - 1, 1 - 2 * v];
const frustum = { left: 1.2, right: 0.8, up: 0.7, down: 0.9 };
const other = { left: 0.6, right: 0.75, up: 0.5, down: 0.45 };

describe('frusta', () => {
  test('of an angle and a shape', () => {
    const f = symmetric(Math.PI / 2, 1.5);
    for (const [side, tangent] of [
      ['left', 1.5],
      ['right', 1.5],
      ['up', 1],
      ['down', 1],
    ] as const)
      expect(f[side]).toBeCloseTo(tangent, 12);
  });

  test('of a projection matrix that was made of one', () => {
    const { left, right, up, down } = frustum;
    const [w, h] = [left + right, up + down];
    const matrix = [2 / w, 0, 0, 0, 0, 2 / h, 0, 0, (right - left) / w, (up - down) / h, -1, -1, 0, 0, -0.2, 0];
    const found = fromProjection(new Float64Array(matrix));
    for (const side of ['left', 'right', 'up', 'down'] as const) expect(found[side]).toBeCloseTo(frustum[side], 12);
  });

  test('widened and shaped keep their middle', () => {
    for (const f of [widened(frustum, 0.1), shaped(frustum, 3), shaped(frustum, 0.3)]) {
      expect(f.right - f.left).toBeCloseTo(frustum.right - frustum.left, 12);
      expect(f.up - f.down).toBeCloseTo(frustum.up - frustum.down, 12);
      expect(f.left).toBeGreaterThanOrEqual(frustum.left);
      expect(f.up).toBeGreaterThanOrEqual(frustum.up);
    }
    const wide = widened(frustum, 0.1);
    expect((wide.left + wide.right) / (frustum.left + frustum.right)).toBeCloseTo(1.1, 12);
    const square = shaped(frustum, 1);
    expect(square.left + square.right).toBeCloseTo(square.up + square.down, 12);
  });

  test('cover a canted eye, and no more than it needs', () => {
    const same = covering({ orientation: [0, 0, 0, 1], frustum }, [0, 0, 0, 1]);
    for (const side of ['left', 'right', 'up', 'down'] as const) expect(same[side]).toBeCloseTo(frustum[side], 12);
    const canted = covering({ orientation: about([0, 1, 0], -0.1), frustum }, [0, 0, 0, 1]); // to the right
    expect(canted.right).toBeCloseTo(Math.tan(Math.atan(frustum.right) + 0.1), 12);
    expect(canted.left).toBeLessThan(frustum.left);
  });
});

describe('a warp', () => {
  const still: View = { position: [1, 2, 3], orientation: about([1, 2, 3], 0.5), frustum };

  test('between equal views changes nothing', () => {
    const matrix = warp(still, still);
    for (const [x, y] of [
      [-1, -1],
      [0, 0],
      [0.3, -0.8],
    ] as const) {
      const [u, v] = apply(matrix, x, y) ?? [NaN, NaN];
      expect(u).toBeCloseTo((x + 1) / 2, 12);
      expect(v).toBeCloseTo((1 - y) / 2, 12);
    }
  });

  test('finds what is far away, however the eye has turned', () => {
    const random = dice(7);
    for (let i = 0; i < 200; ++i) {
      const axis: Vec3 = [random() - 0.5, random() - 0.5, random() - 0.5];
      const turned = multiply(about(axis, 0.6 * random()), still.orientation);
      const shown: View = { position: still.position, orientation: turned, frustum: other };
      const [x, y] = [2 * random() - 1, 2 * random() - 1];
      const tangent: Vec3 = [
        ((x + 1) * (other.left + other.right)) / 2 - other.left,
        ((y + 1) * (other.up + other.down)) / 2 - other.down,
        -1,
      ];
      const point = add(shown.position, scale(rotate(turned, tangent), 50));
      const [u, v] = apply(warp(still, shown), x, y) ?? [NaN, NaN];
      const [wantedU, wantedV] = seen(still, point);
      expect(u).toBeCloseTo(wantedU, 9);
      expect(v).toBeCloseTo(wantedV, 9);
    }
  });

  test('with a depth finds what lies on that plane, also when the eye has moved', () => {
    const random = dice(11);
    const ahead = rotate(still.orientation, [0, 0, -1]);
    const depth = 8;
    for (let i = 0; i < 200; ++i) {
      const shown: View = {
        position: add(still.position, [random() - 0.5, random() - 0.5, random() - 0.5]),
        orientation: multiply(about([random(), 1, random()], 0.2 * random()), still.orientation),
        frustum: other,
      };
      const across = rotate(still.orientation, [2 * random() - 1, 2 * random() - 1, 0]);
      const point = add(add(still.position, scale(ahead, depth)), scale(across, 3));
      const [u, v] = apply(warp(still, shown, depth), ...toPlace(seen(shown, point))) ?? [NaN, NaN];
      const [wantedU, wantedV] = seen(still, point);
      expect(u).toBeCloseTo(wantedU, 9);
      expect(v).toBeCloseTo(wantedV, 9);
    }
  });

  test('shows nothing of what lies behind the eye it was made for', () => {
    const back: View = { ...still, orientation: multiply(still.orientation, about([0, 1, 0], Math.PI)) };
    expect(apply(warp(still, back), 0, 0)).toBeUndefined();
  });
});

describe('the angle between orientations', () => {
  test('is that of the turn between them, small ones too', () => {
    for (const angle of [0, 1e-6, 0.3, 3]) {
      const from = about([3, 1, 2], 1);
      expect(angleBetween(from, multiply(from, about([1, 5, 2], angle)))).toBeCloseTo(angle, 9);
    }
    expect(angleBetween([0, 0, 0, 1], [0, 0, 0, -1])).toBe(0);
  });
});

describe('the mean depth of a box', () => {
  const box = { lo: [-2, 0, -12] as Vec3, hi: [2, 4, -8] as Vec3 };
  const ahead: Quat = [0, 0, 0, 1];

  test('is that of its middle, along the axis of the view', () => {
    expect(meanDepth(box, { position: [1, 1, 0], orientation: ahead })).toBeCloseTo(10);
    const turned: Quat = [0, Math.sin(0.3), 0, Math.cos(0.3)];
    expect(meanDepth(box, { position: [0, 2, 0], orientation: turned })).toBeCloseTo(10 * Math.cos(0.6));
  });

  test('is infinite within it, behind it, and where there is none', () => {
    expect(meanDepth(box, { position: [0, 1, -9], orientation: ahead })).toBe(Infinity);
    expect(meanDepth(box, { position: [0, 1, -20], orientation: ahead })).toBe(Infinity);
    expect(meanDepth(undefined, { position: [0, 0, 0], orientation: ahead })).toBe(Infinity);
  });
});

describe('prediction', () => {
  const start = lookAt([3, 1, 10], [0, 0, 0]);
  const moving = (at: number) => ({ ...start, yaw: 3.1 + at * 1e-3, position: [at * 0.01, 0, 10] as Vec3 });

  test('goes on as before, also over half a turn', () => {
    const predictor = new Predictor(cameraGoesOn);
    for (let at = 0; at <= 200; at += 16) predictor.add(at, moving(at));
    const found = predictor.predict(50);
    expect(found && angleBetween(orientation(found), orientation(moving(242)))).toBeLessThan(1e-9);
    expect(found?.position[0]).toBeCloseTo(2.42, 9);
  });

  test('stays where the camera stays, and where nothing is known', () => {
    const predictor = new Predictor(cameraGoesOn);
    expect(predictor.predict(50)).toBeUndefined();
    predictor.add(0, start);
    expect(predictor.predict(50)).toEqual(start);
    for (let at = 16; at < 200; at += 16) predictor.add(at, start);
    expect(predictor.predict(50)).toEqual(start);
  });

  test('of a head goes on to turn about any axis, also past half a turn', () => {
    const axis = [0.48, 0.6, 0.64];
    const turned = (at: number) => {
      const half = 0.5 * (3 + 2e-3 * at);
      const sine = Math.sin(half);
      return [sine * axis[0]!, sine * axis[1]!, sine * axis[2]!, Math.cos(half)] as Quat;
    };
    const predictor = new Predictor(headGoesOn);
    const head = (at: number) => ({ position: [0, 1.6, at * 0.001] as Vec3, orientation: turned(at) });
    for (let at = 0; at <= 160; at += 8) predictor.add(at, head(at));
    const found = predictor.predict(60);
    expect(found && angleBetween(found.orientation, turned(220))).toBeLessThan(1e-6);
    expect(found?.position[2]).toBeCloseTo(0.22, 9);
    predictor.reset();
    for (let at = 0; at <= 160; at += 8) predictor.add(at, head(0));
    expect(predictor.predict(60)?.orientation.every((x, i) => Math.abs(x - turned(0)[i]!) < 1e-12)).toBe(true);
  });

  test('does not run away', () => {
    const predictor = new Predictor(cameraGoesOn);
    for (let at = 0; at <= 100; at += 10) predictor.add(at, moving(at));
    expect(predictor.predict(1e6)).toEqual(predictor.predict(150));
  });
});
