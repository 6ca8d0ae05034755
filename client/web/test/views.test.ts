// Views of how a picture is made: the room of their legends.
import { describe, expect, test } from 'vitest';
import { legendPart } from '../src/views';

describe('a legend', () => {
  test('takes more of a small picture', () => {
    expect(legendPart({ width: 320, height: 180 })).toBeCloseTo(44 / 180);
    expect(legendPart({ width: 640, height: 360 })).toBeCloseTo(44 / 360);
  });

  test('grows with the picture, as far as its width allows', () => {
    expect(legendPart({ width: 1280, height: 720 })).toBeCloseTo(88 / 720);
    expect(legendPart({ width: 360, height: 780 })).toBeCloseTo(44 / 780);
  });

  test('is no larger than the picture', () => {
    expect(legendPart({ width: 64, height: 36 })).toBe(1);
  });
});
