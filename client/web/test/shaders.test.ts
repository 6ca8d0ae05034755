import { describe, expect, test } from 'vitest';
import { composeSource, placesSource, rangeSource, raysSource, shadowSource } from '../src/lit-shaders';
import { slabsSource, splineSource, surfacesSource } from '../src/lit-shaders';

// A browser compiles them: tests/browser/drawing.mjs.
const sources = {
  range: rangeSource(),
  places: placesSource(),
  slabs: slabsSource({ hues: 3, fluences: 3 }, 4, 4),
  rays: raysSource(0, 8),
  spline: splineSource(0, 8),
  shadow: shadowSource(),
  surfaces: surfacesSource(),
  compose: composeSource(true, false),
};

describe('shaders', () => {
  test.each(Object.entries(sources))(
    'of %s have the server’s formulas, and nothing that WebGL does not take',
    (_, source) => {
      for (const text of Object.values(source)) {
        expect(text.startsWith('#version 300 es\n')).toBe(true);
        expect(text.match(/void main\(\)/g)?.length).toBe(1);
        expect(text).toContain('litSums(real q)');
        expect(text).not.toMatch(/__cplusplus|#include|\/\//);
      }
    },
  );
});
