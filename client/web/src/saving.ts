// What the page does with a scene that takes a while: saves it, and its pictures, as files of this device.
import type { CameraKey } from './camera-keys';
import { savePicture } from './save-picture';
import type { Still } from './save-picture';
import { cloudName, noteOf, saveFile } from './scenes';
import type { Scenes } from './scenes';
import { sentence } from './sentence';
import type { Settings } from './settings';
import type { Viewer } from './viewer';

const fileOf = ({ welcome }: Viewer): string => cloudName(welcome?.scene ?? 'scene');

export async function saveScene(viewer: Viewer, scenes: Scenes, keys: readonly CameraKey[]): Promise<void> {
  saveFile(`${fileOf(viewer)}.toml`, await scenes.toml(viewer.camera, viewer.fovY, keys));
}

// `place`: the element that shows the viewer.
export function saveStill(
  kind: Still,
  viewer: Viewer,
  place: HTMLElement,
  settings: Settings,
  token: string | undefined,
): Promise<void> {
  const { camera, fovY, scene } = viewer;
  const window = { width: place.clientWidth, height: place.clientHeight };
  const figure = settings.box ? scene?.box : undefined;
  const shown = { camera, fovY, window, view: settings.view, scene: fileOf(viewer), figure };
  return savePicture(kind, shown, location.href, token);
}

export interface DoingHost {
  busy(text: string): void; // empty: nothing is being done
  note(text: string, kind?: 'info' | 'error'): void;
  failed(): void;
}

// Says what is being done, and then what came of it.
export async function doing(what: string, work: Promise<unknown>, host: DoingHost): Promise<void> {
  host.busy(what);
  host.note(what);
  try {
    const answer = await work;
    if (typeof answer === 'string' && answer.includes('\n')) host.note(noteOf(answer));
  } catch (error) {
    host.note(sentence(error instanceof Error ? error.message : String(error)), 'error');
    host.failed();
  }
  host.busy('');
}
