// Pointing: while it is on, the mouse over the view, or a finger where it is put down, shows all a dot.
import { rayThrough } from './camera';
import type { Ray } from './camera';
import type { Viewer } from './viewer';

export class Pointing {
  private chosen = false;

  constructor(
    private readonly view: HTMLElement,
    private readonly viewer: () => Viewer,
  ) {
    view.addEventListener('pointermove', (event) => event.pointerType === 'mouse' && this.follow(event));
    view.addEventListener('pointerdown', (event) => event.pointerType !== 'mouse' && this.follow(event));
    view.addEventListener('pointerleave', (event) => event.pointerType === 'mouse' && this.end());
  }

  get on(): boolean {
    return this.chosen;
  }

  set on(on: boolean) {
    this.chosen = on;
    if (!on) this.end();
  }

  private end(): void {
    this.viewer().people.point(undefined);
  }

  private follow(event: PointerEvent): void {
    if (!this.chosen) return;
    this.viewer().people.point(this.rayAt(event.clientX, event.clientY));
  }

  private rayAt(left: number, top: number): Ray {
    const box = this.view.getBoundingClientRect();
    const { camera, fovY } = this.viewer();
    const [x, y] = [((left - box.left) / box.width) * 2 - 1, 1 - ((top - box.top) / box.height) * 2];
    return rayThrough(camera, fovY, box.width / box.height, x, y);
  }
}
