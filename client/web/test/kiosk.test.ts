// A page that stands alone: what its address asks for, its line, and when it is loaded again.
import { afterEach, beforeEach, describe, expect, test, vi } from 'vitest';
import { awayText, kioskOf } from '../src/kiosk';
import { filesIn, isOther, loadIfOther, reloadWait } from '../src/kiosk-version';

const asked = (query: string) => kioskOf(new URLSearchParams(query));

describe('the address', () => {
  test('without kiosk=1 there is none', () => {
    for (const query of ['', 'idle=9', 'kiosk=0']) expect(asked(query)).toBeUndefined();
  });

  test('a drag pushes, and seconds are the usual ones', () => {
    expect(asked('kiosk=1')).toEqual({
      attributes: { controls: 'touch', idle: '20', turn: '120', home: '120' },
      faults: [],
    });
    expect(asked('kiosk=1&controls=push&idle=5')?.attributes).toMatchObject({ controls: 'push', idle: '5' });
  });

  test('what cannot be used is told, and the rest holds', () => {
    const wrong = asked('kiosk=yes&controls=all&idle=0.1&turn=60');
    expect(wrong?.attributes).toEqual({ controls: 'touch', idle: '20', turn: '60', home: '120' });
    expect(wrong?.faults).toHaveLength(3);
  });
});

test('one line says that the server is away, and why it refuses', () => {
  expect(awayText({ name: 'reconnecting', text: 'x', retryAt: 1 })).toMatch(/^The server is away/);
  const refused = { name: 'refused', refusal: 'token', retryAt: 1 } as const;
  expect(awayText({ ...refused, text: 'the token has ended' })).toBe('The token has ended.');
  expect(awayText({ ...refused, text: '' })).not.toBe('');
});

const page = (name: string): string =>
  `<!doctype html><link rel="icon" href="./icon.svg" /><script type="module" src="./assets/index-${name}.js"></script>
   <link rel="stylesheet" href="./assets/index-x.css"><brume-view id="view"></brume-view>`;

describe('another version', () => {
  const own = filesIn(page('a'));
  const store = new Map<string, string>();
  let answer: (path: string) => { ok: boolean; text: string };
  let loads = 0;
  let now = 1e12;
  const look = () => loadIfOther(own, () => ++loads);

  beforeEach(() => {
    loads = 0;
    store.clear();
    answer = (path) => ({ ok: true, text: path === '/' ? page('b') : '' });
    vi.stubGlobal('location', { href: 'http://h/?kiosk=1', pathname: '/' });
    vi.stubGlobal('sessionStorage', {
      getItem: (name: string) => store.get(name) ?? null,
      setItem: (name: string, text: string) => store.set(name, text),
      removeItem: (name: string) => store.delete(name),
    });
    vi.stubGlobal('fetch', (address: URL) => {
      const { ok, text } = answer(address.pathname);
      return Promise.resolve({ ok, text: () => Promise.resolve(text), arrayBuffer: () => Promise.resolve() });
    });
    vi.spyOn(Date, 'now').mockImplementation(() => now);
  });
  afterEach(() => {
    vi.unstubAllGlobals();
    vi.restoreAllMocks();
  });

  test('is one with other files, in any order, and never what is no page of ours', () => {
    expect(own).toEqual(['./assets/index-a.js', './assets/index-x.css']);
    expect(isOther([...own].reverse(), page('a'))).toBe(false);
    expect(isOther(own, page('b'))).toBe(true);
    for (const markup of ['', '502 Bad Gateway', '<h1>Hotel login</h1><script src="a.js"></script>'])
      expect(isOther(own, markup)).toBe(false);
  });

  test('is loaded once, and then ever more seldom while that does not help', async () => {
    await look();
    await look();
    expect(loads).toBe(1);
    const begin = now;
    for (; now < begin + 86_400_000; now += 10_000) await look(); // a day
    expect(loads).toBeGreaterThan(20);
    expect(loads).toBeLessThan(32);
    answer = () => ({ ok: true, text: page('a') });
    await look(); // it has helped
    answer = (path) => ({ ok: true, text: path === '/' ? page('c') : '' });
    const before = loads;
    await look();
    expect(loads).toBe(before + 1);
  });

  test('is not loaded while a file of it is missing, or nobody answers', async () => {
    answer = (path) => ({ ok: path === '/', text: page('b') });
    await look();
    answer = () => {
      throw new Error('nobody');
    };
    await look();
    expect(loads).toBe(0);
  });

  test('is never loaded by a browser that cannot remember it', async () => {
    vi.stubGlobal('sessionStorage', {
      getItem: () => null,
      setItem: () => {
        throw new Error('full');
      },
    });
    await look();
    expect(loads).toBe(0);
  });

  test('a clock that is set back does not hold it up for years', () => {
    expect(reloadWait({ count: 3, at: 2e12 }, 1e12)).toBe(0);
    expect(reloadWait({ count: 1, at: 1e12 }, 1e12 + 1000)).toBe(59_000);
    expect(reloadWait({ count: 99, at: 1e12 }, 1e12)).toBe(3_600_000);
  });
});
