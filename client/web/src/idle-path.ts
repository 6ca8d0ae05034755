// The drift of an idle camera along a scene's key views, there and back. It uses nothing of the page.
import { add, lookAt, pivot, same, scale, subtract } from './camera';
import type { Camera } from './camera';
import { KeyPath, cameraOf } from './camera-keys';
import type { CameraKey } from './camera-keys';
import type { Drift } from './idle';

const JOIN_S = 8; // from where the camera is to the path
const LOOKS = 64; // places of the path at which it may be joined

const between = (a: Camera, b: Camera, part: number): Camera => {
  const t = part * part * (3 - 2 * part);
  const mixed = (x: Camera['position'], y: Camera['position']) => add(x, scale(subtract(y, x), t));
  return lookAt(mixed(a.position, b.position), mixed(pivot(a), pivot(b)));
};

// Precondition: two keys at least. A camera that was moved by somebody else joins the path anew, where it is nearest.
export function alongPath(keys: readonly CameraKey[]): Drift {
  const path = new KeyPath(keys);
  const there = (seconds: number): number => {
    const along = seconds % (2 * path.seconds);
    return along < path.seconds ? along : 2 * path.seconds - along;
  };
  const at = (seconds: number): Camera => cameraOf(path.at(there(seconds)));
  let last: Camera | undefined;
  let [from, joined, seconds]: [Camera, number, number] = [at(0), 0, 0];
  return (camera, passed) => {
    if (!last || !same(last, camera)) {
      const far = (s: number): number => Math.hypot(...subtract(at(s).position, camera.position));
      const times = Array.from({ length: LOOKS + 1 }, (_, i) => (i / LOOKS) * path.seconds);
      seconds = times.reduce((best, one) => (far(one) < far(best) ? one : best));
      [from, joined] = [camera, 0];
    }
    joined = Math.min(1, joined + passed / JOIN_S);
    seconds += passed;
    last = joined < 1 ? between(from, at(seconds), joined) : at(seconds);
    return last;
  };
}
