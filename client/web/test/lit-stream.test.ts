import { afterEach, describe, expect, test, vi } from 'vitest';
import type { Rows } from '../src/lit-columns';
import { LitClock } from '../src/lit-clock';
import { between, momentOf, strideOf } from '../src/lit-moment';
import { LitStream, layerOf } from '../src/lit-stream';
import type { LitParticles } from '../src/protocol';
import { messageOf, rows } from './lit-packer';

afterEach(() => vi.restoreAllMocks());

const ONE = 32 * 1024; // the code of 1
// Particles at x = 10 * id + `moved`, of scale 1.
const line = (first: number, count: number, moved: number): Rows =>
  rows(first, count, { 0: (i) => 10 * (first + i) + moved, 3: () => ONE, 4: () => ONE, 8: () => 255 });

function heard() {
  const taken: LitParticles[] = [];
  const unreadable: unknown[] = [];
  const stream = new LitStream({
    taken: (message) => taken.push(message),
    unreadable: (error) => unreadable.push(error),
  });
  const settle = async (count: number): Promise<void> =>
    vi.waitFor(() => expect(taken.length + unreadable.length).toBe(count), { interval: 1 });
  return { stream, taken, unreadable, settle };
}

const referenceOf = (number: number): number => (layerOf(number) === 3 ? number - 8 : number & (number - 1));
const xs = (
  drawable: { values: Float32Array; count: number; layout: { hues: number; fluences: 0 | 1 | 3 } } | undefined,
): number[] =>
  Array.from({ length: drawable?.count ?? 0 }, (_, i) => drawable?.values[i * strideOf(drawable.layout)] ?? NaN);

describe('a stream of particles', () => {
  test.each([1, 2, 4, 8])('is read by who gets every %i. message', async (every) => {
    const { stream, taken, unreadable, settle } = heard();
    const all = Array.from({ length: 41 }, (_, number) => line(number, 20, number % 7));
    let sent = 0;
    for (let number = every; number <= 40; number += every) {
      const of = referenceOf(number);
      const reference = of > 0 && sent > 0 ? { number: of, rows: all[of] ?? line(0, 0, 0) } : undefined;
      stream.receive(messageOf(all[number] ?? line(0, 0, 0), reference, { number, tick: BigInt(2 * number) }));
      await settle(++sent);
      expect(stream.newest?.values[0]).toBe(10 * number + (number % 7));
    }
    expect(unreadable).toEqual([]);
    expect(taken.map(({ number }) => number)).toEqual(Array.from({ length: 40 / every }, (_, i) => (i + 1) * every));
  });

  test('is broken by a reference that is not held, by what is not packed, and by a flood', async () => {
    for (const message of [
      messageOf(line(0, 2, 1), { number: 4, rows: line(0, 2, 0) }, { number: 5 }),
      { ...messageOf(line(0, 2, 1), undefined, {}), bytes: Uint8Array.of(1, 2, 3) },
      { ...messageOf(line(0, 2, 1), undefined, {}), count: 3 },
    ]) {
      const { stream, unreadable, settle } = heard();
      stream.receive(message);
      await settle(1);
      expect(unreadable.length).toBe(1);
    }
    const { stream, unreadable } = heard();
    for (let i = 0; i < 33; ++i) stream.receive(messageOf(line(0, 2, 1), undefined, { number: i + 1 }));
    expect(unreadable.length).toBe(1);
  });

  test('of an old connection is forgotten', async () => {
    const { stream, taken, settle } = heard();
    stream.receive(messageOf(line(0, 2, 1), undefined, {}));
    stream.clear();
    stream.receive(messageOf(line(0, 3, 1), undefined, { id: 9 }));
    await settle(1);
    expect(taken.map(({ id }) => id)).toEqual([9]);
    expect(stream.newest?.count).toBe(3);
  });

  test('is drawn between its messages, one interval late, and rests at the newest', async () => {
    const { stream, settle } = heard();
    const clock = vi.spyOn(performance, 'now');
    for (let n = 1; n <= 40; ++n) {
      clock.mockReturnValue((n * 1000) / 30);
      stream.receive(messageOf(line(0, 2, n), undefined, { number: n, tick: BigInt(2 * n) }));
      await settle(n);
    }
    const at = (ms: number): number => xs(stream.at((40 * 1000) / 30 + ms))[0] ?? NaN;
    expect(at(0)).toBeCloseTo(39, 3);
    expect(at(1000 / 60)).toBeCloseTo(39.5, 3);
    expect(at(1000 / 30)).toBeCloseTo(40, 3);
    const [rest, later] = [stream.at(9e4), stream.at(9e5)];
    expect(xs(later)).toEqual([40, 50]);
    expect(later?.version).toBe(rest?.version); // nothing to draw anew
  });

  test('goes on after a pause from where it stood', async () => {
    const { stream, settle } = heard();
    const clock = vi.spyOn(performance, 'now');
    const receive = async (n: number, tick: number, moved: number): Promise<void> => {
      clock.mockReturnValue((tick * 1000) / 60);
      stream.receive(messageOf(line(0, 1, moved), undefined, { number: n, tick: BigInt(tick) }));
      clock.mockReturnValue(0);
      await settle(n);
    };
    for (let n = 1; n <= 30; ++n) await receive(n, 2 * n, 0);
    expect(xs(stream.at(1e6))).toEqual([0]);
    await receive(31, 6000, 2);
    expect(xs(stream.at(1e5))).toEqual([0]); // and then within an interval
    const middle = xs(stream.at(1e5 + 40))[0] ?? NaN;
    expect(middle).toBeGreaterThan(0);
    expect(middle).toBeLessThan(2);
  });
});

describe('between two moments', () => {
  const moment = (own: Rows, more: Partial<LitParticles> = {}) => momentOf(messageOf(own, undefined, more), own);
  const mixed = (from: Rows, next: Rows, part: number, origin = 0): number[] => {
    const [a, b] = [moment(from), moment(next, { origin: [origin, 0, 0] })];
    const values = new Float32Array(a.values.length);
    between(a, b, part, values);
    return xs({ ...a, values });
  };

  test('particles of one id are as far on as the time', () => {
    expect(mixed(line(0, 3, 0), line(0, 3, 2), 0.25)).toEqual([0.5, 10.5, 20.5]);
  });

  test('those that are gone stay, and those that are new are not there yet', () => {
    expect(mixed(line(0, 3, 0), line(1, 4, 2), 0.5)).toEqual([0, 11, 21]);
  });

  test('those that went farther than four of their scales stay until then', () => {
    expect(mixed(line(0, 2, 0), line(0, 2, 3.99), 0.5)[0]).toBeCloseTo(1.5); // whole steps
    expect(mixed(line(0, 2, 0), line(0, 2, 5), 0.5)).toEqual([0, 10]);
  });

  test('places are from the origin of the later one', () => {
    expect(mixed(line(0, 2, 3), line(0, 2, 0), 0.5, 3)).toEqual([0, 10]);
  });
});

describe('numbers of a moment', () => {
  test('are what their columns say', () => {
    const own = rows(0, 1, {
      ...{ 0: () => 4, 1: () => 2, 3: () => ONE, 4: () => ONE + 1024, 5: () => 65_535, 8: () => 255, 9: () => 129 },
      ...{ 38: () => ONE - 1024, 39: () => 127, 40: () => 0, 41: () => 129 },
    });
    const { layout, values } = momentOf(messageOf(own, undefined, { step: 0.5 }), own);
    expect(layout).toEqual({ hues: 1, fluences: 1 });
    expect([...values]).toEqual([2, 1, 0, 1, 2, 1, 0, 0, 1, -1, 0, 0, 0, 0, 0, 0, 0, 0, 0.5, 0, -0.5, 0.5]);
    const green = rows(0, 1, { 38: () => ONE, 42: () => ONE });
    expect(momentOf(messageOf(green, undefined, {}), green).layout.fluences).toBe(3);
    const none = rows(0, 1, { 38: () => 0 });
    expect(momentOf(messageOf(none, undefined, {}), none).layout.fluences).toBe(0);
  });
});

describe('the clock', () => {
  // What is drawn at 60 Hz of messages at 30 Hz that come up to `jitter` ms late.
  function drawn(jitter: number): number[] {
    const clock = new LitClock();
    const ticks: number[] = [];
    let random = 1;
    const arrivals = Array.from({ length: 300 }, (_, n) => {
      random = (random * 16_807) % 2_147_483_647;
      return (n * 1000) / 30 + (random / 2_147_483_647) * jitter;
    });
    let next = 0;
    for (let now = 0; now < 9000; now += 1000 / 60) {
      while ((arrivals[next] ?? Infinity) <= now) clock.came(2 * next, arrivals[next++] ?? 0);
      ticks.push(clock.at(now));
    }
    return ticks.slice(200);
  }

  test.each([0, 5, 15])('goes on evenly where messages come up to %i ms late', (jitter) => {
    const steps = drawn(jitter).flatMap((tick, i, all) => (i > 0 ? [tick - (all[i - 1] ?? 0)] : []));
    for (const step of steps) {
      expect(step).toBeGreaterThanOrEqual(0);
      expect(step).toBeLessThan(1.5);
    }
  });

  test('begins anew where ticks do', () => {
    const clock = new LitClock();
    for (let n = 0; n < 20; ++n) clock.came(5000 + 2 * n, n * 33);
    expect(clock.at(660)).toBeGreaterThan(5000);
    clock.came(1, 700);
    expect(clock.at(700)).toBeLessThanOrEqual(1);
  });
});
