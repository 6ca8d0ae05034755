import { describe, expect, test } from 'vitest';
import { Steady, lack, liveText } from '../src/live';
import type { Seen } from '../src/live';

const whole: Seen = {
  ...{
    standing: false,
    paused: false,
    mayControl: true,
    touch: false,
    relaxed: 0,
    limit: Infinity,
    rate: 60,
    serverMs: 5,
    redrawn: 'no',
    drawnHere: false,
  },
  frame: { width: 640, height: 360, quality: 80 },
  asked: { width: 640, height: 360 },
};

describe('what pictures lack', () => {
  test('is nothing while they are as asked for', () => {
    expect(lack(whole)).toBeUndefined();
    expect(lack({ ...whole, frame: undefined })).toBeUndefined();
    expect(lack({ ...whole, frame: { width: 638, height: 358, quality: 40 } })).toBeUndefined();
  });

  test('is nothing where pictures are redrawn, which a word tells if nobody asked', () => {
    for (const redrawn of ['yes', 'unasked'] as const) expect(lack({ ...whole, redrawn, rate: 5 })).toBeUndefined();
    expect(lack({ ...whole, redrawn: 'no', rate: 5 })).toBe('5 pictures/s: the link is slow');
    expect(lack({ ...whole, redrawn: 'yes', rate: 1 })).toBe('1 pictures/s: the link is slow');
    expect(lack({ ...whole, redrawn: 'missing' })).toMatch(/^No layers with depth/);
    expect((['yes', 'unasked', 'no'] as const).map((redrawn) => liveText({ ...whole, redrawn }))).toEqual([
      'Live',
      'Live, redrawn here between pictures',
      'Live',
    ]);
  });

  test('names who can resume', () => {
    const still = { ...whole, paused: true, relaxed: 2 };
    expect(lack(still)).toBe('Paused: resume with P');
    expect(lack({ ...still, touch: true })).toBe('Paused: tap Pause to resume');
    expect(lack({ ...still, mayControl: false })).toBe('Paused: a controller can resume');
  });

  test('is everything while the scene stands still, and no link is blamed', () => {
    expect(lack({ ...whole, standing: true, rate: 0 })).toBe('Standing still');
    expect(lack({ ...whole, standing: true, paused: true })).toBe('Standing still');
  });

  test('is another scene while that is made ready', () => {
    expect(lack({ ...whole, preparing: 'cumulus', paused: true })).toBe('Preparing cumulus…');
  });

  test('names the size and who made it small', () => {
    const small = { ...whole, frame: { width: 320, height: 180, quality: 40 } };
    expect(lack(small)).toBe('320×180: the link is slow');
    expect(lack({ ...small, relaxed: 1 })).toBe('320×180: the link is slow');
    expect(lack({ ...small, relaxed: 1, frame: { ...small.frame, quality: 75 } })).toBe('320×180: the server is busy');
    expect(lack({ ...small, frame: { ...small.frame, reduced: 'device' } })).toBe('320×180: the server is busy');
    expect(lack({ ...small, relaxed: 1, frame: { ...small.frame, quality: 75, reduced: 'link' } })).toBe(
      '320×180: the link is slow',
    );
    expect(lack({ ...whole, asked: { width: 1920, height: 1080 }, limit: 640 * 360 })).toBe(
      '640×360: the server’s limit',
    );
  });

  test('names a low rate and whose it is', () => {
    expect(lack({ ...whole, rate: 9 })).toBeUndefined();
    expect(lack({ ...whole, rate: 3.2 })).toBe('3 pictures/s: the link is slow');
    expect(lack({ ...whole, rate: 0.5, serverMs: 400, relaxed: 3 })).toBe('0.5 pictures/s: the server is busy');
    expect(lack({ ...whole, rate: undefined })).toBeUndefined();
  });

  test('tells accuracy that was given up', () => {
    expect(lack({ ...whole, relaxed: 1 })).toBe('Accuracy reduced: the server is busy');
  });
});

describe('the line', () => {
  test('waits until something lasts', () => {
    const line = new Steady(3);
    expect(['a', 'a', 'b', 'a', 'a', 'a', undefined].map((text) => line.next(text))).toEqual([
      ...[undefined, undefined, undefined, undefined, undefined, 'a', 'a'],
    ]);
  });

  test('says at once what is certain, and takes it back at once', () => {
    const line = new Steady(3);
    expect(line.next('paused', true)).toBe('paused');
    expect(line.next(undefined)).toBeUndefined();
  });
});
