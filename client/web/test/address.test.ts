import { afterEach, describe, expect, test, vi } from 'vitest';
import { beside, keptNames, socketAddress } from '../src/address';
import { takeToken } from '../src/role';

describe('what lies beside a page', () => {
  test('is below the prefix that a proxy gives it, with its last slash or without', () => {
    for (const [page, folder] of [
      ['https://host', 'https://host/'],
      ['https://host/?a=b#c', 'https://host/'],
      ['https://host/embed.html?a', 'https://host/'],
      ['https://host/clouds/brume/', 'https://host/clouds/brume/'],
      ['https://host/clouds/brume?a=b', 'https://host/clouds/brume/'],
      ['https://host/clouds/brume/embed.html', 'https://host/clouds/brume/'],
      ['http://[::1]:8080/r/NAME', 'http://[::1]:8080/r/NAME/'],
      ['https://host/clouds/ws', 'https://host/clouds/'],
    ] as const) {
      expect(beside(page, 'snapshot.jpg?w=64').href).toBe(`${folder}snapshot.jpg?w=64`);
      vi.stubGlobal('location', new URL('https://elsewhere.example/'));
      expect(socketAddress(page, 'a.b')).toBe(`${folder.replace('http', 'ws')}ws?token=a.b`);
    }
    expect(socketAddress('wss://host/any/socket', undefined)).toBe('wss://host/any/socket');
    vi.unstubAllGlobals();
  });

  test('is named beside the page that names it', () => {
    vi.stubGlobal('location', new URL('https://host/pages/one.html'));
    expect(socketAddress('/clouds/brume', undefined)).toBe('wss://host/clouds/brume/ws');
    expect(socketAddress('brume/', undefined)).toBe('wss://host/pages/brume/ws');
    vi.unstubAllGlobals();
  });
});

describe('what a tab keeps', () => {
  afterEach(() => vi.unstubAllGlobals());

  test('has a name for each folder', () => {
    expect(keptNames('a', '/')).toEqual(['a']);
    expect(keptNames('a', '/embed.html')).toEqual(['a']);
    expect(keptNames('a', '/r/one/')).toEqual(['a /r/one/', 'a /r/', 'a']);
    expect(keptNames('a', '/r/one/embed.html')).toEqual(['a /r/one/', 'a /r/', 'a']);
  });

  test('is the token of a page, and of those below it; servers beside it keep their own', () => {
    const kept = new Map<string, string>();
    vi.stubGlobal('sessionStorage', {
      getItem: (name: string) => kept.get(name) ?? null,
      setItem: (name: string, value: string) => kept.set(name, value),
    });
    vi.stubGlobal('history', { state: null, replaceState: () => undefined });
    const at = (address: string): string | undefined => {
      vi.stubGlobal('location', new URL(address));
      return takeToken();
    };
    expect(at('https://host/clouds/one/#token=first')).toBe('first');
    expect(at('https://host/clouds/two/')).toBeUndefined();
    expect(at('https://host/clouds/two/#token=second')).toBe('second');
    expect(at('https://host/clouds/one/')).toBe('first');
    expect(at('https://host/clouds/one/r/NAME/')).toBe('first');
    expect(at('https://host/clouds/one/#token=')).toBeUndefined();
    expect(at('https://host/clouds/one/')).toBeUndefined();
  });
});
