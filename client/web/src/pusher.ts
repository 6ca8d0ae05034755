// Pushing the cloud: turns a drag of the cursor into impulses along its ray, at a bounded rate. No page.
import { add, length, scale } from './camera';
import type { Ray } from './camera';
import type { Command, Vec3 } from './protocol';

const INTERVAL_MS = 1000 / 30;
// A cursor that rests this long blows particles away from its ray.
const REST_MS = 250;
const REST_STRENGTH = 0.3;
// Cursor speed, in half pictures a second, at which a push reaches its full strength.
const FULL_SPEED = 2;

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

  // `step` is the cursor's movement since the last call, in the world, 1 for half the picture's height.
  drag(now: number, ray: Ray, step: Vec3): void {
    if (!this.active) return;
    this.ray = ray;
    this.moved = add(this.moved, step);
    this.movedAt = now;
  }

  // Call once per animation frame.
  update(now: number): void {
    if (!this.active || !this.ray || now - this.sentAt < INTERVAL_MS) return;
    const distance = length(this.moved);
    if (distance > 0) {
      const speed = distance / ((now - this.sentAt) / 1000);
      const strength = Math.min(1, speed / FULL_SPEED);
      this.impulse(now, scale(this.moved, 1 / distance), strength);
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
