// People: who else is here, what this viewer says of itself, and whose camera it has.
import { clamp, MAX_PITCH } from './camera';
import type { Camera, Ray } from './camera';
import { encodeLead, encodePresence } from './people-wire';
import { throttled } from './fields';
import { rotate } from './projection';
import type { PeopleMessage, Person, Presence, Quat, Vec3, Welcome } from './protocol';
import { atLeast } from './role';

// A camera that has this place and view; how it rolls is left out.
export function cameraAt(position: Vec3, orientation: Quat, distance: number): Camera {
  const ahead = rotate(orientation, [0, 0, -1]);
  const up = rotate(orientation, [0, 1, 0]);
  // Straight up or down the yaw is that of what the picture's upper side looks at.
  const level = Math.abs(ahead[1]) < 0.9999 ? ahead : up.map((x) => -x * Math.sign(ahead[1]));
  return {
    position,
    yaw: Math.atan2(-(level[0] ?? 0), -(level[2] ?? 0)),
    pitch: clamp(Math.asin(clamp(ahead[1], -1, 1)), -MAX_PITCH, MAX_PITCH),
    distance,
  };
}

export interface PeopleHost {
  camera: Camera;
  readonly welcome: Welcome | undefined;
  readonly drawsHere: boolean; // true: it has no pictures, whose camera it could take
  send(message: Uint8Array<ArrayBuffer>): void;
  told(): void; // something is new
}

export class People {
  now: PeopleMessage = { kind: 'people', people: [], count: 0, presenter: 0 };
  showsCameras = false; // true: small cones show where others look from
  private said: Presence = { name: '', follow: 0, cameras: false };
  private leads = false; // true: it has asked to present, and presents again after a connection that was lost
  private readonly sendSoon = throttled<undefined>(() => this.say());

  constructor(private readonly host: PeopleHost) {}

  get there(): boolean {
    return this.host.welcome?.people ?? false;
  }

  get me(): Person | undefined {
    return this.byId(this.host.welcome?.viewer ?? 0);
  }

  get presenter(): Person | undefined {
    return this.now.presenter === 0 ? undefined : this.byId(this.now.presenter);
  }

  // Whose camera it has; undefined: its own. What was asked for counts before the server has said so.
  get leader(): Person | undefined {
    const me = this.host.welcome?.viewer;
    if (this.now.presenter !== 0) return this.now.presenter === me ? undefined : this.presenter;
    return this.said.follow === 0 ? undefined : this.byId(this.me?.follows || this.said.follow);
  }

  // True: the presenter has the camera, and this viewer cannot move it.
  get held(): boolean {
    return this.now.presenter !== 0 && this.leader !== undefined;
  }

  get mayLead(): boolean {
    return this.there && atLeast(this.host.welcome?.role ?? 'viewer', 'presenter');
  }

  get following(): number {
    return this.said.follow;
  }

  byId(id: number): Person | undefined {
    return this.now.people.find((person) => person.id === id);
  }

  // To be called for each welcome: the server knows nothing of a new connection's person.
  begin(): void {
    this.said = { ...this.said, follow: 0 };
    this.now = { kind: 'people', people: [], count: 0, presenter: 0 };
    if (!this.there) return;
    this.say();
    if (this.leads) this.host.send(encodeLead(this.host.welcome?.viewer ?? 0));
  }

  receive(message: PeopleMessage): void {
    const before = this.now.presenter;
    this.now = message;
    const me = this.host.welcome?.viewer;
    if (before === me && message.presenter !== me) this.leads = false; // somebody else has released it
    if (this.said.follow !== 0 && !this.byId(this.said.follow)) this.said = { ...this.said, follow: 0 };
    const { leader } = this;
    if (this.host.drawsHere && leader?.look)
      this.host.camera = cameraAt(leader.look.position, leader.look.orientation, this.host.camera.distance);
    this.ask();
    this.host.told();
  }

  rename(name: string): void {
    this.said = { ...this.said, name };
    this.sendSoon(undefined);
  }

  // 0: nobody.
  follow(id: number): void {
    this.said = { ...this.said, follow: id };
    this.ask();
    this.say();
    this.host.told();
  }

  // All take this viewer's camera, or nobody's.
  lead(on: boolean): void {
    if (!this.mayLead) return;
    this.leads = on;
    this.host.send(encodeLead(on ? (this.host.welcome?.viewer ?? 0) : 0));
  }

  // Points along a ray, for all to see; undefined: at nothing.
  point(ray: Ray | undefined): void {
    const { pointer: before, ...rest } = this.said;
    if (!ray && !before) return;
    this.said = ray ? { ...rest, pointer: ray } : rest;
    this.sendSoon(undefined);
  }

  showCameras(on: boolean): void {
    this.showsCameras = on;
    this.ask();
    this.sendSoon(undefined);
  }

  // To be called before the camera is moved by hand. False: it may not be moved.
  takesBack(): boolean {
    if (this.held) return false;
    if (this.said.follow !== 0) this.follow(0);
    return true;
  }

  // The camera of a picture that shows what another sees.
  takeCamera(position: Vec3, orientation: Quat): void {
    if (this.leader) this.host.camera = cameraAt(position, orientation, this.host.camera.distance);
  }

  private ask(): void {
    const cameras = this.showsCameras || (this.host.drawsHere && this.leader !== undefined);
    if (cameras === this.said.cameras) return;
    this.said = { ...this.said, cameras };
    this.sendSoon(undefined);
  }

  private say(): void {
    if (this.there) this.host.send(encodePresence(this.said));
  }
}

// The corners of a small cone before a person's eye: the eye, and the picture's corners `reach` m ahead.
export function coneOf(look: NonNullable<Person['look']>, reach: number): readonly [Vec3, Vec3, Vec3, Vec3, Vec3] {
  const corner = (x: number, y: number): Vec3 => {
    const [a, b, c] = rotate(look.orientation, [x * look.right * reach, y * look.up * reach, -reach]);
    return [look.position[0] + a, look.position[1] + b, look.position[2] + c];
  };
  return [look.position, corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)];
}
