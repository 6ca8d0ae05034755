// The messages of brume.v1 as plain objects. One WebSocket message is one size-prefixed FlatBuffer; the JPEG bytes
// of a frame's views follow it.
import { Builder, ByteBuffer } from 'flatbuffers';
import { Ack } from './wire/brume/wire/ack';
import { Body } from './wire/brume/wire/body';
import { Command as CommandType } from './wire/brume/wire/command';
import { Error as WireError } from './wire/brume/wire/error';
import { Frame as WireFrame } from './wire/brume/wire/frame';
import { Goodbye as WireGoodbye } from './wire/brume/wire/goodbye';
import { Hello } from './wire/brume/wire/hello';
import { Impulse } from './wire/brume/wire/impulse';
import { Input } from './wire/brume/wire/input';
import { Message } from './wire/brume/wire/message';
import { MoveVolume } from './wire/brume/wire/move-volume';
import { Ping as WirePing } from './wire/brume/wire/ping';
import { Pong as WirePong } from './wire/brume/wire/pong';
import { Pose as WirePose } from './wire/brume/wire/pose';
import { Quat as WireQuat } from './wire/brume/wire/quat';
import { Restart } from './wire/brume/wire/restart';
import type { Plan as WirePlan } from './wire/brume/wire/plan';
import { SceneState as WireSceneState } from './wire/brume/wire/scene-state';
import { SetLight } from './wire/brume/wire/set-light';
import { SetMedium } from './wire/brume/wire/set-medium';
import { SetRender } from './wire/brume/wire/set-render';
import { SetSimulation } from './wire/brume/wire/set-simulation';
import { Vec3 as WireVec3 } from './wire/brume/wire/vec3';
import { Welcome as WireWelcome } from './wire/brume/wire/welcome';

export const SUBPROTOCOL = 'brume.v1';

// Bounds on what a server may send in lists; anything longer is not one of ours.
const MAX_VIEWS = 2;
const MAX_NAMES = 64;

export type Vec3 = readonly [x: number, y: number, z: number];
export type Quat = readonly [x: number, y: number, z: number, w: number];

export interface HelloMessage {
  client: string;
  width: number;
  height: number;
  quality: number; // JPEG, 0 = the server's own
}

export interface PoseMessage {
  seq: number;
  clientTimeUs: bigint;
  position: Vec3;
  orientation: Quat;
  fovY: number;
  width: number;
  height: number;
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
  plan?: Plan; // what is rendered with now; servers before it had none do not say
}

export interface Plan {
  method: string;
  quadrature: string; // '' where the method has but one
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
  width: number;
  height: number;
  quality: number;
  stages: { wait: number; render: number; encode: number; queue: number; gpu: number }; // ms
  jpeg: Uint8Array<ArrayBuffer>[]; // one per view
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
  | { kind: 'goodbye'; reason: string; retryAfterS: number };

export class ProtocolError extends Error {}

// ---- to the server ----

function finish(builder: Builder, type: Body, body: number): Uint8Array<ArrayBuffer> {
  Message.finishSizePrefixedMessageBuffer(builder, Message.createMessage(builder, type, body));
  return builder.asUint8Array() as Uint8Array<ArrayBuffer>;
}

const vec3 = (builder: Builder, v: Vec3): number => WireVec3.createVec3(builder, v[0], v[1], v[2]);

export function encodeHello(hello: HelloMessage): Uint8Array<ArrayBuffer> {
  const builder = new Builder(128);
  const client = builder.createString(hello.client);
  return finish(builder, Body.Hello, Hello.createHello(builder, client, hello.width, hello.height, 1, hello.quality));
}

export function encodePose(pose: PoseMessage): Uint8Array<ArrayBuffer> {
  const builder = new Builder(128);
  WirePose.startPose(builder);
  WirePose.addSeq(builder, pose.seq);
  WirePose.addClientTimeUs(builder, pose.clientTimeUs);
  WirePose.addPosition(builder, vec3(builder, pose.position));
  WirePose.addOrientation(builder, WireQuat.createQuat(builder, ...pose.orientation));
  WirePose.addFovY(builder, pose.fovY);
  WirePose.addWidth(builder, pose.width);
  WirePose.addHeight(builder, pose.height);
  return finish(builder, Body.Pose, WirePose.endPose(builder));
}

export function encodeInput(seq: number, clientTimeUs: bigint, command: Command): Uint8Array<ArrayBuffer> {
  const builder = new Builder(128);
  // The generated writers leave out an optional number that is 0 (they take 0 for its default, which is null).
  builder.forceDefaults(true);
  const [type, body] = buildCommand(builder, command);
  builder.forceDefaults(false);
  return finish(builder, Body.Input, Input.createInput(builder, seq, clientTimeUs, type, body));
}

function buildCommand(builder: Builder, command: Command): [CommandType, number] {
  switch (command.kind) {
    case 'impulse':
      Impulse.startImpulse(builder);
      Impulse.addOrigin(builder, vec3(builder, command.origin));
      Impulse.addDirection(builder, vec3(builder, command.direction));
      if (command.push) Impulse.addPush(builder, vec3(builder, command.push));
      Impulse.addStrength(builder, command.strength);
      return [CommandType.Impulse, Impulse.endImpulse(builder)];
    case 'move':
      MoveVolume.startMoveVolume(builder);
      MoveVolume.addOffset(builder, vec3(builder, command.offset));
      return [CommandType.MoveVolume, MoveVolume.endMoveVolume(builder)];
    case 'light':
      SetLight.startSetLight(builder);
      if (command.toLight) SetLight.addToLight(builder, vec3(builder, command.toLight));
      if (command.irradiance) SetLight.addIrradiance(builder, vec3(builder, command.irradiance));
      if (command.rotate !== undefined) SetLight.addRotate(builder, command.rotate);
      return [CommandType.SetLight, SetLight.endSetLight(builder)];
    case 'medium':
      SetMedium.startSetMedium(builder);
      if (command.extinction !== undefined) SetMedium.addExtinction(builder, command.extinction);
      if (command.falloff !== undefined) SetMedium.addFalloff(builder, command.falloff);
      if (command.anisotropy !== undefined) SetMedium.addAnisotropy(builder, command.anisotropy);
      if (command.asymmetry !== undefined) SetMedium.addAsymmetry(builder, command.asymmetry);
      if (command.albedo) SetMedium.addAlbedo(builder, vec3(builder, command.albedo));
      return [CommandType.SetMedium, SetMedium.endSetMedium(builder)];
    case 'render': {
      const method = command.method === undefined ? 0 : builder.createString(command.method);
      const quadrature = command.quadrature === undefined ? 0 : builder.createString(command.quadrature);
      SetRender.startSetRender(builder);
      if (method) SetRender.addMethod(builder, method);
      if (quadrature) SetRender.addQuadrature(builder, quadrature);
      if (command.steps !== undefined) SetRender.addSteps(builder, command.steps);
      if (command.exposure !== undefined) SetRender.addExposure(builder, command.exposure);
      return [CommandType.SetRender, SetRender.endSetRender(builder)];
    }
    case 'simulation':
      SetSimulation.startSetSimulation(builder);
      SetSimulation.addPaused(builder, command.paused);
      return [CommandType.SetSimulation, SetSimulation.endSetSimulation(builder)];
    case 'restart':
      Restart.startRestart(builder);
      return [CommandType.Restart, Restart.endRestart(builder)];
  }
}

export function encodeAck(frame: number): Uint8Array<ArrayBuffer> {
  const builder = new Builder(64);
  return finish(builder, Body.Ack, Ack.createAck(builder, frame));
}

export function encodePing(nonce: number, timeUs: bigint): Uint8Array<ArrayBuffer> {
  const builder = new Builder(64);
  return finish(builder, Body.Ping, WirePing.createPing(builder, nonce, timeUs));
}

export function encodePong(nonce: number, timeUs: bigint): Uint8Array<ArrayBuffer> {
  const builder = new Builder(64);
  return finish(builder, Body.Pong, WirePong.createPong(builder, nonce, timeUs));
}

export function encodeGoodbye(reason: string): Uint8Array<ArrayBuffer> {
  const builder = new Builder(64);
  return finish(builder, Body.Goodbye, WireGoodbye.createGoodbye(builder, builder.createString(reason), 0));
}

// ---- from the server ----

// Throws ProtocolError for anything that is not a message of a brume.v1 server.
export function decode(data: ArrayBuffer): ServerMessage {
  const bytes = new Uint8Array(data);
  if (bytes.length < 12) throw new ProtocolError('message too short');
  const length = new DataView(data).getUint32(0, true);
  if (length < 8 || length > bytes.length - 4) throw new ProtocolError('length prefix beyond the message');
  const tail = bytes.subarray(4 + length);
  const buffer = new ByteBuffer(bytes.subarray(0, 4 + length));
  // The identifier of a size-prefixed buffer stands four bytes later than where __has_identifier looks.
  buffer.setPosition(4);
  if (!Message.bufferHasIdentifier(buffer)) throw new ProtocolError('not a BRM1 message');
  buffer.setPosition(0);
  const message = Message.getSizePrefixedRootAsMessage(buffer);
  const type = message.bodyType();
  if (type !== Body.Frame && tail.length > 0) throw new ProtocolError('bytes after the message');
  switch (type) {
    case Body.Welcome:
      return decodeWelcome(message.body(new WireWelcome()) as WireWelcome);
    case Body.SceneState:
      return decodeScene(message.body(new WireSceneState()) as WireSceneState);
    case Body.Frame:
      return decodeFrame(message.body(new WireFrame()) as WireFrame, tail);
    case Body.Error: {
      const error = message.body(new WireError()) as WireError;
      return { kind: 'error', code: error.code(), text: error.text() ?? '', inputSeq: error.inputSeq() };
    }
    case Body.Ping:
    case Body.Pong: {
      const ping = message.body(new WirePing()) as WirePing; // the same fields as Pong
      return { kind: type === Body.Ping ? 'ping' : 'pong', nonce: ping.nonce(), timeUs: ping.timeUs() };
    }
    case Body.Goodbye: {
      const goodbye = message.body(new WireGoodbye()) as WireGoodbye;
      return { kind: 'goodbye', reason: goodbye.reason() ?? '', retryAfterS: goodbye.retryAfterS() };
    }
    default:
      throw new ProtocolError(`unexpected message type ${type}`);
  }
}

function toVec3(v: WireVec3 | null, fallback?: Vec3): Vec3 {
  if (v) return [v.x(), v.y(), v.z()];
  if (fallback) return fallback;
  throw new ProtocolError('a required vector is missing');
}

function toList<T>(count: number, limit: number, item: (index: number) => T): T[] {
  if (count > limit) throw new ProtocolError('a list is too long');
  return Array.from({ length: count }, (_, index) => item(index));
}

function decodeWelcome(w: WireWelcome): Welcome {
  const camera = w.camera();
  if (!camera) throw new ProtocolError('welcome without a camera');
  return {
    kind: 'welcome',
    viewer: w.viewer(),
    server: w.server() ?? '',
    scene: w.scene() ?? '',
    device: w.device() ?? '',
    width: w.width(),
    height: w.height(),
    tickHz: w.tickHz(),
    maxInFlight: w.maxInFlight(),
    camera: { position: toVec3(camera.position()), target: toVec3(camera.target()), fovY: camera.fovY() },
    methods: toList(w.methodsLength(), MAX_NAMES, (i) => w.methods(i)),
    quadratures: toList(w.quadraturesLength(), MAX_NAMES, (i) => w.quadratures(i)),
  };
}

function decodePlan(p: WirePlan): Plan {
  return {
    method: p.method() ?? '',
    quadrature: p.quadrature() ?? '',
    rate: p.rate(),
    slabs: p.slabs(),
    error: p.error(),
    ms: p.ms(),
    relaxed: p.relaxed(),
  };
}

function decodeScene(s: WireSceneState): SceneState {
  const plan = s.plan();
  return {
    kind: 'scene',
    tick: s.tick(),
    stateHash: s.stateHash(),
    viewers: s.viewers(),
    particles: s.particles(),
    paused: s.paused(),
    toLight: toVec3(s.toLight(), [0, 1, 0]),
    irradiance: toVec3(s.irradiance(), [0, 0, 0]),
    rotate: s.rotate(),
    extinction: s.extinction(),
    falloff: s.falloff(),
    anisotropy: s.anisotropy(),
    asymmetry: s.asymmetry(),
    albedo: toVec3(s.albedo(), [0, 0, 0]),
    method: s.method() ?? '',
    quadrature: s.quadrature() ?? '',
    steps: s.steps(),
    exposure: s.exposure(),
    passes: toList(s.passesLength(), MAX_NAMES, (i) => {
      const pass = s.passes(i);
      return { name: pass?.name() ?? '', ms: pass?.ms() ?? 0 };
    }),
    ...(plan ? { plan: decodePlan(plan) } : {}),
  };
}

function decodeFrame(f: WireFrame, tail: Uint8Array<ArrayBuffer>): Frame {
  const stages = f.stages();
  if (!stages) throw new ProtocolError('frame without stages');
  let begin = 0;
  const jpeg = toList(f.jpegBytesLength(), MAX_VIEWS, (i) => {
    const end = begin + (f.jpegBytes(i) ?? 0);
    const view = tail.subarray(begin, end);
    begin = end;
    return view;
  });
  if (jpeg.length === 0 || begin !== tail.length) throw new ProtocolError('picture bytes do not match their lengths');
  return {
    kind: 'frame',
    id: f.id(),
    tick: f.tick(),
    stateHash: f.stateHash(),
    poseSeq: f.poseSeq(),
    clientTimeUs: f.clientTimeUs(),
    width: f.width(),
    height: f.height(),
    quality: f.quality(),
    stages: {
      wait: stages.wait(),
      render: stages.render(),
      encode: stages.encode(),
      queue: stages.queue(),
      gpu: stages.gpu(),
    },
    jpeg,
  };
}
