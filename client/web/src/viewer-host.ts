// What a viewer needs of the page around it, and what it is asked for.
import type { LinkState } from './connection';
import type { Latency } from './latency';
import type { Frame, LitParticles, SceneState, Welcome } from './protocol';
import type { Place } from './place';
import type { Renewal } from './renewal';
import type { Size } from './size';
import type { View } from './views';

// Where a viewer draws and what it listens to.
export interface Stage {
  surface: HTMLElement; // the picture's place: the mouse and touch are for it, it has its size
  canvas: HTMLCanvasElement;
  warped: HTMLCanvasElement; // above the canvas
  drawing: HTMLCanvasElement; // above both: lines
  keys: HTMLElement | Window; // hears the keyboard
}

export interface ViewerEvents {
  link(state: LinkState): void;
  welcome(welcome: Welcome): void;
  scene(scene: SceneState): void;
  picture(frame: Frame, latency: Latency | undefined): void; // latency: of the first frame of its pose
  drawn(message: LitParticles): void; // particles came, from which this page draws
  renew(): Promise<Renewal | undefined>; // another token, when the server takes this one no more
  people(): void; // others came, left, point or present
  note(text: string, kind: 'info' | 'error'): void;
  changed(): void; // mode, pushing or headset
  touched(): void; // the camera was moved by hand, or the picture pressed
  pushed(active: boolean, x: number, y: number): void; // x, y: CSS pixels
  moved(page: string): void; // the server has stopped and named another, whose page answers
}

// touch: a drag pushes, two fingers turn. push: a drag turns, a long press pushes. look: no pushes. none: nothing.
export const CONTROLS = ['push', 'touch', 'look', 'none'] as const;
export type Control = (typeof CONTROLS)[number];
export const controlOf = (text: string | null): Control => CONTROLS.find((name) => name === text) ?? 'push';

export interface Wishes {
  cap?: Size | undefined; // undefined: by the server's device, and by how fast it answers
  quality: number; // JPEG, 0 = the server's
  predict: boolean;
  control: Control; // what the mouse, touch and keys may do
  place: Place; // of the first camera; what it leaves out is the scene's
  view: View; // drawn in the picture's place
  box: boolean; // true: the medium's box and a scale are drawn over the picture
}
