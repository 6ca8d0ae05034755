// Poses: where a viewer's pictures are asked for, and what was asked for last.
import { same } from './camera';
import type { Camera } from './camera';
import type { Connection } from './connection';
import { Predictor, cameraGoesOn } from './predict';
import type { Size } from './size';
import type { Statistics } from './statistics';
import type { Wishes } from './viewer-host';
import type { PoseWish, Viewing } from './viewing';
import type { View } from './views';

// A still camera sends its pose again this often: the latency shown is then never older.
const REFRESH_MS = 500;
// A page that draws by itself tells where it looks this seldom: the server measures errors there.
const DRAWING_MS = 200;

export interface PosesHost {
  readonly camera: Camera;
  readonly fovY: number;
  readonly size: Size;
  readonly link: Connection;
  readonly statistics: Statistics;
  readonly viewing: Viewing;
  readonly wishes: Wishes;
  readonly headset: { readonly asked: PoseWish | undefined } | undefined;
  readonly latencyMs: number; // from a pose to its picture; 0: not known
  readonly hidden: boolean; // true: nobody sees the pictures
  readonly drawing: { readonly shown: boolean };
  readonly people: { readonly leader: unknown }; // undefined: the camera is this viewer's own
}

export class Poses {
  private movedAt: number | undefined; // ms, of the first input since the last pose that was sent
  // The last pose that was sent. `said`: its numbers as the server reads them, in float32. `pose`: number of the first
  // pose with the same numbers, since the server draws a still picture only once.
  private sent:
    | { camera: Camera; fovY: number; size: Size; view: View; at: number; pose: number; said: string }
    | undefined;
  private headAt = -Infinity; // ms, when the last pose of a headset was sent
  private readonly predictor = new Predictor(cameraGoesOn);

  constructor(private readonly host: PosesHost) {}

  // To be called for a new connection.
  reset(): void {
    this.sent = this.movedAt = undefined;
    this.predictor.reset();
  }

  // The camera was moved by hand.
  moved(): void {
    this.movedAt ??= performance.now();
  }

  // Number of the pose that was sent for the camera as it is; undefined while a newer one is due.
  get current(): number | undefined {
    const { sent, host } = this;
    return sent && sent.fovY === host.fovY && same(sent.camera, host.camera) ? sent.pose : undefined;
  }

  // To be called once per animation frame.
  follow(now: number): void {
    const { camera, fovY, size, wishes, link, drawing, people } = this.host;
    this.predictor.add(now, camera);
    const { sent } = this;
    const moved = !people.leader && (sent?.fovY !== fovY || !same(sent.camera, camera));
    const changed = sent?.size !== size || sent.view !== wishes.view || moved;
    const apart = !changed ? REFRESH_MS : drawing.shown ? DRAWING_MS : 0;
    const due = sent === undefined || now - sent.at >= apart;
    if (due && link.connected) this.ask(now);
  }

  ask(now: number): void {
    const { camera, fovY, size, link, wishes, viewing, headset, latencyMs } = this.host;
    const lead = wishes.predict ? latencyMs : 0;
    const foreseen = (lead > 0 && this.predictor.predict(lead)) || camera;
    const wish = headset?.asked ?? viewing.wish(foreseen, size);
    if (!this.send(wish, this.movedAt === undefined ? 0 : performance.now() - this.movedAt)) return;
    this.movedAt = undefined;
    const numbers = [...wish.position, ...wish.orientation, wish.fovY, wish.width, wish.height];
    const said = numbers.map(Math.fround).join() + wishes.view;
    const pose = this.sent?.said === said ? this.sent.pose : link.lastPose;
    this.sent = { camera, fovY, size, view: wishes.view, at: now, pose, said };
  }

  // A pose of a headset, which has one at each of its display's pictures.
  askFor(wish: PoseWish, now: number): void {
    if (this.host.drawing.shown && now - this.headAt < DRAWING_MS) return;
    this.headAt = now;
    this.send(wish);
  }

  // `waited`: ms since the input that moved the camera there. Returns false if it could not be sent.
  send(wish: PoseWish, waited = 0): boolean {
    const { link, wishes, statistics, hidden } = this.host;
    if (!link.connected || !link.sendPose({ ...wish, view: wishes.view, hidden })) return false;
    statistics.sent(link.lastPose, waited);
    return true;
  }
}
