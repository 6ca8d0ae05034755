// Turns mouse, touch and keyboard events into camera moves and pushes.
import { add, axes, look, metresPerPixel, move, orbit, rayThrough, scale, zoom } from './camera';
import type { Camera, Ray } from './camera';
import type { Vec3 } from './protocol';
import type { Pusher } from './pusher';

export type Mode = 'orbit' | 'fly';

export interface ControlsHost {
  camera: Camera;
  readonly fovY: number;
  readonly mode: Mode;
  readonly mayLook: boolean; // false: nothing moves the camera
  readonly pushing: boolean; // true: a drag pushes
  readonly touches: boolean; // true: and two fingers, or another button, turn
  readonly mayPush: boolean; // true: this viewer's role allows pushes
  touched(): void; // the viewer has moved the camera or pressed the canvas
  pushed(active: boolean, x: number, y: number): void; // active: a push is under way; x, y: CSS pixels
}

type Gesture = 'turn' | 'pan' | 'push';
interface Pointer {
  x: number;
  y: number;
  startX: number;
  startY: number;
  gesture: Gesture;
  timer: number | undefined; // turns a long press into a push
}

const TURN_PER_PIXEL = 0.005; // rad
const TURN_PER_SECOND = 1.4; // rad, by key
const PUSH_PER_SECOND = 0.8; // of the picture's shorter side, by key
const ZOOM_PER_PIXEL = 0.0012;
const LONG_PRESS_MS = 380;
const LONG_PRESS_SLACK = 8; // px; a finger that moves further makes no long press
const FLY_SECONDS = 3; // to cross the distance to the pivot
const FLY_FAST = 4;
const FLY_SETTLE_S = 0.1; // time constant of starting and stopping
const MOVES: Record<string, Vec3> = {
  KeyD: [1, 0, 0],
  KeyA: [-1, 0, 0],
  KeyE: [0, 1, 0],
  KeyQ: [0, -1, 0],
  KeyW: [0, 0, 1],
  KeyS: [0, 0, -1],
};
const TURNS: Record<string, readonly [yaw: number, pitch: number]> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, 1],
  ArrowDown: [0, -1],
};

export class Controls {
  private readonly pointers = new Map<number, Pointer>();
  private readonly keys = new Set<string>(); // that are held
  private readonly tapped = new Set<string>(); // pressed since the last picture, and perhaps let go
  private byKeys: Pointer | undefined; // that the arrow keys push with
  private velocity: Vec3 = [0, 0, 0]; // in pivot distances a second, along the camera's axes
  private fast = false;

  constructor(
    private readonly surface: HTMLElement, // where the picture is
    private readonly keyboard: HTMLElement | Window, // hears keys; a surface that does is focused when it is pressed
    private readonly host: ControlsHost,
    private readonly pusher: Pusher,
    ending: AbortSignal,
  ) {
    const until = { signal: ending };
    surface.addEventListener('pointerdown', (event) => this.down(event), until);
    surface.addEventListener('pointermove', (event) => this.moved(event), until);
    surface.addEventListener('pointerup', (event) => this.up(event, false), until);
    surface.addEventListener('pointercancel', (event) => this.up(event, true), until);
    surface.addEventListener('wheel', (event) => this.wheel(event), { passive: false, ...until });
    surface.addEventListener('contextmenu', (event) => event.preventDefault(), until);
    for (const [name, pressed] of [
      ['keydown', true],
      ['keyup', false],
    ] as const)
      keyboard.addEventListener(name, (event) => this.key(event as KeyboardEvent, pressed), until);
    for (const target of new Set([keyboard, window])) target.addEventListener('blur', () => this.keys.clear(), until);
  }

  // Call once per animation frame; `dt` in seconds.
  update(now: number, dt: number): void {
    this.pusher.update(now);
    let yaw = 0;
    let pitch = 0;
    let goal: Vec3 = [0, 0, 0];
    const held = new Set([...this.keys, ...this.tapped]);
    this.tapped.clear();
    for (const code of held) {
      const turn = TURNS[code];
      if (turn) [yaw, pitch] = [yaw + turn[0], pitch + turn[1]];
      const step = MOVES[code];
      if (step) goal = add(goal, step);
    }
    if (this.host.pushing && this.host.mayPush) {
      this.pushByKeys(now, yaw * dt, pitch * dt);
      [yaw, pitch] = [0, 0];
    } else this.pushByKeys(now, 0, 0);
    if (yaw !== 0 || pitch !== 0) {
      const angle = TURN_PER_SECOND * dt;
      // The right arrow moves the camera to the right around the pivot, or turns its view to the right.
      this.host.camera =
        this.host.mode === 'orbit'
          ? orbit(this.host.camera, yaw * angle, -pitch * angle)
          : look(this.host.camera, -yaw * angle, pitch * angle);
    }
    const speed = (this.fast ? FLY_FAST : 1) / FLY_SECONDS;
    const blend = 1 - Math.exp(-dt / FLY_SETTLE_S);
    this.velocity = add(scale(this.velocity, 1 - blend), scale(goal, speed * blend));
    if (Math.hypot(...this.velocity) < 1e-3) {
      this.velocity = [0, 0, 0];
      return;
    }
    const reach = this.host.camera.distance * dt;
    this.host.camera = move(
      this.host.camera,
      this.velocity[0] * reach,
      this.velocity[1] * reach,
      this.velocity[2] * reach,
    );
  }

  private down(event: PointerEvent): void {
    if (!this.host.mayLook) return;
    event.preventDefault();
    // Keys go to the camera again, not to a field. Where the whole window's keys do, nothing needs the focus, and none
    // of the keyboard's focus ring is drawn.
    if (this.keyboard instanceof HTMLElement) this.keyboard.focus({ preventScroll: true });
    else if (document.activeElement instanceof HTMLElement) document.activeElement.blur();
    this.surface.setPointerCapture(event.pointerId);
    this.host.touched();
    const { clientX: x, clientY: y } = event;
    const pointer: Pointer = { x, y, startX: x, startY: y, gesture: this.gestureOf(event), timer: undefined };
    this.pointers.set(event.pointerId, pointer);
    if (this.pointers.size > 1) {
      // With a second finger the gesture is a pinch.
      for (const other of this.pointers.values()) {
        window.clearTimeout(other.timer);
        if (other.gesture === 'push') this.stopPush(other, true);
        other.gesture = this.aside;
      }
    } else if (pointer.gesture === 'push') {
      this.startPush(event.timeStamp, pointer);
    } else if (event.pointerType !== 'mouse' && this.host.mayPush) {
      pointer.timer = window.setTimeout(() => {
        pointer.gesture = 'push';
        navigator.vibrate?.(12);
        this.startPush(performance.now(), pointer);
      }, LONG_PRESS_MS);
    }
  }

  private gestureOf(event: PointerEvent): Gesture {
    if (event.button !== 0) return this.aside;
    if (this.host.mayPush && (event.altKey || event.ctrlKey || event.metaKey)) return 'push';
    if (event.shiftKey) return this.aside;
    return this.host.pushing ? 'push' : 'turn';
  }

  private moved(event: PointerEvent): void {
    const pointer = this.pointers.get(event.pointerId);
    if (!pointer) return;
    const dx = event.clientX - pointer.x;
    const dy = event.clientY - pointer.y;
    const before = this.pointers.size === 2 ? this.span() : 0;
    pointer.x = event.clientX;
    pointer.y = event.clientY;
    if (Math.hypot(pointer.x - pointer.startX, pointer.y - pointer.startY) > LONG_PRESS_SLACK) {
      window.clearTimeout(pointer.timer);
    }
    if (this.pointers.size === 2) {
      // Each finger carries half of the way; their distance zooms.
      if (this.host.touches) this.turn(dx / 2, dy / 2);
      else this.pan(dx / 2, dy / 2);
      const after = this.span();
      if (before > 0 && after > 0) this.host.camera = zoom(this.host.camera, before / after);
    } else if (pointer.gesture === 'push') {
      this.dragPush(event.timeStamp, pointer, dx, dy);
    } else if (pointer.gesture === 'pan') {
      this.pan(dx, dy);
    } else {
      this.turn(dx, dy);
    }
  }

  private up(event: PointerEvent, cancelled: boolean): void {
    const pointer = this.pointers.get(event.pointerId);
    if (!pointer) return;
    window.clearTimeout(pointer.timer);
    if (pointer.gesture === 'push') this.stopPush(pointer, cancelled);
    this.pointers.delete(event.pointerId);
    // The finger that stays after a pinch turns again.
    for (const other of this.pointers.values()) other.gesture = 'turn';
  }

  private wheel(event: WheelEvent): void {
    if (!this.host.mayLook) return;
    event.preventDefault();
    this.host.touched();
    const lines =
      event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 24 : event.deltaMode === WheelEvent.DOM_DELTA_PAGE ? 400 : 1;
    // A pinch on a touchpad arrives as small steps with the control key.
    const pixels = event.deltaY * lines * (event.ctrlKey ? 8 : 1);
    const factor = Math.exp(Math.max(-400, Math.min(400, pixels)) * ZOOM_PER_PIXEL);
    const camera = this.host.camera;
    this.host.camera =
      this.host.mode === 'orbit' ? zoom(camera, factor) : move(camera, 0, 0, camera.distance * (1 - factor) * 0.5);
  }

  private key(event: KeyboardEvent, pressed: boolean): void {
    this.fast = event.shiftKey;
    // macOS tells of no key that is let go while Command is held.
    if (event.key === 'Meta') this.keys.clear();
    if (!(event.code in MOVES) && !(event.code in TURNS)) return;
    if (!pressed) {
      this.keys.delete(event.code);
      return;
    }
    if (!this.host.mayLook) return;
    if (event.ctrlKey || event.altKey || event.metaKey || isField(event.target)) return;
    if (isInDialog(event.target) || (event.code in TURNS && isScroller(event.target))) return;
    this.host.touched();
    this.keys.add(event.code);
    this.tapped.add(event.code);
    event.preventDefault();
  }

  // What two fingers do, and all but a plain drag.
  private get aside(): Gesture {
    return this.host.touches ? 'turn' : 'pan';
  }

  private turn(dx: number, dy: number): void {
    const turn = this.host.mode === 'orbit' ? orbit : look;
    this.host.camera = turn(this.host.camera, -dx * TURN_PER_PIXEL, -dy * TURN_PER_PIXEL);
  }

  private pan(dx: number, dy: number): void {
    const metres = metresPerPixel(this.host.camera, this.host.fovY, this.surface.clientHeight);
    this.host.camera = move(this.host.camera, -dx * metres, dy * metres, 0);
  }

  private span(): number {
    const [a, b] = [...this.pointers.values()];
    return a && b ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
  }

  private rayAt(pointer: Pointer): Ray {
    const box = this.surface.getBoundingClientRect();
    const x = ((pointer.x - box.left) / box.width) * 2 - 1;
    const y = 1 - ((pointer.y - box.top) / box.height) * 2;
    return rayThrough(this.host.camera, this.host.fovY, box.width / box.height, x, y);
  }

  // While pushes are on, the arrow keys push: from the middle of the picture, as far as they are held. `right` and `up`
  // in seconds; without both the push ends.
  private pushByKeys(now: number, right: number, up: number): void {
    const { width, height, left, top } = this.surface.getBoundingClientRect();
    if (right === 0 && up === 0) {
      if (this.byKeys) this.stopPush(this.byKeys, false);
      this.byKeys = undefined;
      return;
    }
    if (!this.byKeys) {
      const [x, y] = [left + width / 2, top + height / 2];
      this.byKeys = { x, y, startX: x, startY: y, gesture: 'push', timer: undefined };
      this.startPush(now, this.byKeys);
    }
    const pointer = this.byKeys;
    const [x, y] = [pointer.x, pointer.y];
    const step = PUSH_PER_SECOND * Math.min(width, height);
    pointer.x = Math.max(left, Math.min(left + width, x + right * step));
    pointer.y = Math.max(top, Math.min(top + height, y - up * step));
    this.dragPush(now, pointer, pointer.x - x, pointer.y - y);
  }

  private startPush(now: number, pointer: Pointer): void {
    this.host.pushed(true, pointer.x, pointer.y);
    this.pusher.begin(now, this.rayAt(pointer));
  }

  private dragPush(now: number, pointer: Pointer, dx: number, dy: number): void {
    this.host.pushed(true, pointer.x, pointer.y);
    const { right, up } = axes(this.host.camera);
    const metres = metresPerPixel(this.host.camera, this.host.fovY, this.surface.clientHeight);
    this.pusher.drag(now, this.rayAt(pointer), add(scale(right, dx * metres), scale(up, -dy * metres)));
  }

  private stopPush(pointer: Pointer, cancelled: boolean): void {
    this.host.pushed(false, pointer.x, pointer.y);
    if (cancelled) this.pusher.cancel();
    else this.pusher.end(performance.now());
  }
}

// True if this is a field of the panel, whose keys are not for the camera.
function isField(target: EventTarget | null): boolean {
  return target instanceof HTMLElement && target.matches('input, select, textarea');
}

// True if it is in a dialog, which has the keys to itself.
const isInDialog = (target: EventTarget | null): boolean =>
  target instanceof HTMLElement && target.closest('dialog') !== null;

// True if arrow keys scroll there.
const isScroller = (target: EventTarget | null): boolean =>
  target instanceof HTMLElement && 'scrolls' in target.dataset;

// Calls the action of a key's code when it is pressed alone. In a field only Escape counts.
export function onKeys(actions: Record<string, () => void>): void {
  window.addEventListener('keydown', (event) => {
    if (event.repeat || event.ctrlKey || event.altKey || event.metaKey) return;
    if (isInDialog(event.target) || (isField(event.target) && event.code !== 'Escape')) return;
    actions[event.code]?.();
  });
}
