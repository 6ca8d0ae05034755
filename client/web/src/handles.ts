// The handles on the page: buttons over the picture that are dragged, or moved with the arrow keys.
import type { Eye, Point } from './box';
import { el, setText } from './dom';
import { HOLD_MS, throttled } from './fields';
import { dragged, handleAt, within } from './handle';
import type { Choosable, Lens } from './handle';
import type { Vec3 } from './protocol';

export interface HandlesHost {
  handles(): readonly Choosable[]; // that there are now
  eye(): Eye | undefined; // that the picture is of; undefined: it is not one picture of one eye
  lens(): Lens;
  free(at: Point): boolean; // true: nothing else lies upon the picture there, and it can be taken hold of
  move(path: string, to: Vec3): void; // at most some 20 times a second
}

const KEY_STEP = 10; // pixels
const ARROWS: Record<string, Point> = {
  ArrowLeft: { x: -KEY_STEP, y: 0 },
  ArrowRight: { x: KEY_STEP, y: 0 },
  ArrowUp: { x: 0, y: -KEY_STEP },
  ArrowDown: { x: 0, y: KEY_STEP },
};
const text = (place: Vec3): string => `${place.map((x) => Number(x.toPrecision(3))).join(', ')} m`;

// One handle of the scene as an element. It shows the viewer's place while they move it, and the server's at other
// times: reports that are on their way hold the old one.
class Grip {
  readonly element = el('button', { type: 'button', class: 'handle' });
  private readonly label = el('span', { 'aria-hidden': 'true' });
  private readonly send: (to: Vec3) => void;
  private last: Point | undefined; // where the cursor that drags it was, when it last moved the handle
  private seen: Point | undefined; // where it was drawn
  private touchedAt = -Infinity;
  private at: Vec3;

  constructor(
    private handle: Choosable,
    private readonly host: HandlesHost,
  ) {
    this.at = handle.at;
    this.send = throttled((to) => host.move(handle.path, to));
    this.element.append(this.label);
    this.element.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      if (!this.handle.chosen) this.handle.choose();
      this.element.setPointerCapture(event.pointerId);
      this.last = { x: event.clientX, y: event.clientY };
      this.element.classList.add('held');
    });
    this.element.addEventListener('pointermove', (event) => {
      const { last } = this;
      if (!last) return;
      const now = { x: event.clientX, y: event.clientY };
      if (this.step({ x: now.x - last.x, y: now.y - last.y }, event.shiftKey)) this.last = now;
    });
    this.element.addEventListener('lostpointercapture', () => {
      this.last = undefined;
      this.element.classList.remove('held');
    });
    this.element.addEventListener('keydown', (event) => {
      const step = ARROWS[event.key];
      if (!step || event.ctrlKey || event.altKey || event.metaKey) return;
      event.preventDefault();
      event.stopPropagation(); // it is not for the camera
      this.step(step, event.shiftKey);
    });
  }

  follow(handle: Choosable): void {
    this.handle = handle;
    const { chosen, name } = handle;
    if (this.element.classList.contains('chosen') !== chosen || this.element.title === '') {
      this.element.classList.toggle('chosen', chosen);
      this.element.title = `Drag to move ${name}, for everyone; with Shift away and near`;
      this.element.setAttribute('aria-label', `${chosen ? 'Move' : 'Choose'} ${name}`);
      this.element.tabIndex = chosen ? 0 : -1; // the panel's list is the keyboard's way to choose
    }
    if (!this.last && performance.now() - this.touchedAt > HOLD_MS) this.at = handle.at;
  }

  // To be called once per animation frame.
  draw(eye: Eye | undefined, width: number, height: number): void {
    const seen = eye && handleAt(this.at, eye, width, height);
    this.seen = seen;
    if (seen) this.element.style.transform = `translate(${seen.x.toFixed(1)}px, ${seen.y.toFixed(1)}px)`;
    this.element.hidden = !seen && !this.last; // a hidden one would lose the cursor
    setText(this.label, text(this.at));
  }

  // False: it stays where it is, since nobody could take hold of it there. One that is lost already may move.
  private step(step: Point, along: boolean): boolean {
    const { host, seen } = this;
    const to = seen && { x: seen.x + step.x, y: seen.y + step.y };
    if (to && !along && host.free(seen) && !host.free(to)) return false;
    if (to && !along) this.seen = to; // until it is drawn
    this.at = within(dragged(this.at, host.lens(), step, along), this.handle);
    this.touchedAt = performance.now();
    this.send(this.at);
    return true;
  }
}

export class Handles {
  private readonly grips = new Map<string, Grip>(); // by path

  constructor(
    private readonly layer: HTMLElement, // as large as the picture
    private readonly host: HandlesHost,
  ) {}

  // To be called once per animation frame.
  draw(): void {
    const all = this.host.handles();
    for (const [path, { element }] of this.grips) {
      if (all.some((handle) => handle.path === path)) continue;
      element.remove();
      this.grips.delete(path);
    }
    if (all.length === 0) return;
    const eye = this.host.eye();
    const { clientWidth, clientHeight } = this.layer;
    for (const handle of all) {
      let grip = this.grips.get(handle.path);
      if (!grip) {
        grip = new Grip(handle, this.host);
        this.grips.set(handle.path, grip);
        this.layer.append(grip.element);
      }
      grip.follow(handle);
      grip.draw(eye, clientWidth, clientHeight);
    }
  }
}
