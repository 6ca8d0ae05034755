// Taking back the newest change that anybody has made to the scene.
import type { Command } from './protocol';

interface Undoing {
  readonly scene: { readonly undo?: string } | undefined;
  readonly mayControl: boolean;
  command(order: Command): void;
}

export function undoLast(viewer: Undoing, note: (text: string) => void): void {
  const what = viewer.scene?.undo;
  if (!viewer.mayControl) return;
  if (what === undefined) return note('There is nothing to undo.');
  viewer.command({ kind: 'undo' });
  note(`Undone for everyone: ${what}.`);
}

// Calls the action for Ctrl+Z, or Cmd+Z. Fields have their own undo.
export function onUndo(action: () => void): void {
  window.addEventListener('keydown', (event) => {
    const asked =
      event.key.toLowerCase() === 'z' && (event.ctrlKey || event.metaKey) && !event.shiftKey && !event.altKey;
    const text = event.target instanceof HTMLElement && event.target.matches('textarea, input:not([type=range])');
    if (!asked || event.repeat || text) return;
    event.preventDefault();
    action();
  });
}
