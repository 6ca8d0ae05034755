import { describe, expect, test } from 'vitest';
import { AutoLayers } from '../src/auto-layers';
import { Fade } from '../src/fade';
import type { DepthLayers } from '../src/protocol';

const SECOND = 1000;
const some = { count: 4, surface: new Uint8Array() } as DepthLayers;
const none = { count: 0, surface: new Uint8Array() } as DepthLayers;

// A browser whose display has 62 pictures a second.
class Session {
  rate: number | undefined = 60;
  latencyMs = 20;
  drawsLayers = true;
  readonly used: boolean[] = [];
  now = 0;
  readonly layers = new AutoLayers({
    pace: () => ({ rate: this.rate, latencyMs: this.latencyMs }),
    use: (layers) => {
      this.used.push(layers);
      return this.drawsLayers || !layers;
    },
  });

  run(ms: number, came?: DepthLayers[]): void {
    for (const end = this.now + ms; this.now < end; this.now += 16) {
      this.layers.look(this.now);
      if (this.layers.taken) this.layers.came(came, this.now);
    }
  }
}

describe('automatic layers', () => {
  test('are not taken while pictures are many and soon', () => {
    const session = new Session();
    session.run(60 * SECOND);
    session.rate = undefined; // a medium that stands: no pictures are due
    session.run(60 * SECOND);
    expect(session.used).toEqual([]);
  });

  test.each([
    ['few', { rate: 12, latencyMs: 20 }],
    ['late', { rate: 60, latencyMs: 80 }],
  ])('are taken when pictures are %s for three seconds', (_, pace) => {
    const session = new Session();
    Object.assign(session, pace);
    session.run(2 * SECOND);
    expect(session.layers.taken).toBe(false);
    session.run(2 * SECOND);
    expect(session.layers.taken).toBe(true);
    session.run(60 * SECOND, [some]);
    expect(session.used).toEqual([true]);
  });

  test('are not taken for a moment of few', () => {
    const session = new Session();
    for (let i = 0; i < 10; ++i) {
      session.rate = 10;
      session.run(2 * SECOND);
      session.rate = 60;
      session.run(SECOND);
    }
    expect(session.used).toEqual([]);
  });

  test('are asked for once where the browser has no hardware for them', () => {
    const session = new Session();
    [session.rate, session.drawsLayers] = [5, false];
    session.run(60 * SECOND);
    expect(session.layers.taken).toBe(false);
    expect(session.used).toEqual([true]);
  });

  test.each([
    ['none come', undefined],
    ['they are empty', [none]],
  ])('are given up when %s, until another method is rendered with', (_, came) => {
    const session = new Session();
    session.layers.follow('march');
    session.rate = 5;
    session.run(60 * SECOND, came);
    expect(session.used).toEqual([true, false]);
    session.layers.follow('march');
    session.run(10 * SECOND, came);
    expect(session.layers.taken).toBe(false);
    session.layers.follow('slabs');
    session.run(10 * SECOND, [some]);
    expect(session.layers.taken).toBe(true);
  });

  test('begin anew with another scene, and stay over a connection to the same one', () => {
    const session = new Session();
    session.layers.connect('cloud');
    session.rate = 5;
    session.run(5 * SECOND, [some]);
    session.layers.connect('cloud'); // that taking them led to, where two pictures became one
    expect(session.used).toEqual([true]);
    session.layers.connect('plume');
    expect(session.layers.taken).toBe(false);
    session.rate = 60;
    session.run(10 * SECOND);
    expect(session.used).toEqual([true, false]);
  });

  test('outlast a time without pictures, and one picture without them', () => {
    const session = new Session();
    session.rate = 5;
    session.run(5 * SECOND, [some]);
    session.now += 60 * SECOND; // paused
    session.run(SECOND, undefined); // another way is being compiled
    session.run(10 * SECOND, [some]);
    expect(session.used).toEqual([true]);
  });

  test.each([
    ['draws them in time', 60, [true]],
    ['is too slow for them', 25, [true, false]],
  ])('stay only where this machine %s', (_, hertz, used) => {
    const session = new Session();
    session.rate = 5;
    session.run(4 * SECOND, [some]);
    const end = session.now + 20 * SECOND;
    for (; session.now < end; session.now += 1000 / hertz) {
      session.layers.look(session.now);
      session.layers.came([some], session.now);
    }
    expect(session.used).toEqual(used);
  });

  test('are not taken for what was slow before the page was hidden', () => {
    const session = new Session();
    session.rate = 5;
    session.run(SECOND);
    session.now += 60 * SECOND;
    session.run(SECOND);
    session.rate = 60;
    session.run(10 * SECOND);
    expect(session.used).toEqual([]);
  });
});

describe('a new picture', () => {
  test('covers the one before it softly, and one that nothing was before at once', () => {
    const fade = new Fade();
    expect(fade.part(0)).toBe(1);
    fade.begin(false, 1000);
    expect(fade.part(1000)).toBe(1);
    fade.begin(true, 1200);
    expect(fade.part(1200)).toBe(0);
    expect(fade.part(1260)).toBeCloseTo(0.5);
    expect(fade.part(1400)).toBe(1);
  });

  test('is there before the next one comes, and at once where many come', () => {
    const fade = new Fade();
    fade.begin(true, 0);
    fade.begin(true, 80);
    expect(fade.part(120)).toBeCloseTo(0.5);
    expect(fade.part(160)).toBe(1);
    fade.begin(true, 176);
    fade.begin(true, 192);
    expect(fade.part(192)).toBe(1);
  });
});
