import { ByteBuffer } from 'flatbuffers';
import { readFileSync } from 'node:fs';
import { describe, expect, test } from 'vitest';
import { decode } from '../src/decode';
import { encodeAck, encodeGoodbye, encodeHello, encodeInput, encodePing, encodePong, encodePose } from '../src/encode';
import { ProtocolError } from '../src/protocol';
import type { Change, Command, Frustum, Quat, SettingValue, Vec3 } from '../src/protocol';
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
import { Message } from '../src/wire/brume/wire/message';
import { MoveVolume } from '../src/wire/brume/wire/move-volume';
import { Ping } from '../src/wire/brume/wire/ping';
import { Pong } from '../src/wire/brume/wire/pong';
import { Pose } from '../src/wire/brume/wire/pose';
import { Remove } from '../src/wire/brume/wire/remove';
import { Restart } from '../src/wire/brume/wire/restart';
import { Role } from '../src/wire/brume/wire/role';
import { SettingKind } from '../src/wire/brume/wire/setting-kind';
import { SceneState } from '../src/wire/brume/wire/scene-state';
import { Set as WireSet } from '../src/wire/brume/wire/set';
import { SetLight } from '../src/wire/brume/wire/set-light';
import { SetMedium } from '../src/wire/brume/wire/set-medium';
import { SetParticles } from '../src/wire/brume/wire/set-particles';
import { SetRender } from '../src/wire/brume/wire/set-render';
import { SetSimulation } from '../src/wire/brume/wire/set-simulation';
import { Welcome } from '../src/wire/brume/wire/welcome';

// The frozen messages that the C++ tests read too.
const folder = new URL('../../../protocol/examples/', import.meta.url);
type Json = null | boolean | number | string | Json[] | { [key: string]: Json };
type Fields = { [key: string]: Json };
const examples = JSON.parse(readFileSync(new URL('examples.json', folder), 'utf8')) as {
  [name: string]: { type: string; body: Fields; jpeg?: string[] };
};
const names = Object.keys(examples);

function bytesOf(name: string): ArrayBuffer {
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
    MoveVolume,
    Ping,
    Pong,
    Pose,
    Remove,
    Restart,
    SceneState,
  },
  ...{ Set: WireSet, SetLight, SetMedium, SetParticles, SetRender, SetSimulation, Welcome },
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
    else if (key === 'kind') out[key] = SettingKind[call(name) as number] ?? null;
    else if (key === 'least_role') out[key] = Role[call(name) as number] ?? null;
    else if (key === 'code') out[key] = ErrorCode[call(name) as number] ?? null;
    else if (key === 'command') {
      const Table = tables[like['command_type'] as string];
      out[key] = Table ? read(call(name, new Table()) as object, value as Fields) : null;
    } else if (LISTS.includes(key) && value !== null) {
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

function readMessage(bytes: ArrayBuffer | Uint8Array, like: { type: string; body: Fields }): unknown {
  const array = new Uint8Array(bytes);
  const size = new DataView(array.buffer, array.byteOffset).getUint32(0, true);
  expect(size).toBeLessThanOrEqual(array.length - 4);
  expect(new TextDecoder().decode(array.subarray(8, 12))).toBe('BRM1');
  const message = Message.getSizePrefixedRootAsMessage(new ByteBuffer(array));
  const Table = tables[like.type];
  if (!Table) throw new Error(`no table ${like.type}`);
  return { type: Body[message.bodyType()], body: read(message.body(new Table()) as object, like.body) };
}

const field = (body: Json | undefined, key: string): Json => (body as Fields)[key] ?? null;
// An optional field of an example as this page's messages have it: absent instead of null.
function present(body: Json | undefined, map: { [to: string]: string }): { [key: string]: Json } {
  const out: { [key: string]: Json } = {};
  for (const [to, from] of Object.entries(map)) if (field(body, from) !== null) out[to] = field(body, from);
  return out;
}

describe('frozen examples', () => {
  test('are all there', () => {
    const types = new Set(names.map((name) => examples[name]?.type));
    const known = Object.keys(Body).filter((name) => Number.isNaN(Number(name)) && name !== 'NONE');
    expect([...types].sort()).toEqual(known.sort());
  });

  test.each(names)('%s reads as written, with the generated code', (name) => {
    const example = examples[name] ?? { type: '', body: {} };
    expect(readMessage(bytesOf(name), example)).toEqual({ type: example.type, body: example.body });
  });
});

describe('decode', () => {
  const body = (name: string): Fields => examples[name]?.body ?? {};

  test('welcome', () => {
    const b = body('welcome');
    const camera = field(b, 'camera');
    expect(decode(bytesOf('welcome'))).toEqual({
      kind: 'welcome',
      ...present(b, { viewer: 'viewer', server: 'server', scene: 'scene', device: 'device', width: 'width' }),
      ...present(b, { height: 'height', tickHz: 'tick_hz', maxInFlight: 'max_in_flight' }),
      settings: [],
      starts: [],
      scenes: [],
      lists: [],
      resume: '',
      role: 'operator', // as before there were roles
      camera: present(camera, { position: 'position', target: 'target', fovY: 'fov_y' }),
    });
  });

  test('scene state', () => {
    const b = body('scene_state');
    expect(decode(bytesOf('scene_state'))).toEqual({
      kind: 'scene',
      tick: BigInt(b['tick'] as string),
      stateHash: BigInt(b['state_hash'] as string),
      ...present(b, { viewers: 'viewers', particles: 'particles', passes: 'passes' }),
      settings: [],
    });
  });

  test('scene state with its plan', () => {
    const scene = decode(bytesOf('scene_state_plan'));
    if (scene.kind !== 'scene') throw new Error('not a scene state');
    const { method, error, ms, relaxed } = body('scene_state_plan')['plan'] as Record<string, unknown>;
    expect(scene.plan).toEqual({ method, error, ms, relaxed, text: '' });
  });

  test('what is promised of the pictures', () => {
    const scene = decode(bytesOf('scene_state_promised'));
    if (scene.kind !== 'scene') throw new Error('not a scene state');
    expect(scene.plan?.promised).toBe((body('scene_state_promised')['plan'] as Fields)['promised']);
    expect(scene.plan?.promised).toBe(2 ** -7);
  });

  test('settings and their values', () => {
    const welcome = decode(bytesOf('welcome_settings'));
    const scene = decode(bytesOf('scene_state_settings'));
    if (welcome.kind !== 'welcome' || scene.kind !== 'scene') throw new Error('other messages');
    const said = body('welcome_settings')['settings'] as Fields[];
    expect(welcome.settings).toEqual(
      said.map((s) => ({
        ...present(s, { path: 'path', kind: 'kind', help: 'help', leastRole: 'least_role' }),
        ...present(s, { lowest: 'lowest', highest: 'highest' }),
        ...present(s, { usualLowest: 'usual_lowest', usualHighest: 'usual_highest' }),
        unit: s['unit'] ?? '',
        choices: s['choices'] ?? [],
        onlyType: '',
      })),
    );
    expect(scene.settings).toEqual([[0.5, 0.75, 1], 0.25, 'isv']);
    expect(scene.plan?.text).toBe('isv, simpson 2');
  });

  test('scenes, what this one began with, and where its medium is', () => {
    const welcome = decode(bytesOf('welcome_scenes'));
    const scene = decode(bytesOf('scene_state_box'));
    if (welcome.kind !== 'welcome' || scene.kind !== 'scene') throw new Error('other messages');
    expect(welcome.scenes).toEqual(body('welcome_scenes')['scenes']);
    expect(welcome.starts).toEqual([0.5]);
    expect(scene.box).toEqual({ lo: body('scene_state_box')['lo'], hi: body('scene_state_box')['hi'] });
  });

  test('lists and their elements', () => {
    const welcome = decode(bytesOf('welcome_lists'));
    const scene = decode(bytesOf('scene_state_lists'));
    if (welcome.kind !== 'welcome' || scene.kind !== 'scene') throw new Error('other messages');
    const [lights, ...others] = welcome.lists;
    expect(lights).toMatchObject({ name: 'light', most: 1024 });
    expect(lights?.settings.map(({ path, onlyType }) => [path, onlyType])).toEqual([
      ['light.type', ''],
      ['light.position', ''],
      ['light.outer', 'spot'],
    ]);
    expect(others).toEqual([]);
    expect(scene.lists).toEqual([[1, 1.5, -2.25, 26, 0.5, 0, 0.5, 0, -1, 0.25]]);
  });

  test.each(['frame', 'frame_stereo', 'frame_frusta', 'frame_png'])('%s, with the bytes of each view', (name) => {
    const b = body(name);
    const frame = decode(bytesOf(name));
    if (frame.kind !== 'frame') throw new Error('not a frame');
    const { jpeg, ...rest } = frame;
    expect(rest).toEqual({
      kind: 'frame',
      tick: BigInt(b['tick'] as string),
      stateHash: BigInt(b['state_hash'] as string),
      clientTimeUs: BigInt(b['client_time_us'] as string),
      ...present(b, { id: 'id', poseSeq: 'pose_seq', width: 'width', height: 'height', quality: 'quality' }),
      ...present(b, { stages: 'stages', position: 'position', orientation: 'orientation', fovY: 'fov_y' }),
      frusta: [b['frustum'], b['right_frustum']].filter((frustum) => frustum !== undefined),
    });
    expect(jpeg.map((view) => Buffer.from(view).toString('hex'))).toEqual(examples[name]?.jpeg);
  });

  test('a frame with its measured error, and one without', () => {
    const [known, unknown] = [decode(bytesOf('frame_measured')), decode(bytesOf('frame'))];
    if (known.kind !== 'frame' || unknown.kind !== 'frame') throw new Error('not frames');
    const b = body('frame_measured');
    expect(known.measured).toEqual(present(b, { error: 'measured', low: 'measured_low', high: 'measured_high' }));
    expect(known.measured?.error).toBe(2 ** -8);
    expect(unknown.measured).toBeUndefined();
  });

  test('error, goodbye, ping and pong', () => {
    expect(decode(bytesOf('error'))).toEqual({
      kind: 'error',
      code: ErrorCode.unknown_name,
      ...present(body('error'), { text: 'text', inputSeq: 'input_seq' }),
    });
    expect(decode(bytesOf('goodbye'))).toEqual({
      kind: 'goodbye',
      ...present(body('goodbye'), { reason: 'reason', retryAfterS: 'retry_after_s' }),
      goTo: '',
    });
    expect(decode(bytesOf('goodbye_go_to'))).toMatchObject({ goTo: body('goodbye_go_to')['go_to'] });
    for (const kind of ['ping', 'pong'] as const) {
      const timeUs = BigInt(body(kind)['time_us'] as string);
      expect(decode(bytesOf(kind))).toEqual({ kind, nonce: body(kind)['nonce'], timeUs });
    }
  });

  test('refuses what is not a server’s message', () => {
    const frame = bytesOf('frame');
    const altered = (at: number, value: number): ArrayBuffer => {
      const copy = new Uint8Array(frame.slice(0));
      copy[at] = value;
      return copy.buffer;
    };
    const bad: [string, ArrayBuffer][] = [
      ['empty', new ArrayBuffer(0)],
      ['eight bytes', frame.slice(0, 8)],
      ['a length beyond the end', altered(2, 255)],
      ['a length of nothing', new Uint8Array(16).buffer],
      ['another identifier', altered(8, 0x41)],
      ['a picture cut short', frame.slice(0, frame.byteLength - 1)],
      ['bytes after the picture', new Uint8Array([...new Uint8Array(frame), 0]).buffer],
      ['bytes after a pong', new Uint8Array([...new Uint8Array(bytesOf('pong')), 0]).buffer],
      ['a viewer’s message', bytesOf('hello')],
    ];
    for (const [what, bytes] of bad) expect(() => decode(bytes), what).toThrow(ProtocolError);
  });
});

describe('encode', () => {
  // What this page writes must read like the example made of the same values.
  const check = (name: string, bytes: Uint8Array): void => {
    const example = examples[name] ?? { type: '', body: {} };
    expect(readMessage(bytes, example)).toEqual({ type: example.type, body: example.body });
  };
  const input = (name: string, command: (body: Json) => Command): void => {
    const body = examples[name]?.body ?? {};
    check(
      name,
      encodeInput(body['seq'] as number, BigInt(body['client_time_us'] as string), command(body['command']!)),
    );
  };

  test('hello', () => {
    const { client, width, height, quality } = { ...examples['hello']?.body, client: 'a viewer ☁' } as Fields & {
      client: string;
      width: number;
      height: number;
      quality: number;
    };
    for (const views of [1, 2] as const) {
      const bytes = encodeHello({ client, width, height, quality, ...(views === 2 ? { views } : {}) });
      const wish = { client, width, height, views, quality };
      expect(readMessage(bytes, { type: 'Hello', body: wish })).toEqual({ type: 'Hello', body: wish });
    }
    const back = { client, width, height, views: 1, quality, resume: '00ff' };
    const bytes = encodeHello({ client, width, height, quality, resume: '00ff' });
    expect(readMessage(bytes, { type: 'Hello', body: back })).toEqual({ type: 'Hello', body: back });
  });

  test.each(['pose', 'pose_frusta', 'pose_hidden', 'pose_view'])('%s', (name) => {
    const body: Fields = { ...examples[name]?.body };
    const frusta = [body['frustum'], body['right_frustum']].filter((frustum) => frustum !== undefined);
    const bytes = encodePose({
      seq: body['seq'] as number,
      clientTimeUs: BigInt(body['client_time_us'] as string),
      position: body['position'] as unknown as Vec3,
      orientation: body['orientation'] as unknown as Quat,
      fovY: body['fov_y'] as number,
      width: body['width'] as number,
      height: body['height'] as number,
      eyeSeparation: body['eye_separation'] as number,
      frusta: frusta as unknown as Frustum[],
      hidden: body['hidden'] === true,
      ...(body['view'] !== undefined && { view: body['view'] as unknown as string }),
    });
    expect(readMessage(bytes, { type: 'Pose', body })).toEqual({ type: 'Pose', body });
  });

  test('inputs', () => {
    const as = (kind: Command['kind'], fields: object): Command => ({ kind, ...fields }) as Command;
    input('input_impulse', (c) =>
      as('impulse', present(c, { origin: 'origin', direction: 'direction', push: 'push', strength: 'strength' })),
    );
    input('input_move_volume', (c) => as('move', present(c, { offset: 'offset' })));
    const changesOf = (c: Json): Change[] =>
      (field(c, 'changes') as Fields[]).map((change) => ({
        path: change['path'] as string,
        value: (change['number'] ?? change['vector'] ?? change['text']) as unknown as SettingValue,
      }));
    input('input_set', (c) => ({ kind: 'set', changes: changesOf(c) }));
    input('input_add', (c) => ({ kind: 'add', list: field(c, 'list') as string, changes: changesOf(c) }));
    input('input_remove', (c) => ({ kind: 'remove', path: field(c, 'path') as string }));
    input('input_restart', () => ({ kind: 'restart' }));
  });

  test('an optional number that is zero is sent, one that is not given is not', () => {
    const of = (command: Command, type: string, body: Fields): void => {
      const like = { type: 'Input', body: { seq: 1, command_type: type, command: body } };
      expect(readMessage(encodeInput(1, 0n, command), like)).toEqual(like);
    };
    of({ kind: 'set', changes: [{ path: 'light.rotate', value: 0 }] }, 'Set', {
      changes: [{ path: 'light.rotate', number: 0, vector: null, text: null }],
    });
    const impulse: Command = { kind: 'impulse', origin: [0, 0, 0], direction: [0, 0, -1], strength: 0 };
    of(impulse, 'Impulse', { push: null, strength: 0 });
  });

  test('ack, ping, pong, goodbye', () => {
    check('ack', encodeAck(examples['ack']?.body['frame'] as number));
    for (const [name, encode] of [
      ['ping', encodePing],
      ['pong', encodePong],
    ] as const) {
      const body = examples[name]?.body ?? {};
      check(name, encode(body['nonce'] as number, BigInt(body['time_us'] as string)));
    }
    const farewell = decode(encodeGoodbye('bye').slice().buffer);
    expect(farewell).toEqual({ kind: 'goodbye', reason: 'bye', retryAfterS: 0, goTo: '' });
  });
});
