// Where another token comes from.
import { afterEach, beforeEach, describe, expect, test, vi } from 'vitest';
import { renewedToken } from '../src/renewal';

describe('another token', () => {
  let answer: () => Promise<Response>;
  const asked: string[] = [];
  beforeEach(() => {
    asked.length = 0;
    vi.stubGlobal('location', { href: 'https://host/clouds/?kiosk=1', origin: 'https://host' });
    vi.stubGlobal('fetch', (url: URL) => {
      asked.push(url.href);
      return answer();
    });
  });
  afterEach(() => vi.unstubAllGlobals());

  test('comes from an address of the page’s own origin', async () => {
    answer = () => Promise.resolve(new Response('eyJl_x-1.q0N3\n'));
    expect(await renewedToken('/token')).toBe('eyJl_x-1.q0N3');
    expect(await renewedToken('token')).toBe('eyJl_x-1.q0N3');
    expect(asked).toEqual(['https://host/token', 'https://host/clouds/token']);
    for (const elsewhere of [null, 'https://evil.example/token', 'http://host/token', '//evil.example/', 'http://['])
      expect(await renewedToken(elsewhere)).toBeUndefined();
    expect(asked.length).toBe(2);
  });

  test('is none where something else is answered', async () => {
    for (const text of ['', '<!doctype html><title>Log in</title>', `${'a'.repeat(600)}.b`, 'nodot']) {
      answer = () => Promise.resolve(new Response(text));
      expect(await renewedToken('/token')).toBeUndefined();
    }
    answer = () => Promise.resolve(new Response('a.b', { status: 403 }));
    expect(await renewedToken('/token')).toBeUndefined();
    answer = () => Promise.reject(new TypeError('a login page of another origin'));
    expect(await renewedToken('/token')).toBeUndefined();
  });
});
