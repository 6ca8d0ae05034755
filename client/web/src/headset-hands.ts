// What a headset's controllers do. The trigger pushes the medium where the controller points. The grip holds what it
// points at, and moves the whole scene with it.
import { add, length, scale, subtract } from './camera';
import type { Ray } from './camera';
import { rotate } from './projection';
import type { Command, Quat, Vec3 } from './protocol';
import { Pusher } from './pusher';

const TREMOR = 1e-3; // rad, that a hand at rest moves

export interface HandsHost {
  readonly mayPush: boolean;
  readonly distance: number; // m, of what the page's camera turns about
  send(command: Command): void;
  carry(step: Vec3): void; // m, in the world: the scene moves so far
}

interface Hand {
  readonly pusher: Pusher;
  pushes: boolean;
  carries: boolean;
  point: Vec3 | undefined; // where it pointed at, `distance` m ahead
}

export class Hands {
  private readonly hands = new Map<XRInputSource, Hand>();

  constructor(
    session: XRSession,
    private readonly host: HandsHost,
    until: AbortSignal,
  ) {
    const on = (event: 'selectstart' | 'selectend' | 'squeezestart' | 'squeezeend', act: (hand: Hand) => void): void =>
      session.addEventListener(event, ({ inputSource }) => act(this.hand(inputSource)), { signal: until });
    on('selectstart', (hand) => {
      hand.pushes = this.host.mayPush;
      hand.point = undefined;
    });
    on('selectend', (hand) => {
      if (hand.pushes) hand.pusher.end(performance.now());
      hand.pushes = false;
    });
    on('squeezestart', (hand) => {
      hand.carries = true;
      hand.point = undefined;
    });
    on('squeezeend', (hand) => (hand.carries = false));
  }

  // To be called once per frame of the display. `poseOf`: where a controller is in the world; undefined: it is not
  // tracked.
  follow(
    sources: Iterable<XRInputSource>,
    poseOf: (source: XRInputSource) => { position: Vec3; orientation: Quat } | undefined,
  ): void {
    const now = performance.now();
    for (const source of sources) {
      const hand = this.hand(source);
      const at = hand.pushes || hand.carries ? poseOf(source) : undefined;
      if (!at) continue;
      const ray: Ray = { origin: at.position, direction: rotate(at.orientation, [0, 0, -1]) };
      const point = add(ray.origin, scale(ray.direction, this.host.distance));
      if (!hand.point) {
        hand.point = point;
        if (hand.pushes) hand.pusher.begin(now, ray);
      }
      const step = subtract(point, hand.point);
      if (hand.pushes) {
        if (length(step) > TREMOR * this.host.distance) {
          hand.pusher.drag(now, ray, step);
          hand.point = point;
        }
        hand.pusher.update(now);
      } else {
        this.host.carry(step); // what it holds comes along: it points at the same place
      }
    }
    const present = new Set(sources);
    for (const source of this.hands.keys()) if (!present.has(source)) this.hands.delete(source);
  }

  private hand(source: XRInputSource): Hand {
    const known = this.hands.get(source);
    if (known) return known;
    const pusher = new Pusher((command) => this.host.send(command));
    const made = { pusher, pushes: false, carries: false, point: undefined };
    this.hands.set(source, made);
    return made;
  }
}
