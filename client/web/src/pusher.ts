// Turns a drag of the cursor into impulses on the cloud along the cursor's ray, at a bounded rate. Uses nothing of
// the page.
import { add, length, scale } from './camera';
import type { Ray } from './camera';
import type { Command, Vec3 } from './protocol';

const INTERVAL_MS = 1000 / 30;
// A cursor that has not moved for so long pushes particles away from its ray.
const REST_MS = 250;
const REST_STRENGTH = 0.3;
const CLICK_STRENGTH = 2.5;
// Part of the cursor's speed that a particle gains per second under the ray. Particles that a ray passes over then
// move two or three times the ray's width before the springs pull them back, whatever the scene's size.
const DRAG_PER_SECOND = 15;
const LONGEST_S = 0.2; // longest time that one impulse stands for, so that a page after a pause does not push harder
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

  // To be called once per animation frame.
  update(now: number): void {
    if (!this.active || !this.ray || now - this.sentAt < INTERVAL_MS) return;
    const seconds = (now - this.sentAt) / 1000;
    const distance = length(this.moved);
    if (distance > 0) {
      const velocity = scale(this.moved, Math.min(distance / seconds, MAX_SPEED) / distance);
      this.impulse(now, velocity, DRAG_PER_SECOND * Math.min(seconds, LONGEST_S));
    } else if (now - this.movedAt >= REST_MS) {
      this.impulse(now, undefined, REST_STRENGTH);
    }
  }

  // A click without a drag is one push away from the ray.
  end(now: number): void {
    if (this.active && !this.sent) this.impulse(now, undefined, CLICK_STRENGTH);
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
