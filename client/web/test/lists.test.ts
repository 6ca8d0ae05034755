// The lists of the scene: their elements from a report, and what a new one begins with.
import { describe, expect, test } from 'vitest';
import { lookAt } from '../src/camera';
import { beginnings, elementsOf } from '../src/lists';
import type { List, Setting } from '../src/protocol';

const setting = (path: string, kind: Setting['kind'], choices: string[] = []): Setting => ({
  ...{ path, kind, choices, unit: '', help: '', leastRole: 'controller', onlyType: '' },
  ...{ lowest: 0, highest: 1, usualLowest: 0, usualHighest: 1 },
});
const lights: List = {
  name: 'light',
  most: 3,
  settings: [
    setting('light.type', 'text', ['point', 'spot']),
    setting('light.position', 'vector'),
    setting('light.shadows', 'boolean'),
  ],
};

describe('elements', () => {
  test('are read from a report by their settings', () => {
    const [first, second, ...more] = elementsOf(lights, [1, 2, 3, 4, 0, 0, 5, 6, 7, 1]);
    expect(Object.fromEntries(first ?? [])).toEqual({
      ...{ 'light.type': 'spot', 'light.position': [2, 3, 4], 'light.shadows': 0 },
    });
    expect(Object.fromEntries(second ?? [])).toEqual({
      ...{ 'light.type': 'point', 'light.position': [5, 6, 7], 'light.shadows': 1 },
    });
    expect(more).toEqual([]);
  });

  test('of other numbers than whole elements are left out', () => {
    expect(elementsOf(lights, [])).toEqual([]);
    expect(elementsOf(lights, [0, 1, 2, 3, 1, 0])).toHaveLength(1);
    expect(elementsOf({ ...lights, settings: [] }, [1, 2])).toEqual([]);
  });

  test('that are new stand where the camera looks, lights above that', () => {
    const camera = lookAt([0, 0, 8], [0, 0, 0]);
    const [position, ...others] = beginnings(lights, camera);
    expect(position?.path).toBe('light.position');
    expect(position?.value).toEqual([expect.closeTo(0), 2, expect.closeTo(0)]);
    expect(others).toEqual([]); // the list has no other setting that is begun with
    const boxes: List = {
      name: 'box',
      most: 9,
      settings: [setting('box.centre', 'vector'), setting('box.size', 'vector')],
    };
    expect(beginnings(boxes, camera).map(({ value }) => value)).toEqual([
      [expect.closeTo(0), expect.closeTo(0), expect.closeTo(0)],
      [1, 1, 1],
    ]);
  });
});
