// Views of how a picture is made, which the server draws in its place, with a legend.
import type { SettingValue } from './protocol';
import type { Size } from './size';

export const VIEWS = [
  'picture',
  'wasted',
  'overdraw',
  'particles',
  'rays',
  'depth',
  'shadow',
  'light',
  'error',
] as const;
export type View = (typeof VIEWS)[number];

export const viewOf = (text: string | null): View => VIEWS.find((view) => view === text) ?? 'picture';

// Of a legend, in pixels of the picture at its scale of 1: its height with the margin below, and its least width.
const LEGEND = { height: 44, width: 194, wholeFrom: 360 };

// The part of a picture's height, from below, that a view's legend takes at most.
export function legendPart({ width, height }: Size): number {
  const scale = Math.max(1, Math.floor(Math.min(height / LEGEND.wholeFrom, width / LEGEND.width)));
  return Math.min(1, (LEGEND.height * scale) / height);
}

// What a view is called, and what it shows in a sentence. Without a sun viewText() says it otherwise.
export const VIEW_TEXTS: Record<View, readonly [name: string, says: string]> = {
  picture: ['The picture', ''],
  wasted: ['Wasted pixels', 'Of the particles’ tetrahedra on each pixel, the part that adds nothing to it.'],
  overdraw: ['Overdraw', 'How many of the particles’ hulls cover each pixel.'],
  particles: ['Particles', 'How many particles reach each square of 16 × 16 pixels.'],
  rays: ['Rays', 'The lattice of rays, and on how many slabs of each there is medium.'],
  depth: ['Optical depth', 'Of the particles in front of what is behind them.'],
  shadow: ['Shadow map', 'The planes of the sun’s shadow map, the one next to the sun first.'],
  light: ['Light', 'The part of the sun’s light that arrives at each particle.'],
  error: ['Error', 'Of single pixels, measured while your camera rests: at first there are none.'],
};

const WITHOUT_SUN: Partial<Record<View, string>> = {
  shadow: 'No sun shines here. Planes of the shadow map for one from the direction under Light, the next to it first.',
  light: 'No sun shines here. The part that would arrive at each particle from the direction under Light.',
};

// What the view shows, in a scene with that irradiance of the sun.
export function viewText(view: View, irradiance: SettingValue | undefined): string {
  const dark = Array.isArray(irradiance) && irradiance.every((x) => x === 0);
  return (dark ? WITHOUT_SUN[view] : undefined) ?? VIEW_TEXTS[view][1];
}
