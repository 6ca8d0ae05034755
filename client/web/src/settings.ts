// What the viewer chose for this browser: kept between visits, and never needed.
import { SIZE_CAPS } from './size';

export interface Settings {
  cap: number | undefined; // index of SIZE_CAPS; undefined: by the server's device
  quality: number; // JPEG, 0 = the server's
  stats: boolean;
  panel: boolean;
}

const KEY = 'brume';

export function loadSettings(): Settings {
  const settings: Settings = { cap: undefined, quality: 0, stats: false, panel: false };
  try {
    const stored = JSON.parse(localStorage.getItem(KEY) ?? '{}') as Partial<Record<keyof Settings, unknown>>;
    if (typeof stored.cap === 'number' && SIZE_CAPS[stored.cap]) settings.cap = stored.cap;
    if (Number.isInteger(stored.quality)) settings.quality = Math.min(100, Math.max(0, stored.quality as number));
    if (typeof stored.stats === 'boolean') settings.stats = stored.stats;
    if (typeof stored.panel === 'boolean') settings.panel = stored.panel;
  } catch {
    // No storage, or not ours: the defaults will do.
  }
  return settings;
}

export function saveSettings(settings: Settings): void {
  try {
    localStorage.setItem(KEY, JSON.stringify(settings));
  } catch {
    // Private windows may refuse.
  }
}
