// The viewer's own settings. The browser keeps them between visits; without storage the defaults hold.
import { SIZE_CAPS } from './size';
import type { Eyes, Reprojection } from './viewing';

export interface Settings {
  cap: number | undefined; // index of SIZE_CAPS; undefined: chosen by the server's device
  quality: number; // JPEG, 0 = the server's
  stats: boolean;
  panel: boolean;
  eyes: Eyes;
  reprojection: Reprojection;
  predict: boolean; // true: poses are predicted for the time when their pictures are seen
}

const EYES: readonly Eyes[] = ['one', 'side'];
const REPROJECTIONS: readonly Reprojection[] = ['off', 'rotation', 'plane'];

const KEY = 'brume';

export function loadSettings(): Settings {
  const settings: Settings = {
    ...{ cap: undefined, quality: 0, stats: false, panel: false },
    ...{ eyes: 'one', reprojection: 'off', predict: false },
  };
  try {
    const stored = JSON.parse(localStorage.getItem(KEY) ?? '{}') as Partial<Record<keyof Settings, unknown>>;
    if (typeof stored.cap === 'number' && SIZE_CAPS[stored.cap]) settings.cap = stored.cap;
    if (Number.isInteger(stored.quality)) settings.quality = Math.min(100, Math.max(0, stored.quality as number));
    if (typeof stored.stats === 'boolean') settings.stats = stored.stats;
    if (typeof stored.panel === 'boolean') settings.panel = stored.panel;
    if (typeof stored.predict === 'boolean') settings.predict = stored.predict;
    settings.eyes = EYES.find((eyes) => eyes === stored.eyes) ?? settings.eyes;
    settings.reprojection = REPROJECTIONS.find((way) => way === stored.reprojection) ?? settings.reprojection;
  } catch {
    // No storage, or no valid content: the defaults hold.
  }
  return settings;
}

// Overrides stored settings by those of the page's address: ?eyes=side&reproject=plane&predict=1.
export function followAddress(settings: Settings, address: string): void {
  const asked = new URLSearchParams(address);
  settings.eyes = EYES.find((eyes) => eyes === asked.get('eyes')) ?? settings.eyes;
  settings.reprojection = REPROJECTIONS.find((way) => way === asked.get('reproject')) ?? settings.reprojection;
  if (asked.has('predict')) settings.predict = asked.get('predict') === '1';
}

export function saveSettings(settings: Settings): void {
  try {
    localStorage.setItem(KEY, JSON.stringify(settings));
  } catch {
    // Private windows may refuse to store.
  }
}
