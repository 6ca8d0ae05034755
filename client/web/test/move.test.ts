import { describe, expect, test } from 'vitest';
import { MAX_DISTANCE, MAX_PITCH, lookAt, zoom } from '../src/camera';
import { tokenIn } from '../src/role';
import { addressAt, cameraIn, pageOf } from '../src/move';

describe('where a goodbye sends', () => {
  test('is the page, or the page beside the socket', () => {
    const here = 'http://old.example/';
    expect(pageOf('https://next.example/show/?a=b#c', here)).toBe('https://next.example/show/?a=b#c');
    expect(pageOf('http://next.example:81', here)).toBe('http://next.example:81/');
    expect(pageOf('wss://next.example/show/ws', here)).toBe('https://next.example/show/');
    expect(pageOf('ws://[::1]:81', here)).toBe('http://[::1]:81/');
    expect(pageOf('wss://next.example/clouds/brume/ws', here)).toBe('https://next.example/clouds/brume/');
    expect(pageOf('https://next.example/clouds/brume?a', here)).toBe('https://next.example/clouds/brume/?a');
  });

  test('is nothing but the web, and never without TLS from where there is', () => {
    for (const bad of ['', 'next', 'javascript:alert(1)', 'data:text/html,x', 'file:///etc', 'ftp://next.example']) {
      expect(pageOf(bad, 'http://old.example/'), bad).toBeUndefined();
    }
    for (const plain of ['http://next.example/', 'ws://next.example/ws']) {
      expect(pageOf(plain, 'https://old.example/'), plain).toBeUndefined();
    }
    expect(pageOf('wss://next.example/ws', 'https://old.example/')).toBe('https://next.example/');
  });
});

describe('the address there', () => {
  const camera = { ...lookAt([1.25, -2, 26.123456789], [0, 0.1, 0]), yaw: 0.3 };

  test('has this page’s wishes, token and camera', () => {
    const address = new URL(addressAt('https://next.example/show/?room=2&eyes=one', '?eyes=side', 'a.b-c_d', camera));
    expect(address.origin + address.pathname).toBe('https://next.example/show/');
    expect(Object.fromEntries(address.searchParams)).toEqual({ room: '2', eyes: 'side' });
    expect(tokenIn(address.hash)).toBe('a.b-c_d');
    expect(cameraIn(address.hash)).toEqual(zoom(camera, 1));
    expect(tokenIn(new URL(addressAt('http://next.example/', '', undefined, camera)).hash)).toBeUndefined();
  });

  test('gives no camera that cannot be', () => {
    for (const bad of [
      '',
      '#at=',
      '#at=1,2,3',
      '#at=1,2,3,4,5,x',
      '#at=1,2,3,0,0,NaN',
      '#at=1,2,3,0,0,Infinity',
      '#at=1,2,3,0,0,1,1',
    ]) {
      expect(cameraIn(bad), bad).toBeUndefined();
    }
    const wild = cameraIn('#at=1e300,0,0,0,9,1e300');
    expect(wild?.pitch).toBe(MAX_PITCH);
    expect(wild?.distance).toBe(MAX_DISTANCE);
    expect(Math.abs(wild?.position[0] ?? NaN)).toBeLessThan(60_000);
  });
});
