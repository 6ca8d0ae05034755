// An idle camera on the key views of a scene.
import { describe, expect, test } from 'vitest';
import { lookAt, subtract } from '../src/camera';
import type { Camera } from '../src/camera';
import { alongPath } from '../src/idle-path';
import type { Vec3 } from '../src/protocol';

const KEYS = (
  [
    [0, 6, 26],
    [20, 8, 10],
    [0, 20, -20],
  ] as Vec3[]
).map((position) => ({
  ...{ position, target: [0, 0, 0] as Vec3, fovY: 0.8, seconds: 10 },
}));
const far = (a: Camera, b: Camera): number => Math.hypot(...subtract(a.position, b.position));
const DT = 1 / 60; // s

describe('a camera that drifts along key views', () => {
  test('joins them from where it is, without a jump, and goes there and back', () => {
    const drift = alongPath(KEYS);
    let camera = lookAt([5, 3, 40], [1, 0, 0]);
    let longest = 0;
    const nearest = KEYS.map(() => Infinity);
    for (let s = 0; s < 60; s += DT) {
      const next = drift(camera, DT);
      longest = Math.max(longest, far(camera, next));
      camera = next;
      KEYS.forEach(({ position }, i) => {
        nearest[i] = Math.min(nearest[i] ?? Infinity, Math.hypot(...subtract(position, camera.position)));
      });
    }
    expect(longest).toBeLessThan(0.15); // m in a sixtieth of a second; a jump would be metres
    for (const metres of nearest) expect(metres).toBeLessThan(0.1);
  });

  test('begins anew where somebody has left it', () => {
    const drift = alongPath(KEYS);
    let camera = lookAt([0, 6, 26], [0, 0, 0]);
    for (let s = 0; s < 12; s += DT) camera = drift(camera, DT);
    const moved = lookAt([-30, 5, 0], [0, 0, 0]);
    expect(far(drift(moved, DT), moved)).toBeLessThan(0.1);
  });
});
