import { describe, expect, test } from 'vitest';
import { lookAt, orbit } from '../src/camera';
import { linkTo } from '../src/link';
import { cameraFrom, cameraText } from '../src/move';
import { placeOf, placeText, placed } from '../src/place';
import { followAddress, settingsText } from '../src/settings';
import type { Settings } from '../src/settings';

const own = { position: [0, 2, 26] as const, target: [0, 0, 0] as const };
const of = (query: string) => {
  const fields = new URLSearchParams(query);
  return placeOf((name) => fields.get(name));
};
const placeIn = (query: string) => of(query).place;
const faultsIn = (query: string) => of(query).faults.join(' ');

describe('a place in an address', () => {
  test('is what it says, and the scene’s own for what it leaves out', () => {
    expect(of('')).toEqual({ place: {}, faults: [] });
    expect(placeIn('position=1,-2.5,3e1&target=0,0,0&fov=0.5')).toEqual({
      position: [1, -2.5, 30],
      target: [0, 0, 0],
      fov: 0.5,
    });
    expect(placed({}, own)).toEqual(lookAt(own.position, own.target));
    expect(placed({ position: [5, 0, 0] }, own)).toEqual(lookAt([5, 0, 0], own.target));
    expect(placed({ target: [5, 0, 0] }, own)).toEqual(lookAt(own.position, [5, 0, 0]));
  });

  test('that cannot be used is told in one line with what is allowed', () => {
    for (const bad of ['1,2', '1,2,3,4', '', '1,,3', 'a,b,c', 'NaN,0,0', '1,2,50001', 'Infinity,0,0']) {
      expect(faultsIn(`position=${bad}`), bad).toMatch(/^position takes three numbers from −50,000 to 50,000/);
      expect(faultsIn(`target=${bad}`), bad).toMatch(/^target takes three numbers/);
    }
    for (const bad of ['', '0', '0.04', '3.1', 'wide'])
      expect(faultsIn(`fov=${bad}`), bad).toMatch(/^fov takes .* radians/);
    expect(faultsIn('position=1,2,3&target=1,2,3.0005')).toMatch(/same place/);
    expect(placeIn('position=1,2,3&target=1,2,3.0005&fov=1')).toEqual({ fov: 1 });
    expect(faultsIn('position=1,2,3&target=1,2,3.002')).toBe('');
    expect(of('position=1,2,3&target=x&fov=9').place).toEqual({ position: [1, 2, 3] });
    expect(of('position=1,2,3&target=x&fov=9').faults.length).toBe(2);
  });

  test('shows the view that it was made of', () => {
    const camera = orbit(lookAt([3, 7, 26.5], [0.5, 1, -2]), 1.234, -0.4);
    const read = placeIn(
      placeText(camera, 0.8)
        .map((one) => one.join('='))
        .join('&'),
    );
    const again = placed(read, own);
    for (const key of ['yaw', 'pitch', 'distance'] as const) expect(again[key]).toBeCloseTo(camera[key], 3);
    again.position.forEach((x, i) => expect(x).toBeCloseTo(camera.position[i] ?? NaN, 3));
    expect(read.fov).toBe(0.8);
  });
});

describe('a link', () => {
  const settings: Settings = {
    ...{ cap: 3, quality: 90, stats: true, panel: true },
    ...{ eyes: 'side', reprojection: 'plane', draw: 'client', predict: true, box: true, view: 'depth' },
  };
  const plain: Settings = {
    ...{ cap: undefined, quality: 0, stats: false, panel: false },
    ...{ eyes: 'one', reprojection: 'auto', draw: 'auto', predict: false, box: false, view: 'picture' },
  };

  test('has the view and what is the viewer’s own, and no token', () => {
    const page = 'https://clouds.example/show/?eyes=one&old=1#token=secret';
    expect(linkTo(page, lookAt([0, 2, 26], [0, 0, 0]), 0.8, settingsText(settings))).toBe(
      'https://clouds.example/show/?position=0,2,26&target=0,0,0&fov=0.8' +
        '&eyes=side&reproject=plane&draw=client&predict=1&box=1&size=1280x720&quality=90&view=depth',
    );
    expect(settingsText(plain)).toEqual([]);
  });

  test('gives these settings to who opens it', () => {
    const read = { ...plain };
    const query = settingsText(settings)
      .map((one) => one.join('='))
      .join('&');
    expect(followAddress(read, `?${query}`)).toEqual([]);
    expect(read).toEqual({ ...settings, stats: false, panel: false });
  });

  test('with a bad setting changes nothing, and says what there is', () => {
    for (const bad of [
      'eyes=three',
      'reproject=',
      'draw=here',
      'predict=yes',
      'box=on',
      'size=1x1',
      'quality=101',
      'quality=-1',
      'view=x',
    ]) {
      const read = { ...plain };
      expect(followAddress(read, `?${bad}`).join(' '), bad).toContain(`${bad.split('=')[0]} in the address is`);
      expect(read, bad).toEqual(plain);
    }
    expect(followAddress({ ...plain }, '?eyes=three&size=1x1&view=x').length).toBe(3);
  });
});

test('a camera survives as text to the last bit', () => {
  const camera = orbit(lookAt([1.1, 2.2, 3.3], [0, 0.1, 0]), 0.777, 0.1);
  expect(cameraFrom(cameraText(camera))).toEqual(camera);
});
