// The idle camera (idle.ts) of a viewer in its element: what counts as a touch there, and who else has the camera.
import { fitAspect } from './camera';
import type { Camera } from './camera';
import type { CameraKey } from './camera-keys';
import { IdleCamera, circle } from './idle';
import type { Drift, IdleWish } from './idle';
import { alongPath } from './idle-path';

interface Watched {
  camera: Camera;
  readonly home: Camera;
  readonly linkState: string;
  readonly headset: unknown;
  readonly people: { readonly leader: unknown };
  readonly welcome: { readonly path: readonly CameraKey[] } | undefined;
}

// Along the key views of the scene, where it has any; else about the pivot.
function driftOf(viewer: Watched, turn: number): Drift {
  let [keys, drift]: [unknown, Drift] = [undefined, circle(turn)];
  return (camera, seconds) => {
    const path = viewer.welcome?.path ?? [];
    if (keys !== path) [keys, drift] = [path, path.length > 1 ? alongPath(path) : circle(turn)];
    return drift(camera, seconds);
  };
}

const LONGEST_S = 0.1; // that one animation frame counts for

export function watchIdle(surface: HTMLElement, viewer: Watched, wish: IdleWish, ending: AbortSignal): IdleCamera {
  const until = { signal: ending, capture: true, passive: true };
  const pressed = new Set<number>(); // pointers
  const stillness = matchMedia('(prefers-reduced-motion: reduce)');
  const idle = new IdleCamera(
    {
      get camera() {
        return viewer.camera;
      },
      set camera(value) {
        viewer.camera = value;
      },
      get home() {
        if ((viewer.welcome?.path.length ?? 0) > 1) return viewer.camera; // the path is where it comes back to
        return fitAspect(viewer.home, surface.clientWidth / Math.max(1, surface.clientHeight));
      },
      get busy() {
        return pressed.size > 0 || viewer.headset !== undefined || viewer.people.leader !== undefined;
      },
      get live() {
        return viewer.linkState === 'connected';
      },
      get still() {
        return stillness.matches;
      },
    },
    wish,
    performance.now(),
    driftOf(viewer, wish.turn),
  );
  const touch = (): void => idle.touch(performance.now());
  surface.addEventListener('pointerdown', ({ pointerId }) => void pressed.add(pointerId), until);
  for (const name of ['pointerup', 'pointercancel', 'lostpointercapture'] as const)
    window.addEventListener(name, ({ pointerId }) => void pressed.delete(pointerId), until);
  surface.addEventListener('wheel', touch, until);
  window.addEventListener('keydown', touch, until);
  let before = performance.now();
  const animate = (now: number): void => {
    if (ending.aborted) return;
    requestAnimationFrame(animate);
    idle.update(now, Math.min(LONGEST_S, Math.max(0, (now - before) / 1000)));
    before = now;
  };
  requestAnimationFrame(animate);
  return idle;
}
