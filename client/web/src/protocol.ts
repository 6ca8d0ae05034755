// The messages of brume.v1 as plain objects; encode.ts and decode.ts turn them to bytes and back.
import type { CameraKey } from './camera-keys';
import type { Role } from './role';

export const SUBPROTOCOL = 'brume.v1';

export type Vec3 = readonly [x: number, y: number, z: number];
export type Quat = readonly [x: number, y: number, z: number, w: number];

export interface HelloMessage {
  client: string;
  width: number;
  height: number;
  views?: 1 | 2; // 2 for left and right eye
  quality: number; // JPEG, 0 = the server's own
  resume?: string; // Welcome.resume of a connection that was lost
  drawHz?: number; // 1 ... 60: the page draws by itself, from so many messages a second; left out or 0: it does not
}

// Tangents of the angles from the view axis to a picture's sides, positive toward the side that is named.
export interface Frustum {
  left: number;
  right: number;
  up: number;
  down: number;
}

export interface PoseMessage {
  seq: number;
  clientTimeUs: bigint;
  position: Vec3;
  orientation: Quat;
  fovY: number;
  eyeSeparation?: number; // m
  frusta?: readonly Frustum[]; // one for each eye, in place of fovY
  width: number;
  height: number;
  view?: string; // of how the picture is made, in its place; left out: the picture
  hidden?: boolean; // true: the page is not seen, the server draws nothing until a pose without it
  layers?: number; // with depth, 1 ... 8; left out: none
}

export type Command =
  | { kind: 'impulse'; origin: Vec3; direction: Vec3; push?: Vec3; strength: number }
  | { kind: 'move'; offset: Vec3 }
  | { kind: 'set'; changes: Change[] }
  | { kind: 'add'; list: string; changes: Change[] } // paths without an index
  | { kind: 'remove'; path: string } // an element of a list: fog[1]
  | { kind: 'restart' }
  | { kind: 'undo' };

export interface Change {
  path: string;
  value: SettingValue;
}

export type SettingKind = 'boolean' | 'whole' | 'number' | 'vector' | 'colour' | 'direction' | 'text';
export type SettingValue = number | Vec3 | string; // of a boolean 0 or 1

// A setting of the scene that may be changed while the server runs.
export interface Setting {
  path: string; // as in a scene file: medium.extinction
  kind: SettingKind | undefined; // undefined: one that this page does not know
  unit: string; // empty: none
  help: string;
  leastRole: Role; // that may change it
  lowest: number; // of each of its numbers
  highest: number;
  usualLowest: number; // the part of that range that a slider offers
  usualHighest: number;
  choices: string[]; // of a text
  onlyType: string; // of an element of a list: only those of this `type` have it; empty: all have it
}

// A list of the scene, whose elements may be changed, added and removed while the server runs.
export interface List {
  name: string; // as in a scene file
  most: number; // elements
  settings: Setting[]; // of an element; paths have no index
}

export interface Welcome {
  kind: 'welcome';
  viewer: number;
  server: string;
  scene: string;
  device: string;
  width: number;
  height: number;
  tickHz: number;
  maxInFlight: number;
  camera: { position: Vec3; target: Vec3; fovY: number };
  settings: Setting[];
  resume: string; // key to be the same viewer again when the connection is lost; empty from older servers
  role: Role;
  starts: SettingValue[]; // the scene began with, in the order of settings; empty from older servers
  scenes: string[]; // names of the scenes that an operator can switch to
  lists: List[]; // empty from older servers
  medium: string; // the scene's medium.model; empty from older servers
  people: boolean; // true: the server takes Presence and Lead
  path: CameraKey[]; // the scene's key views; empty where it has none, and from older servers
}

// Corners of a box along the axes, m.
export interface Box {
  lo: Vec3;
  hi: Vec3;
}

export interface SceneState {
  kind: 'scene';
  tick: bigint;
  stateHash: bigint;
  viewers: number;
  particles: number;
  settings: SettingValue[]; // in the order of Welcome.settings
  passes: { name: string; ms: number }[];
  box?: Box; // holds the medium; older servers leave it out
  plan?: Plan; // method and settings in use; older servers leave it out
  lists?: number[][]; // of the elements of each of Welcome.lists; absent: as before
  preparing?: string; // name of another scene that is being made ready to be shown; absent: none is
  standstill?: string; // why no tick comes at present, one line; absent: ticks come
  notDrawable?: string; // why viewers cannot draw this scene by themselves, one line; absent: they can
  undo?: string; // what an undo would do now, in a few words; absent: nothing, or an older server
}

export interface Plan {
  method: string;
  text: string; // method and settings in a few words
  error: number; // relative RMSE, predicted
  promised?: number; // relative RMSE that pictures may have; absent: nothing is promised
  ms: number; // of a frame of all viewers, predicted
  relaxed: number; // steps of accuracy given up under overload
}

// Relative RMSE of this viewer's pictures of the last half minute, with its bounds of 95 %.
export interface Measured {
  error: number;
  low: number;
  high: number;
}

// Of a view's picture, to redraw it as seen from elsewhere (brume.fbs).
export interface DepthLayers {
  count: number; // near to far; 0: there are none
  columns: number; // nodes of a layer
  rows: number;
  blockRows: number; // of a layer in its pictures
  spacing: number; // pixels between nodes
  first: number; // pixels to the first node, each way
  near: number; // m, depth of byte 0
  far: number; // m, depth of byte 255
  filmic: boolean; // true: colours are tone mapped by Narkowicz's curve
  nearSurface: number; // m, depth of byte 1 of surfaces
  farSurface: number; // m, depth of byte 254
  nearest: number; // m, of surfaces; 0: there is nothing but sky
  colours: Uint8Array<ArrayBuffer>; // JPEG; empty without layers
  data: Uint8Array<ArrayBuffer>; // grey JPEG; empty without layers
  surface: Uint8Array<ArrayBuffer>; // grey PNG; empty where there is nothing but sky
}

// True: there is something to redraw a picture from. False: the way of rendering or the medium has no layers.
export const hasParts = ({ count, surface }: DepthLayers): boolean => count > 0 || surface.length > 0;

export interface Frame {
  kind: 'frame';
  id: number;
  tick: bigint;
  stateHash: bigint;
  poseSeq: number;
  clientTimeUs: bigint;
  position: Vec3; // with orientation and fovY: the pose that the frame shows
  orientation: Quat;
  fovY: number;
  frusta: Frustum[]; // one for each view; empty: symmetric ones of fovY
  width: number;
  height: number;
  quality: number;
  stages: { wait: number; render: number; encode: number; queue: number; gpu: number }; // ms
  measured?: Measured; // absent: not known
  reduced?: 'link' | 'device'; // why it is less than what was asked for; absent: it is not, or an older server
  follows: number; // the person whose camera this is; 0: the pose's
  jpeg: Uint8Array<ArrayBuffer>[]; // one picture per view; JPEG, or PNG for a still picture without loss
  layers?: DepthLayers[]; // of each view, where the pose asked for them
}

// Channels in which the medium's extinction is the same.
export interface Hue {
  channels: number; // bits of red (1), green (2) and blue (4)
  extinction: number; // factor on the particles' extinction
}

export interface LitObject {
  kind: number; // 0: plane, 1: box, 2: sphere
  centre: Vec3;
  halfSize: Vec3; // as in brume.fbs
  yaw: number;
  albedo: Vec3;
}

// The medium as it is lit, to be drawn here (brume.fbs has what each number is).
export interface LitParticles {
  kind: 'lit';
  id: number;
  tick: bigint;
  stateHash: bigint;
  number: number;
  reference: number; // 0: there is none
  first: bigint; // id of the first particle
  count: number;
  present: number; // below 2 ^ 50
  origin: Vec3;
  step: number;
  falloff: number;
  toLight: Vec3;
  irradiance: Vec3;
  phase: readonly number[]; // 4
  ambient: Vec3;
  emission: Vec3; // a particle emits max(1 - albedo / coldAlbedo, 0) of this radiance per optical depth
  coldAlbedo: Vec3;
  hues: Hue[]; // each channel is in one of them
  straight: Vec3;
  meanCosine: number;
  zenith: Vec3;
  horizon: Vec3;
  haze: number;
  exposure: number;
  filmic: boolean;
  objects: LitObject[];
  predicted?: number; // relative RMSE; absent: not known
  measured?: Measured; // absent: not known
  ageMs: number; // since the server took the tick
  bytes: Uint8Array<ArrayBuffer>; // of columns, packed
}

// What a viewer says of itself.
export interface Presence {
  name: string; // empty: it has chosen none
  pointer?: { origin: Vec3; direction: Vec3 }; // a dot is shown where this ray meets something; left out: none
  follow: number; // id of the person whose camera it wants; 0: its own
  cameras: boolean; // true: it wants to know where others look from
}

export interface Person {
  id: number;
  name: string;
  known: boolean; // true: its token says the name
  colour: string; // #rrggbb
  role: Role;
  follows: number; // whose camera it has; 0: its own
  look?: { position: Vec3; orientation: Quat; right: number; up: number }; // absent: not known
  pointer?: Vec3; // absent: it points at nothing
}

export interface PeopleMessage {
  kind: 'people';
  people: Person[]; // in the order in which they came
  count: number; // of all, also those who are not told of
  presenter: number; // 0: nobody presents
}

export interface ErrorMessage {
  kind: 'error';
  code: number;
  text: string;
  inputSeq: number;
}

export type ServerMessage =
  | Welcome
  | SceneState
  | Frame
  | LitParticles
  | ErrorMessage
  | PeopleMessage
  | { kind: 'ping' | 'pong'; nonce: number; timeUs: bigint }
  | { kind: 'goodbye'; reason: string; retryAfterS: number; goTo: string };

export class ProtocolError extends Error {}
