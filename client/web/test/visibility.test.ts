import { afterEach, beforeEach, describe, expect, test, vi } from 'vitest';
import { Visibility, watchSight } from '../src/visibility';

describe('a page that is not seen', () => {
  let told: boolean[] = [];
  const visibility = (): Visibility => {
    const made: Visibility = new Visibility(() => told.push(made.hidden));
    return made;
  };
  beforeEach(() => {
    told = [];
    vi.useFakeTimers();
  });
  afterEach(() => void vi.useRealTimers());

  test('counts as hidden after two seconds, and as seen at once', () => {
    const page = visibility();
    page.update(true);
    vi.advanceTimersByTime(1999);
    expect(page.hidden).toBe(false);
    vi.advanceTimersByTime(1);
    expect(page.hidden).toBe(true);
    page.update(false);
    expect(page.hidden).toBe(false);
    expect(told).toEqual([true, false]);
  });

  test('is not told of when it is seen again sooner', () => {
    const page = visibility();
    page.update(true);
    vi.advanceTimersByTime(1500);
    page.update(false);
    vi.advanceTimersByTime(10_000);
    expect(told).toEqual([]);
  });

  test('is told of once, however often the browser says so', () => {
    const page = visibility();
    page.update(true);
    vi.advanceTimersByTime(5000);
    page.update(true);
    vi.advanceTimersByTime(5000);
    expect(told).toEqual([true]);
  });
});

// Such a page gets no event and no animation frame, and the server closes a viewer that never sends a pose.
test('a page that opens hidden is told of at once', () => {
  vi.stubGlobal('document', Object.assign(new EventTarget(), { hidden: true }));
  vi.stubGlobal(
    'IntersectionObserver',
    class {
      observe(): void {}
      disconnect(): void {}
    },
  );
  const told: boolean[] = [];
  watchSight({} as HTMLElement, new AbortController().signal, (seen) => told.push(seen));
  expect(told).toEqual([false]);
  vi.unstubAllGlobals();
});
