// Where another token comes from, and what is said where none does.
import { afterEach, beforeEach, describe, expect, test, vi } from 'vitest';
import { renewal } from '../src/renewal';

describe('another token', () => {
  let answer: () => Promise<Response>;
  const asked: string[] = [];
  const give = (text: string, status = 200): void => {
    answer = () => Promise.resolve(new Response(text, { status }));
  };
  const signedOut = { refusal: 'login', text: 'Your sign-in has ended: load this page again to sign in.' };
  beforeEach(() => {
    asked.length = 0;
    vi.stubGlobal('location', { href: 'https://host/clouds/?kiosk=1', origin: 'https://host' });
    vi.stubGlobal('fetch', (url: URL, { redirect }: RequestInit) => {
      expect(redirect).toBe('manual');
      asked.push(url.href);
      return answer();
    });
  });
  afterEach(() => vi.unstubAllGlobals());

  test('comes from an address of the page’s own origin', async () => {
    give('eyJl_x-1.q0N3\n');
    expect(await renewal('/token')).toEqual({ token: 'eyJl_x-1.q0N3' });
    expect(await renewal('token')).toEqual({ token: 'eyJl_x-1.q0N3' });
    expect(asked).toEqual(['https://host/token', 'https://host/clouds/token']);
    expect(await renewal(null)).toBeUndefined();
    for (const elsewhere of ['https://evil.example/token', 'http://host/token', '//evil.example/', 'http://['])
      expect(await renewal(elsewhere)).toMatchObject({ refusal: 'token', text: expect.stringContaining('own site') });
    expect(asked.length).toBe(2);
  });

  test('is none where somebody has to sign in again', async () => {
    for (const text of ['', '<!doctype html><title>Log in</title>', `${'a'.repeat(600)}.b`, 'nodot']) {
      give(text);
      expect(await renewal('/token')).toEqual(signedOut);
    }
    give('a.b', 401);
    expect(await renewal('/token')).toEqual(signedOut);
    answer = () => Promise.resolve({ type: 'opaqueredirect', status: 0, ok: false } as Response);
    expect(await renewal('/token')).toEqual(signedOut);
  });

  test('is none where the address fails, and one line says how', async () => {
    const text = async (): Promise<unknown> => {
      const none = await renewal(`/token?${'x'.repeat(1000)}`);
      expect(none).toMatchObject({ refusal: 'token' });
      return none && 'text' in none ? none.text : undefined;
    };
    give('ann is in no group that may look here.\nMore.', 403);
    expect(await text()).toBe('ann is in no group that may look here.');
    give('<html>', 403);
    expect(await text()).toBe('The token has ended, and /token gives no other: it answers 403.');
    give('a.b', 502);
    expect(await text()).toBe('The token has ended, and /token gives no other: it answers 502.');
    answer = () => Promise.reject(new TypeError('offline'));
    expect(await text()).toBe('The token has ended, and /token does not answer.');
  });
});
