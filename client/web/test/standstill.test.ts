import { Builder } from 'flatbuffers';
import { describe, expect, test } from 'vitest';
import { decode } from '../src/decode';
import { standstillText } from '../src/sentence';
import { Body } from '../src/wire/brume/wire/body';
import { Message } from '../src/wire/brume/wire/message';
import { SceneState } from '../src/wire/brume/wire/scene-state';

function sceneState(standstill: string | undefined): ArrayBuffer {
  const b = new Builder(64);
  const why = standstill === undefined ? 0 : b.createString(standstill);
  SceneState.startSceneState(b);
  SceneState.addTick(b, 7n);
  if (standstill !== undefined) SceneState.addStandstill(b, why);
  const state = SceneState.endSceneState(b);
  Message.finishSizePrefixedMessageBuffer(b, Message.createMessage(b, Body.SceneState, state));
  return b.asUint8Array().slice().buffer as ArrayBuffer;
}

describe('a standstill', () => {
  test('is told by the scene, and absent while ticks come', () => {
    expect(decode(sceneState('no word from the log'))).toMatchObject({ tick: 7n, standstill: 'no word from the log' });
    expect(decode(sceneState(undefined))).not.toHaveProperty('standstill');
    expect(decode(sceneState(''))).not.toHaveProperty('standstill');
  });

  test('is one line, however much the server says', () => {
    const scene = decode(sceneState('x'.repeat(5000)));
    expect(scene.kind === 'scene' && scene.standstill?.length).toBe(300);
  });

  test('is said in a sentence', () => {
    expect(standstillText('no word from the log for 3 s')).toBe(
      'The scene stands still: no word from the log for 3 s.',
    );
    expect(standstillText('nats://host is away.')).toBe('The scene stands still: nats://host is away.');
  });
});
