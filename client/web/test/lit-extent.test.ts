import { describe, expect, test } from 'vitest';
import { dot } from '../src/camera';
import { COARSEST, extentOf, lightSpaceOf, rateOf } from '../src/lit-extent';
import { momentOf } from '../src/lit-moment';
import { symmetric } from '../src/projection';
import type { Vec3 } from '../src/protocol';
import { messageOf, rows } from './lit-packer';

const ONE = 32 * 1024;
// Two particles of scale 1 and deviation 0.15 m, at x = 0 and 10 m.
const own = rows(0, 2, { 0: (i) => 10 * i, 3: () => ONE, 4: () => ONE });
const moment = momentOf(messageOf(own, undefined, { toLight: [0.6, 0.8, 0] }), own);

describe('the extent of particles', () => {
  test('is three deviations around them', () => {
    const { lo, hi, middle } = extentOf(moment);
    [-0.45, -0.45, -0.45].forEach((x, i) => expect(lo[i]).toBeCloseTo(x, 5));
    [10.45, 0.45, 0.45].forEach((x, i) => expect(hi[i]).toBeCloseTo(x, 5));
    expect(middle[0]).toBeCloseTo(5, 5);
    const none = rows(0, 0, {});
    expect(extentOf(momentOf(messageOf(none, undefined, {}), none)).middle).toEqual([0, 0, 0]);
  });

  test('in light space, whose axes are orthonormal, is along the light', () => {
    const { x, y, lo, hi } = lightSpaceOf(moment);
    const to: Vec3 = [0.6, 0.8, 0];
    expect([dot(x, x), dot(y, y), dot(x, y), dot(x, to), dot(y, to)].map((v) => Math.abs(v) < 1e-9)).toEqual([
      ...[false, false, true, true, true],
    ]);
    expect([lo[2], hi[2]].map((v) => Number(v.toFixed(4)))).toEqual([-0.45, 6.45]);
  });
});

describe('pixels between rays', () => {
  const rate = (distance: number, before = 1, height = 360) =>
    rateOf(
      moment,
      [5, 0, distance],
      { position: [5, 0, distance], orientation: [0, 0, 0, 1], frustum: symmetric(0.8, 16 / 9) },
      (height * 16) / 9,
      height,
      before,
    );

  test('are so many that a deviation has one and a half', () => {
    const pixels = (distance: number): number => 0.15 / Math.hypot(5, distance) / ((2 * Math.tan(0.4)) / 360);
    for (const distance of [10, 12, 15, 20]) {
      const { rate: chosen, proxies } = rate(distance);
      expect(proxies).toBe(2);
      expect(chosen).toBeLessThanOrEqual(pixels(distance) / 1.5 + 0.2);
      expect(chosen).toBeGreaterThan(pixels(distance) / 1.5 - 1.2);
    }
    expect(rate(500).rate).toBe(1);
    expect(rate(0.001).rate).toBe(COARSEST);
  });

  test('are kept while another number would hardly be better, and no more rays than memory has', () => {
    const turn = Array.from({ length: 400 }, (_, i) => 8 + i / 40);
    const change = turn.find((distance) => rate(distance, 3).rate !== 3 && distance > 10) ?? NaN;
    expect(rate(change - 0.1, 3).rate).toBe(3);
    expect(rate(500, 1, 2160).rate).toBe(4);
    expect(rate(-50).proxies).toBe(0); // all are behind
  });
});
