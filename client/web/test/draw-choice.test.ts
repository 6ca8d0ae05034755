import { describe, expect, test } from 'vitest';
import { DrawChoice, drawWishOf } from '../src/draw-choice';
import type { DrawWish } from '../src/draw-choice';

const chosen = (wish: DrawWish): DrawChoice => {
  const choice = new DrawChoice();
  choice.choose(wish);
  return choice;
};
const card = (): boolean => true;
const software = (): boolean => false;

// Draws `pictures` that are `apart` ms and take `gpuMs` each. Returns what was given up at, ms, and why.
function draw(
  choice: DrawChoice,
  pictures: number,
  gpuMs: number | undefined,
  apart = 1000 / 60,
): [number, number] | undefined {
  for (let i = 0; i < pictures; ++i) {
    const slow = choice.drew(1000 + i * apart, gpuMs);
    if (slow !== undefined) return [i * apart, slow];
  }
  return undefined;
}

describe('who draws', () => {
  test('is who was chosen; of itself the page where a graphics card draws', () => {
    expect([chosen('client').wants(software), chosen('server').wants(card)]).toEqual([true, false]);
    expect([chosen('auto').wants(card), chosen('auto').wants(software)]).toEqual([true, false]);
    expect(['client', 'server', 'auto', 'x', null].map(drawWishOf)).toEqual([
      'client',
      'server',
      'auto',
      'auto',
      'auto',
    ]);
  });

  test('is the server where the browser cannot, until something else is chosen', () => {
    const choice = chosen('client');
    choice.fail();
    expect(choice.wants(card)).toBe(false);
    choice.choose('client');
    expect(choice.wants(card)).toBe(false);
    choice.choose('auto');
    expect(choice.wants(card)).toBe(true);
  });

  test('is given up of itself after two seconds of more than 8 ms', () => {
    const choice = chosen('auto');
    expect(draw(choice, 600, 7)).toBeUndefined();
    const [at, ms] = draw(chosen('auto'), 600, 12) ?? [0, 0];
    expect([Math.round(at / 100), Math.round(ms)]).toEqual([20, 12]);
    const slow = chosen('auto');
    draw(slow, 600, 12);
    expect(slow.wants(card)).toBe(false);
    slow.choose('client');
    expect(slow.wants(card)).toBe(true);
  });

  test('by the time between pictures, where the card’s own is not known', () => {
    expect(draw(chosen('auto'), 600, undefined, 20)).toBeUndefined();
    expect(draw(chosen('auto'), 600, undefined, 40)).toBeDefined();
  });

  test('not for a moment, after a pause, or where it was chosen', () => {
    const choice = chosen('auto');
    for (let i = 0; i < 600; ++i) expect(choice.drew(i * 16, i % 60 < 10 ? 20 : 4)).toBeUndefined();
    const seldom = chosen('auto');
    for (let i = 0; i < 20; ++i) expect(seldom.drew(i * 1500, undefined)).toBeUndefined();
    expect(draw(chosen('client'), 600, 50)).toBeUndefined();
  });
});
