import { describe, expect, test } from 'vitest';
import { decode } from '../src/decode';
import { ProtocolError } from '../src/protocol';
import { Builder } from 'flatbuffers';
import { Body } from '../src/wire/brume/wire/body';
import { DepthLayers as WireLayers } from '../src/wire/brume/wire/depth-layers';
import { Frame as WireFrame } from '../src/wire/brume/wire/frame';
import { Message } from '../src/wire/brume/wire/message';
import { Quat as WireQuat } from '../src/wire/brume/wire/quat';
import { Stages as WireStages } from '../src/wire/brume/wire/stages';
import { Vec3 as WireVec3 } from '../src/wire/brume/wire/vec3';
import { ErrorCode } from '../src/wire/brume/wire/error-code';
import { bytesOf, examples, field, names, present, readMessage } from './examples';
import type { Fields } from './examples';

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

  test('a frame with layers, whose pictures follow those of all views', () => {
    const builder = new Builder(256);
    const bytes = WireLayers.createBytesVector(builder, [1, 2, 3]);
    WireLayers.startDepthLayers(builder);
    WireLayers.addCount(builder, 4);
    WireLayers.addColumns(builder, 18);
    WireLayers.addSpacing(builder, 8);
    WireLayers.addNearest(builder, 2.5);
    WireLayers.addBytes(builder, bytes);
    const layers = WireFrame.createLayersVector(builder, [WireLayers.endDepthLayers(builder)]);
    const jpeg = WireFrame.createJpegBytesVector(builder, [2]);
    WireFrame.startFrame(builder);
    WireFrame.addPosition(builder, WireVec3.createVec3(builder, 0, 0, 0));
    WireFrame.addOrientation(builder, WireQuat.createQuat(builder, 0, 0, 0, 1));
    WireFrame.addStages(builder, WireStages.createStages(builder, 0, 0, 0, 0, 0));
    WireFrame.addJpegBytes(builder, jpeg);
    WireFrame.addLayers(builder, layers);
    const message = Message.createMessage(builder, Body.Frame, WireFrame.endFrame(builder));
    Message.finishSizePrefixedMessageBuffer(builder, message);
    const head = builder.asUint8Array();
    const all = (tail: number[]): ArrayBuffer => Uint8Array.from([...head, ...tail]).buffer;
    const frame = decode(all([9, 9, 1, 2, 2, 3, 3, 3]));
    expect(frame).toMatchObject({
      jpeg: [Uint8Array.of(9, 9)],
      layers: [{ count: 4, columns: 18, spacing: 8, nearest: 2.5, colours: Uint8Array.of(1) }],
    });
    expect(frame.kind === 'frame' && frame.layers?.[0]?.surface).toEqual(Uint8Array.of(3, 3, 3));
    expect(() => decode(all([9, 9, 1, 2, 2, 3, 3]))).toThrow(ProtocolError);
    expect(() => decode(all([9, 9]))).toThrow(ProtocolError);
  });

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
      medium: '',
      people: false, // as from a server before there were people
      path: [],
      lists: [],
      resume: '',
      role: 'operator', // as before there were roles
      camera: present(camera, { position: 'position', target: 'target', fovY: 'fov_y' }),
    });
  });

  test('the key views of a scene', () => {
    expect(decode(bytesOf('welcome_path'))).toMatchObject({
      path: [
        { position: [0, 2, 26], target: [0, 0.5, 0], fovY: 0.75, seconds: 0 },
        { position: [1.5, -2.25, 26], target: [0, 0.5, 0], fovY: 0.5, seconds: 2.5 },
      ],
    });
  });

  test('what an undo would do', () => {
    expect(decode(bytesOf('scene_state_undo'))).toMatchObject({ undo: 'medium.extinction back to 1.2' });
    expect(decode(bytesOf('scene_state_standstill'))).not.toHaveProperty('undo');
  });

  test('the model of the medium', () => {
    expect(decode(bytesOf('welcome_medium'))).toMatchObject({ medium: 'union' });
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
      follows: 0,
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
