// Encodes messages to the server. One WebSocket message is one size-prefixed FlatBuffer.
import { Builder } from 'flatbuffers';
import { Ack } from './wire/brume/wire/ack';
import { Add as WireAdd } from './wire/brume/wire/add';
import { Body } from './wire/brume/wire/body';
import { Change } from './wire/brume/wire/change';
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
import { Remove as WireRemove } from './wire/brume/wire/remove';
import { Restart } from './wire/brume/wire/restart';
import { Set as WireSet } from './wire/brume/wire/set';
import { Undo } from './wire/brume/wire/undo';
import { Vec3 as WireVec3 } from './wire/brume/wire/vec3';
import { Frustum as WireFrustum } from './wire/brume/wire/frustum';
import type { Change as OneChange, Command, Frustum, HelloMessage, PoseMessage, Vec3 } from './protocol';

export function finish(builder: Builder, type: Body, body: number): Uint8Array<ArrayBuffer> {
  Message.finishSizePrefixedMessageBuffer(builder, Message.createMessage(builder, type, body));
  return builder.asUint8Array() as Uint8Array<ArrayBuffer>;
}

export const vec3 = (builder: Builder, v: Vec3): number => WireVec3.createVec3(builder, v[0], v[1], v[2]);

const createFrustum = (builder: Builder, f: Frustum): number =>
  WireFrustum.createFrustum(builder, f.left, f.right, f.up, f.down);

export function encodeHello(hello: HelloMessage): Uint8Array<ArrayBuffer> {
  const builder = new Builder(128);
  const client = builder.createString(hello.client);
  const resume = hello.resume ? builder.createString(hello.resume) : 0;
  return finish(
    builder,
    Body.Hello,
    Hello.createHello(
      builder,
      client,
      hello.width,
      hello.height,
      hello.views ?? 1,
      hello.quality,
      resume,
      true, // PNG is read
      false,
      hello.drawHz ?? 0,
    ),
  );
}

export function encodePose(pose: PoseMessage): Uint8Array<ArrayBuffer> {
  const builder = new Builder(128);
  const view = pose.view && pose.view !== 'picture' ? builder.createString(pose.view) : 0;
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
  if (view) WirePose.addView(builder, view);
  WirePose.addLayers(builder, pose.layers ?? 0);
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

const buildChanges = (builder: Builder, changes: readonly OneChange[]): number[] =>
  changes.map(({ path, value }) => {
    const [name, text] = [builder.createString(path), typeof value === 'string' ? builder.createString(value) : 0];
    Change.startChange(builder);
    Change.addPath(builder, name);
    if (typeof value === 'number') Change.addNumber(builder, value);
    if (typeof value === 'object') Change.addVector(builder, vec3(builder, value));
    if (text) Change.addText(builder, text);
    return Change.endChange(builder);
  });

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
    case 'set': {
      const list = WireSet.createChangesVector(builder, buildChanges(builder, command.changes));
      WireSet.startSet(builder);
      WireSet.addChanges(builder, list);
      return [CommandType.Set, WireSet.endSet(builder)];
    }
    case 'add': {
      const name = builder.createString(command.list);
      const list = WireAdd.createChangesVector(builder, buildChanges(builder, command.changes));
      return [CommandType.Add, WireAdd.createAdd(builder, name, list)];
    }
    case 'remove':
      return [CommandType.Remove, WireRemove.createRemove(builder, builder.createString(command.path))];
    case 'restart':
      Restart.startRestart(builder);
      return [CommandType.Restart, Restart.endRestart(builder)];
    case 'undo':
      return [CommandType.Undo, Undo.createUndo(builder, false)];
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
