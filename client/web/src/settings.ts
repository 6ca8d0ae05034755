// The viewer's own settings. The browser keeps them between visits; without storage the defaults hold.
import { DRAW_WISHES } from './draw-choice';
import type { DrawWish } from './draw-choice';
import { SIZE_CAPS } from './size';
import { EYES, REPROJECTIONS } from './viewing';
import type { Eyes, ReprojectionWish } from './viewing';
import { VIEWS } from './views';
import type { View } from './views';

export interface Settings {
  cap: number | undefined; // index of SIZE_CAPS; undefined: chosen by the server's device
  quality: number; // JPEG, 0 = the server's
  stats: boolean;
  panel: boolean;
  eyes: Eyes;
  reprojection: ReprojectionWish;
  draw: DrawWish;
  box: boolean; // true: the medium's box and a scale are drawn over the picture
  view: View; // not kept between visits
  predict: boolean; // true: poses are predicted for the time when their pictures are seen
}

const KEY = 'brume';

export function loadSettings(): Settings {
  const settings: Settings = {
    ...{ cap: undefined, quality: 0, stats: false, panel: false },
    ...{ eyes: 'one', reprojection: 'auto', draw: 'auto', predict: false, box: false, view: 'picture' },
  };
  try {
    const stored = JSON.parse(localStorage.getItem(KEY) ?? '{}') as Partial<Record<keyof Settings, unknown>>;
    if (typeof stored.cap === 'number' && SIZE_CAPS[stored.cap]) settings.cap = stored.cap;
    if (Number.isInteger(stored.quality)) settings.quality = Math.min(100, Math.max(0, stored.quality as number));
    if (typeof stored.stats === 'boolean') settings.stats = stored.stats;
    if (typeof stored.panel === 'boolean') settings.panel = stored.panel;
    if (typeof stored.box === 'boolean') settings.box = stored.box;
    if (typeof stored.predict === 'boolean') settings.predict = stored.predict;
    settings.eyes = EYES.find((eyes) => eyes === stored.eyes) ?? settings.eyes;
    settings.reprojection = REPROJECTIONS.find((way) => way === stored.reprojection) ?? settings.reprojection;
    settings.draw = DRAW_WISHES.find((wish) => wish === stored.draw) ?? settings.draw;
  } catch {
    // No storage, or no valid content: the defaults hold.
  }
  return settings;
}

const SIZES = SIZE_CAPS.map(({ width, height }) => `${width}x${height}`);

// Overrides stored settings by those of the page's address: ?eyes=side&reproject=plane&draw=client&predict=1&box=1
// &size=1280x720&quality=90&view=depth. What cannot be used is left as it was; for each of these a sentence is returned
// that says what is allowed.
export function followAddress(settings: Settings, address: string): string[] {
  const asked = new URLSearchParams(address);
  const faults: string[] = [];
  const take = (name: string, allowed: readonly string[], use: (text: string, index: number) => void): void => {
    const text = asked.get(name);
    if (text === null) return;
    const index = allowed.indexOf(text);
    if (index >= 0) use(text, index);
    else faults.push(`${name} in the address is one of ${allowed.join(', ')}.`);
  };
  take('eyes', EYES, (_, index) => (settings.eyes = EYES[index] ?? settings.eyes));
  take('reproject', REPROJECTIONS, (_, i) => (settings.reprojection = REPROJECTIONS[i] ?? settings.reprojection));
  take('draw', DRAW_WISHES, (_, i) => (settings.draw = DRAW_WISHES[i] ?? settings.draw));
  take('predict', ['0', '1'], (text) => (settings.predict = text === '1'));
  take('box', ['0', '1'], (text) => (settings.box = text === '1'));
  take('view', VIEWS, (_, index) => (settings.view = VIEWS[index] ?? settings.view));
  take('size', SIZES, (_, index) => (settings.cap = index));
  const quality = asked.get('quality');
  if (quality !== null) {
    if (/^\d{1,3}$/.test(quality) && Number(quality) <= 100) settings.quality = Number(quality);
    else faults.push('quality in the address is a whole number from 0 to 100.');
  }
  return faults;
}

// The same as parameters of an address; those that are as in a new browser are left out.
export function settingsText(settings: Settings): [name: string, value: string][] {
  const { eyes, reprojection, draw, predict, box, cap, quality, view } = settings;
  const all: [string, string, boolean][] = [
    ['eyes', eyes, eyes !== 'one'],
    ['reproject', reprojection, reprojection !== 'auto'],
    ['draw', draw, draw !== 'auto'],
    ['predict', '1', predict],
    ['box', '1', box],
    ['size', SIZES[cap ?? -1] ?? '', cap !== undefined],
    ['quality', String(quality), quality !== 0],
    ['view', view, view !== 'picture'],
  ];
  return all.flatMap(([name, value, given]) => (given ? [[name, value] as [string, string]] : []));
}

export function saveSettings(settings: Settings): void {
  try {
    localStorage.setItem(KEY, JSON.stringify(settings));
  } catch {
    // Private windows may refuse to store.
  }
}
