import { Builder } from 'flatbuffers';
import { afterEach, beforeEach, describe, expect, test, vi } from 'vitest';
import { Connection } from '../src/connection';
import type { LinkEvents } from '../src/connection';
import type { Renewal } from '../src/renewal';
import { Body } from '../src/wire/brume/wire/body';
import { Goodbye } from '../src/wire/brume/wire/goodbye';
import { Message } from '../src/wire/brume/wire/message';

let sockets: FakeSocket[] = [];

class FakeSocket {
  static readonly OPEN = 1;
  readyState = 1;
  bufferedAmount = 0;
  closed = false;
  onopen = (): void => undefined;
  onclose = (): void => undefined;
  onmessage = (_: unknown): void => undefined;
  constructor(readonly url = '') {
    sockets.push(this);
  }
  send(): void {}
  close(): void {
    this.closed = true;
  }
}

function goodbye(goTo: string): ArrayBuffer {
  const b = new Builder(64);
  const body = Goodbye.createGoodbye(b, b.createString('updated'), 0, b.createString(goTo));
  Message.finishSizePrefixedMessageBuffer(b, Message.createMessage(b, Body.Goodbye, body));
  return b.asUint8Array().slice().buffer as ArrayBuffer;
}

describe('a connection', () => {
  const told: string[] = [];
  let lastText = '';
  let ending: AbortController;
  const connect = (renew?: LinkEvents['renew']): Connection => {
    const hello = () => ({ client: 'test', width: 64, height: 64, quality: 0 });
    const connection = new Connection(
      'ws://server.example/ws',
      {
        hello,
        state: (state) => {
          told.push(state.name);
          if (state.name === 'refused') lastText = state.text;
        },
        message: () => undefined,
        roundTrip: () => undefined,
        moved: (page) => told.push(page),
        ...(renew ? { renew } : {}),
      },
      ending.signal,
    );
    connection.start();
    return connection;
  };
  const open = (): FakeSocket[] => sockets.filter(({ closed }) => !closed);

  beforeEach(() => {
    sockets = [];
    told.length = 0;
    ending = new AbortController();
    vi.useFakeTimers();
    const { setTimeout, clearTimeout, setInterval, clearInterval } = globalThis;
    vi.stubGlobal('window', Object.assign(new EventTarget(), { setTimeout, clearTimeout, setInterval, clearInterval }));
    vi.stubGlobal('document', Object.assign(new EventTarget(), { hidden: false }));
    vi.stubGlobal('WebSocket', FakeSocket);
  });
  afterEach(() => {
    ending.abort();
    vi.useRealTimers();
    vi.restoreAllMocks();
    vi.unstubAllGlobals();
  });

  test('that died while nobody looked and no timer ran is made anew at the first look', () => {
    connect();
    const night = performance.now() + 8 * 3600_000;
    vi.spyOn(performance, 'now').mockReturnValue(night);
    document.dispatchEvent(new Event('visibilitychange'));
    expect(sockets.length).toBe(2);
    expect(open()).toEqual([sockets[1]]);
    expect(told).toEqual(['connecting', 'reconnecting', 'reconnecting']);
  });

  test('whose token has ended goes on with another one at once, and waits before it asks for a third', async () => {
    vi.stubGlobal('fetch', () => Promise.resolve(new Response('the token has expired', { status: 401 })));
    let [asked, given] = [0, 'second.token'];
    connect(() => {
      asked += 1;
      return Promise.resolve({ token: given });
    });
    sockets[0]?.onclose();
    await vi.advanceTimersByTimeAsync(0);
    expect(sockets.at(-1)?.url).toBe('ws://server.example/ws?token=second.token');
    expect(told).toEqual(['connecting']);
    given = 'third.token'; // the second is as bad
    sockets.at(-1)?.onclose();
    await vi.advanceTimersByTimeAsync(0);
    expect([asked, told.at(-1), lastText]).toEqual([1, 'refused', 'the token has expired']);
    // It may have ended while the server was away: a minute later another is asked for.
    for (let s = 0; sockets.length < 3 && s < 60; ++s) await vi.advanceTimersByTimeAsync(1000);
    sockets.at(-1)?.onclose();
    await vi.advanceTimersByTimeAsync(0);
    expect([asked, sockets.at(-1)?.url]).toEqual([2, 'ws://server.example/ws?token=third.token']);
  });

  test('says why there is no other token, asks again, and is not disturbed by a try that began meanwhile', async () => {
    vi.stubGlobal('fetch', () => Promise.resolve(new Response('the token has expired', { status: 401 })));
    let answer: (renewal: Renewal) => void = () => undefined;
    const connection = connect(() => new Promise((resolve) => (answer = resolve)));
    sockets[0]?.onclose();
    await vi.advanceTimersByTimeAsync(0);
    answer({ refusal: 'login', text: 'signed out' });
    await vi.advanceTimersByTimeAsync(0);
    expect([told.at(-1), lastText, sockets.length]).toEqual(['refused', 'signed out', 1]);
    // Somebody may have signed in in another tab.
    for (let s = 0; sockets.length < 2 && s < 60; ++s) await vi.advanceTimersByTimeAsync(1000);
    expect(sockets.length).toBe(2);
    sockets[1]?.onclose();
    await vi.advanceTimersByTimeAsync(0);
    connection.retryNow();
    await vi.advanceTimersByTimeAsync(0);
    expect(sockets.length).toBe(3);
    answer({ refusal: 'login', text: 'late' });
    await vi.advanceTimersByTimeAsync(0);
    expect([lastText, open().at(-1) === sockets[2]]).toEqual(['signed out', true]);
  });

  test('that nobody answers is asked for all night, once a second, and made once somebody does', async () => {
    let [asked, there] = [0, false];
    vi.stubGlobal('fetch', () => {
      asked += 1;
      return there ? Promise.resolve(new Response('', { status: 426 })) : Promise.reject(new Error('nobody is there'));
    });
    connect();
    sockets[0]?.onclose();
    await vi.advanceTimersByTimeAsync(0);
    asked = 0;
    await vi.advanceTimersByTimeAsync(1000_000);
    expect(asked).toBeGreaterThan(999);
    expect(asked).toBeLessThan(2010);
    expect(sockets.length).toBe(1); // Firefox would hold back those that come after many
    there = true;
    await vi.advanceTimersByTimeAsync(1000);
    expect(sockets.length).toBe(2);
    expect(vi.getTimerCount()).toBe(1); // its clock
  });

  // A proxy with its bare defaults: the socket fails, and a plain request reaches a server that wants an upgrade.
  const behindProxy = (refused: string | undefined): void => {
    vi.stubGlobal('location', new URL('http://server.example/'));
    vi.stubGlobal('fetch', (address: string, { method }: RequestInit) => {
      if (address.endsWith('healthz')) return Promise.resolve(new Response('ok\n'));
      if (method === 'OPTIONS' && refused)
        return Promise.resolve(new Response('', { status: 403, headers: { 'Brume-Refused': refused } }));
      if (method === 'OPTIONS') return Promise.resolve(new Response(null, { status: 204 }));
      return Promise.resolve(new Response('this is a WebSocket: subprotocol brume.v1\n', { status: 426 }));
    });
  };
  const declinedUntilRefused = async (): Promise<number> => {
    for (let tries = 1; ; ++tries) {
      sockets.at(-1)?.onclose();
      if (sockets.at(-1)) (sockets.at(-1) as FakeSocket).closed = true;
      await vi.advanceTimersByTimeAsync(1000);
      if (told.at(-1) === 'refused' || tries === 20) return tries;
    }
  };

  test('behind a proxy without WebSockets is refused soon, and is not tried for ever', async () => {
    behindProxy(undefined);
    connect();
    expect(await declinedUntilRefused()).toBeLessThan(6);
    expect(lastText).toBe('The proxy in front of this server does not pass WebSockets on: see docs/deploy.md.');
    for (let more = 0; more < 2; ++more) {
      await vi.advanceTimersByTimeAsync(7000);
      sockets.at(-1)?.onclose();
    }
    await vi.advanceTimersByTimeAsync(0);
    const tries = sockets.length;
    await vi.advanceTimersByTimeAsync(3600_000);
    expect(sockets.length).toBe(tries);
    document.dispatchEvent(new Event('visibilitychange')); // somebody looks: one more try
    expect(sockets.length).toBe(tries + 1);
    sockets.at(-1)?.onclose();
    await vi.advanceTimersByTimeAsync(3600_000);
    expect(told.at(-1)).toBe('refused');
    expect(sockets.length).toBe(tries + 1);
    expect(vi.getTimerCount()).toBe(0);
  });

  test('behind a proxy that names another host says so at once', async () => {
    behindProxy('origin');
    connect();
    expect(await declinedUntilRefused()).toBe(1);
    expect(lastText).toMatch(/does not pass the Host header \(nor, perhaps, WebSockets\) on: see docs/);
    await vi.advanceTimersByTimeAsync(3600_000);
    expect(sockets.length).toBe(1);
  });

  test('that looks for the next server asks again at every look, and is one connection after that', async () => {
    vi.stubGlobal('fetch', () => new Promise((done) => setTimeout(() => done(new Response('ok')), 500)));
    connect();
    const [first] = sockets;
    first?.onopen();
    first?.onmessage({ data: goodbye('http://next.example/') });
    first?.onclose();
    await vi.advanceTimersByTimeAsync(150); // it asks there
    document.dispatchEvent(new Event('visibilitychange'));
    await vi.advanceTimersByTimeAsync(11_000); // nobody followed
    expect(told.includes('http://next.example/')).toBe(true);
    expect(open().length).toBe(1);
    expect(vi.getTimerCount()).toBe(1);
  });
});
