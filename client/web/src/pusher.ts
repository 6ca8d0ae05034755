// Pushing the cloud: turns a drag of the cursor into impulses along its ray, at a bounded rate. No page.
import { add, length, scale } from './camera';
import type { Ray } from './camera';
import type { Command, Vec3 } from './protocol';

const INTERVAL_MS = 1000 / 30;
// A cursor that rests this long blows particles away from its ray.
const REST_MS = 250;
const REST_STRENGTH = 0.3;
// What a push adds, per impulse, of the cursor's own speed: particles that a ray of some metres passes over end up about as
// fast as a click would make them.
const DRAG_STRENGTH = 0.15;
const MAX_SPEED = 60; // m/s, the server takes up to 100 on each axis

export class Pusher {
  private active = false;
  private sent = false;
  private ray: Ray | undefined;
  private moved: Vec3 = [0, 0, 0];
  private movedAt = 0;
  private sentAt = 0;

  constructor(private readonly send: (command: Command) => void) {}

  begin(now: number, ray: Ray): void {
    this.active = true;
    this.sent = false;
    this.ray = ray;
    this.moved = [0, 0, 0];
    this.movedAt = now;
    this.sentAt = now;
  }

  // `step` is the cursor's movement since the last call, in metres on the plane that the camera turns about.
  drag(now: number, ray: Ray, step: Vec3): void {
    if (!this.active) return;
    this.ray = ray;
    this.moved = add(this.moved, step);
    this.movedAt = now;
  }

  // Call once per animation frame.
  update(now: number): void {
    if (!this.active || !this.ray || now - this.sentAt < INTERVAL_MS) return;
    const speed = length(this.moved) / ((now - this.sentAt) / 1000);
    if (speed > 0) {
      const push = scale(this.moved, Math.min(speed, MAX_SPEED) / length(this.moved));
      this.impulse(now, push, DRAG_STRENGTH);
    } else if (now - this.movedAt >= REST_MS) {
      this.impulse(now, undefined, REST_STRENGTH);
    }
  }

  // A click without a drag is one push away from the ray.
  end(now: number): void {
    if (this.active && !this.sent) this.impulse(now, undefined, 1);
    this.active = false;
  }

  cancel(): void {
    this.active = false;
  }

  private impulse(now: number, push: Vec3 | undefined, strength: number): void {
    if (!this.ray) return;
    this.send({
      kind: 'impulse',
      origin: this.ray.origin,
      direction: this.ray.direction,
      ...(push && { push }),
      strength,
    });
    this.sent = true;
    this.sentAt = now;
    this.moved = [0, 0, 0];
  }
}
