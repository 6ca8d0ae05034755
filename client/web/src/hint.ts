// The line at the bottom of the page: what dragging and scrolling do now.
import type { Mode } from './controls';

// True if there is no mouse, and so hardly a keyboard.
export const touchOnly = (): boolean => matchMedia('(pointer: coarse)').matches;

export function hintText(mode: Mode, pushing: boolean, mayPush: boolean): string {
  const touch = touchOnly();
  // Many window managers take Alt-drag for themselves, and a Mac's Ctrl-click is another click.
  const key = /^(Mac|iP)/.test(navigator.platform) ? 'Option' : 'Ctrl';
  const turn = mode === 'orbit' ? 'orbit' : 'look around';
  const travel = mode === 'orbit' ? 'scroll to zoom' : 'WASD to fly';
  if (pushing) return 'Drag to push the cloud';
  if (touch) return `Drag to ${turn} · pinch to zoom${mayPush ? ' · hold, then drag to push' : ''}`;
  return `Drag to ${turn} · ${travel}${mayPush ? ` · ${key}-drag to push the cloud` : ''}`;
}
