import { describe, expect, test } from 'vitest';
import { decode } from '../src/decode';
import { encodeAck, encodeGoodbye, encodeHello, encodeInput, encodePing, encodePong, encodePose } from '../src/encode';
import type { Change, Command, Frustum, Quat, SettingValue, Vec3 } from '../src/protocol';
import { examples, field, present, readMessage } from './examples';
import type { Fields, Json } from './examples';

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
    input('input_undo', () => ({ kind: 'undo' }));
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
