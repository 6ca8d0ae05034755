import { ByteBuffer } from 'flatbuffers';
import { readFileSync } from 'node:fs';
import { expect } from 'vitest';
import { Ack } from '../src/wire/brume/wire/ack';
import { Add } from '../src/wire/brume/wire/add';
import { Body } from '../src/wire/brume/wire/body';
import { Command as CommandType } from '../src/wire/brume/wire/command';
import { Encoding } from '../src/wire/brume/wire/encoding';
import { Error as WireError } from '../src/wire/brume/wire/error';
import { ErrorCode } from '../src/wire/brume/wire/error-code';
import { Frame } from '../src/wire/brume/wire/frame';
import { Goodbye } from '../src/wire/brume/wire/goodbye';
import { Hello } from '../src/wire/brume/wire/hello';
import { Impulse } from '../src/wire/brume/wire/impulse';
import { Input } from '../src/wire/brume/wire/input';
import { Lead } from '../src/wire/brume/wire/lead';
import { LitParticles } from '../src/wire/brume/wire/lit-particles';
import { Message } from '../src/wire/brume/wire/message';
import { MoveVolume } from '../src/wire/brume/wire/move-volume';
import { ObjectKind } from '../src/wire/brume/wire/object-kind';
import { People } from '../src/wire/brume/wire/people';
import { Ping } from '../src/wire/brume/wire/ping';
import { Pong } from '../src/wire/brume/wire/pong';
import { Pose } from '../src/wire/brume/wire/pose';
import { Presence } from '../src/wire/brume/wire/presence';
import { Remove } from '../src/wire/brume/wire/remove';
import { Restart } from '../src/wire/brume/wire/restart';
import { Undo } from '../src/wire/brume/wire/undo';
import { Role } from '../src/wire/brume/wire/role';
import { SettingKind } from '../src/wire/brume/wire/setting-kind';
import { SceneState } from '../src/wire/brume/wire/scene-state';
import { Set as WireSet } from '../src/wire/brume/wire/set';
import { SetParticles } from '../src/wire/brume/wire/set-particles';
import { Welcome } from '../src/wire/brume/wire/welcome';

// The frozen messages that the C++ tests read too.
const folder = new URL('../../../protocol/examples/', import.meta.url);
export type Json = null | boolean | number | string | Json[] | { [key: string]: Json };
export type Fields = { [key: string]: Json };
export const examples = JSON.parse(readFileSync(new URL('examples.json', folder), 'utf8')) as {
  [name: string]: { type: string; body: Fields; jpeg?: string[] };
};
export const names = Object.keys(examples);

export function bytesOf(name: string): ArrayBuffer {
  const file = readFileSync(new URL(`${name}.bin`, folder));
  return file.buffer.slice(file.byteOffset, file.byteOffset + file.byteLength) as ArrayBuffer;
}

const tables: { [type: string]: new () => object } = {
  ...{
    Ack,
    Add,
    Error: WireError,
    Frame,
    Goodbye,
    Hello,
    Impulse,
    Input,
    Lead,
    LitParticles,
    MoveVolume,
    People,
    Ping,
    Pong,
    Pose,
    Presence,
    Remove,
    Restart,
    Undo,
    SceneState,
  },
  ...{ Set: WireSet, SetParticles, Welcome },
};

const LISTS = [
  'methods',
  'quadratures',
  'jpeg_bytes',
  'passes',
  'changes',
  'settings',
  'choices',
  'starts',
  'scenes',
  'positions',
  'scales',
  'extinctions',
  'albedos',
  'lists',
  'values',
  'phase',
  'hues',
  'objects',
  'people',
  'path',
];

// Reads, with the generated code, the fields that `like` has, into the JSON that the examples are written in.
function read(table: object, like: Fields): Fields {
  const out: Fields = {};
  const call = (name: string, ...args: unknown[]): unknown =>
    (table as { [name: string]: (...args: unknown[]) => unknown })[name]?.(...args);
  for (const [key, value] of Object.entries(like)) {
    const name = key.replace(/_(\w)/g, (_, letter: string) => letter.toUpperCase());
    if (key === 'command_type') out[key] = CommandType[call(name) as number] ?? null;
    else if (key === 'encoding') out[key] = Encoding[call(name) as number] ?? null;
    else if (key === 'kind') out[key] = ('yaw' in like ? ObjectKind : SettingKind)[call(name) as number] ?? null;
    else if (key === 'least_role' || (key === 'role' && typeof value === 'string'))
      out[key] = Role[call(name) as number] ?? null;
    else if (key === 'code') out[key] = ErrorCode[call(name) as number] ?? null;
    else if (key === 'command') {
      const Table = tables[like['command_type'] as string];
      out[key] = Table ? read(call(name, new Table()) as object, value as Fields) : null;
    } else if (LISTS.includes(key) && Array.isArray(value)) {
      const items = Array.from({ length: call(`${name}Length`) as number }, (_, i) => call(name, i));
      const wanted = value as Json[];
      out[key] = items.map((x, i) => {
        const item = wanted[i] ?? wanted[0] ?? null;
        return item !== null && typeof item === 'object' ? read(x as object, item as Fields) : (x as Json);
      });
    } else out[key] = plain(call(name), value);
  }
  return out;
}

function plain(found: unknown, like: Json): Json {
  if (typeof found === 'bigint') return found.toString();
  if (found === null || typeof found !== 'object') return found as Json;
  if (Array.isArray(like)) {
    const v = found as { [axis: string]: () => number };
    return ['x', 'y', 'z', 'w'].slice(0, like.length).map((axis) => v[axis]?.() ?? NaN);
  }
  return read(found, like as Fields);
}

export function readMessage(bytes: ArrayBuffer | Uint8Array, like: { type: string; body: Fields }): unknown {
  const array = new Uint8Array(bytes);
  const size = new DataView(array.buffer, array.byteOffset).getUint32(0, true);
  expect(size).toBeLessThanOrEqual(array.length - 4);
  expect(new TextDecoder().decode(array.subarray(8, 12))).toBe('BRM1');
  const message = Message.getSizePrefixedRootAsMessage(new ByteBuffer(array));
  const Table = tables[like.type];
  if (!Table) throw new Error(`no table ${like.type}`);
  return { type: Body[message.bodyType()], body: read(message.body(new Table()) as object, like.body) };
}

export const field = (body: Json | undefined, key: string): Json => (body as Fields)[key] ?? null;
// An optional field of an example as this page's messages have it: absent instead of null.
export function present(body: Json | undefined, map: { [to: string]: string }): { [key: string]: Json } {
  const out: { [key: string]: Json } = {};
  for (const [to, from] of Object.entries(map)) if (field(body, from) !== null) out[to] = field(body, from);
  return out;
}
