// The tab's camera, kept while its page is loaded again.
import { keptNames } from './address';
import type { Camera } from './camera';
import { cameraFrom, cameraText } from './move';

const nameHere = (): string => keptNames('brume-camera', location.pathname)[0];

export function keepCamera(scene: string, camera: Camera): void {
  try {
    sessionStorage.setItem(nameHere(), JSON.stringify({ scene, at: cameraText(camera) }));
  } catch {
    // Without storage the camera is lost when the page is loaded again.
  }
}

// The camera of the page that was here before it was loaded again, and its scene. Undefined for a page that was opened
// anew: its address says where it looks from.
export function keptCamera(): { camera: Camera; scene: string } | undefined {
  const [entry] = performance.getEntriesByType('navigation') as PerformanceNavigationTiming[];
  if (entry?.type !== 'reload' && entry?.type !== 'back_forward') return undefined;
  try {
    const kept = JSON.parse(sessionStorage.getItem(nameHere()) ?? '{}') as { scene?: unknown; at?: unknown };
    const camera = typeof kept.at === 'string' ? cameraFrom(kept.at) : undefined;
    return camera && typeof kept.scene === 'string' ? { camera, scene: kept.scene } : undefined;
  } catch {
    return undefined;
  }
}
