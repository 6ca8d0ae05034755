import { afterEach, beforeEach, describe, expect, test, vi } from 'vitest';
import { Announcer } from '../src/announce';

describe('a line that screen readers hear', () => {
  let told: string[] = [];
  let line: Announcer;
  beforeEach(() => {
    vi.useFakeTimers();
    vi.stubGlobal('window', globalThis);
    told = [];
    line = new Announcer((text) => told.push(text));
  });
  afterEach(() => {
    vi.useRealTimers();
    vi.unstubAllGlobals();
  });

  test('is told at once, then no oftener than each five seconds, and the newest then', () => {
    line.say('Connecting');
    line.say('Connected');
    line.say('Live');
    expect(told).toEqual(['Connecting']);
    vi.advanceTimersByTime(4999);
    expect(told).toEqual(['Connecting']);
    vi.advanceTimersByTime(1);
    expect(told).toEqual(['Connecting', 'Live']);
  });

  test('is not told again for other numbers, nor when it is back as it was', () => {
    line.say('3.2 pictures/s: the server is busy');
    vi.advanceTimersByTime(10_000);
    line.say('4.1 pictures/s: the server is busy');
    expect(told.length).toBe(1);
    line.say('Live');
    line.say('Accuracy reduced: the server is busy');
    line.say('Live');
    vi.advanceTimersByTime(10_000);
    expect(told).toEqual(['3.2 pictures/s: the server is busy', 'Live']);
  });
});
