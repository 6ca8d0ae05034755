// The messages of brume.v1 as plain objects; encode.ts and decode.ts turn them to bytes and back.
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
  hidden?: boolean; // true: the page is not seen, the server draws nothing until a pose without it
}

export type Command =
  | { kind: 'impulse'; origin: Vec3; direction: Vec3; push?: Vec3; strength: number }
  | { kind: 'move'; offset: Vec3 }
  | { kind: 'light'; toLight?: Vec3; irradiance?: Vec3; rotate?: number }
  | {
      kind: 'medium';
      extinction?: number;
      falloff?: number;
      anisotropy?: number;
      asymmetry?: number;
      albedo?: Vec3;
    }
  | { kind: 'render'; method?: string; quadrature?: string; steps?: number; exposure?: number }
  | { kind: 'simulation'; paused: boolean }
  | { kind: 'restart' };

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
  methods: string[];
  quadratures: string[];
  resume: string; // key to be the same viewer again when the connection is lost; empty from older servers
  role: Role;
}

export interface SceneState {
  kind: 'scene';
  tick: bigint;
  stateHash: bigint;
  viewers: number;
  particles: number;
  paused: boolean;
  toLight: Vec3;
  irradiance: Vec3;
  rotate: number;
  extinction: number;
  falloff: number;
  anisotropy: number;
  asymmetry: number;
  albedo: Vec3;
  method: string;
  quadrature: string;
  steps: number;
  exposure: number;
  passes: { name: string; ms: number }[];
  plan?: Plan; // method and settings in use; older servers leave it out
}

export interface Plan {
  method: string;
  quadrature: string; // empty if the method has only one
  rate: number; // slabs: pixels between rays
  slabs: number;
  error: number; // relative RMSE, predicted
  ms: number; // of a frame of all viewers, predicted
  relaxed: number; // steps of accuracy given up under overload
}

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
  jpeg: Uint8Array<ArrayBuffer>[]; // one picture per view; JPEG, or PNG for a still picture without loss
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
  | ErrorMessage
  | { kind: 'ping' | 'pong'; nonce: number; timeUs: bigint }
  | { kind: 'goodbye'; reason: string; retryAfterS: number; goTo: string };

export class ProtocolError extends Error {}
