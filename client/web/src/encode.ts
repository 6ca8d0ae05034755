// Encodes messages to the server. One WebSocket message is one size-prefixed FlatBuffer.
import { Builder } from 'flatbuffers';
import { Ack } from './wire/brume/wire/ack';
import { Body } from './wire/brume/wire/body';
import { Command as CommandType } from './wire/brume/wire/command';
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
import { SetLight } from './wire/brume/wire/set-light';
import { SetMedium } from './wire/brume/wire/set-medium';
import { SetRender } from './wire/brume/wire/set-render';
import { SetSimulation } from './wire/brume/wire/set-simulation';
import { Vec3 as WireVec3 } from './wire/brume/wire/vec3';
import { Frustum as WireFrustum } from './wire/brume/wire/frustum';
import type { Command, Frustum, HelloMessage, PoseMessage, Vec3 } from './protocol';

function finish(builder: Builder, type: Body, body: number): Uint8Array<ArrayBuffer> {
  Message.finishSizePrefixedMessageBuffer(builder, Message.createMessage(builder, type, body));
  return builder.asUint8Array() as Uint8Array<ArrayBuffer>;
}

const vec3 = (builder: Builder, v: Vec3): number => WireVec3.createVec3(builder, v[0], v[1], v[2]);

const createFrustum = (builder: Builder, f: Frustum): number =>
  WireFrustum.createFrustum(builder, f.left, f.right, f.up, f.down);

export function encodeHello(hello: HelloMessage): Uint8Array<ArrayBuffer> {
  const builder = new Builder(128);
  const client = builder.createString(hello.client);
  const resume = hello.resume ? builder.createString(hello.resume) : 0;
  return finish(
    builder,
    Body.Hello,
    Hello.createHello(builder, client, hello.width, hello.height, hello.views ?? 1, hello.quality, resume, true),
  );
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
  WirePose.addEyeSeparation(builder, pose.eyeSeparation ?? 0);
  const [frustum, right] = pose.frusta ?? [];
  if (frustum) WirePose.addFrustum(builder, createFrustum(builder, frustum));
  if (right) WirePose.addRightFrustum(builder, createFrustum(builder, right));
  WirePose.addHidden(builder, pose.hidden ?? false);
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
  return finish(builder, Body.Goodbye, WireGoodbye.createGoodbye(builder, builder.createString(reason), 0, 0));
}
