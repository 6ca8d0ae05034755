// Views of how a picture is made: the room of their legends, and what is said of them.
import { describe, expect, test } from 'vitest';
import { legendPart, viewText } from '../src/views';

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

describe('what a view shows', () => {
  test('is of the sun where one shines', () => {
    expect(viewText('light', [1, 0, 0])).toMatch(/sun’s light that arrives/);
    expect(viewText('shadow', undefined)).toMatch(/sun’s shadow map/);
  });

  test('is not of a sun where none shines', () => {
    for (const view of ['light', 'shadow'] as const) expect(viewText(view, [0, 0, 0])).toMatch(/^No sun shines here/);
    expect(viewText('depth', [0, 0, 0])).toBe(viewText('depth', [1, 1, 1]));
  });
});
