import { describe, expect, test } from 'vitest';
import type { Setting } from '../src/protocol';
import { cloudName } from '../src/scenes';
import { sentence } from '../src/sentence';
import { changesBack, isIdle, valuesOf } from '../src/shared-settings';

test('a line of the server is a sentence, and names keep their letters', () => {
  expect(sentence('every place is taken')).toBe('Every place is taken.');
  expect(sentence('other.ply:10: not a number')).toBe('other.ply:10: not a number.');
  expect(sentence('/tmp/a.ply: no such file.')).toBe('/tmp/a.ply: no such file.');
  expect(sentence('--port: taken')).toBe('--port: taken.');
});

test('a file gets a name that the server takes', () => {
  expect(cloudName('mine.ply')).toBe('mine');
  expect(cloudName('Schöne Wolke (3).v2.ply')).toBe('Sch-ne-Wolke-3-v2');
  expect(cloudName('../../etc/passwd')).toBe('etc-passwd');
  expect(cloudName('…')).toBe('uploaded');
  expect(cloudName(`${'x'.repeat(99)}.ply`).length).toBe(40);
});

describe('back to what the scene began with', () => {
  const setting = (path: string, leastRole: Setting['leastRole']): Setting => ({
    ...{ path, leastRole, kind: 'number', unit: '', help: '', choices: [], onlyType: '' },
    ...{ lowest: 0, highest: 1, usualLowest: 0, usualHighest: 1 },
  });
  const settings = [
    setting('light.to_light', 'controller'),
    setting('medium.extinction', 'controller'),
    setting('simulation.paused', 'controller'),
    setting('render.method', 'operator'),
  ];
  const starts = valuesOf(settings, [[0, 1, 0], 2, 0, 'auto']);
  const now = valuesOf(settings, [[0, 0.6, 0.8], 2, 1, 'sphere']);

  test('goes what differs and the role may change, but not the pause', () => {
    const light = { path: 'light.to_light', value: [0, 1, 0] };
    expect(changesBack(settings, now, starts, 'operator')).toEqual([light, { path: 'render.method', value: 'auto' }]);
    expect(changesBack(settings, now, starts, 'controller')).toEqual([light]);
    expect(changesBack(settings, now, starts, 'viewer')).toEqual([]);
  });

  test('goes nothing where nothing differs, or an older server does not say', () => {
    expect(changesBack(settings, starts, starts, 'operator')).toEqual([]);
    expect(changesBack(settings, now, new Map(), 'operator')).toEqual([]);
  });
});

test('settings are shown for the media that they mean something in', () => {
  const paths = ['medium.extinction', 'medium.falloff', 'medium.union_radius', 'medium.union_extinction'];
  const shown = (medium: string) => paths.filter((path) => !isIdle(path, medium));
  expect(shown('sum')).toEqual(['medium.extinction', 'medium.falloff']);
  expect(shown('union')).toEqual(['medium.union_radius', 'medium.union_extinction']);
  expect(shown('tetrahedra')).toEqual(['medium.extinction']);
  expect(shown('')).toEqual(paths); // servers that do not tell it
});
