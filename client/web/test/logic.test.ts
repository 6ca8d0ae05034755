import { mayControl, mayOperate, mayPush, roleOf, tokenIn } from '../src/role';
import { describe, expect, test } from 'vitest';
import { Backoff } from '../src/backoff';
import { fromAngles, fromHex, joinIrradiance, splitIrradiance, toAngles, toHex, toLinear, toSrgb } from '../src/colour';
import { LatencyAverage, LatencyWindow, Rate, STAGES, splitLatency } from '../src/latency';
import { errorLine, planText } from '../src/plan';
import type { Command, Vec3 } from '../src/protocol';
import { Pusher } from '../src/pusher';
import { SIZE_CAPS, defaultCap, requestedSize } from '../src/size';

describe('back-off', () => {
  test('doubles from a tenth of a second to one, and starts again', () => {
    const longest = new Backoff(() => 1);
    const waits = Array.from({ length: 7 }, () => longest.next());
    expect(waits).toEqual([0.1, 0.2, 0.4, 0.8, 1, 1, 1]);
    longest.reset();
    expect(longest.next()).toBe(0.1);
  });

  test('jitter takes off up to half', () => {
    expect(new Backoff(() => 0).next()).toBe(0.05);
    expect(new Backoff(() => 0.5).next()).toBeCloseTo(0.075, 9);
  });

  test('tries three times within a second, which a gateway needs to name another server', () => {
    const longest = new Backoff(() => 1);
    expect(longest.next() + longest.next() + longest.next()).toBeLessThan(1);
  });

  test('never comes earlier than the server asked', () => {
    for (const dice of [0, 0.5, 1]) {
      const wait = new Backoff(() => dice).next(20);
      expect(wait).toBeGreaterThanOrEqual(20);
      expect(wait).toBeLessThan(21);
    }
    expect(new Backoff(() => 0).next(1e9)).toBeLessThan(301);
  });
});

describe('the plan in words', () => {
  const plan = { method: 'slabs', text: 'slabs, 32 slabs', error: 0.003141, ms: 12, relaxed: 0 };

  test('says what is used and how wrong it may be', () => {
    expect(planText('auto', plan)).toBe('auto: slabs, 32 slabs, 0.31 %');
    expect(planText('auto', { ...plan, relaxed: 2 })).toMatch(/, relaxed 2$/);
    expect(planText('sphere', { ...plan, method: 'sphere', text: '', error: 0.1234 })).toBe('sphere, 12 %');
    expect(planText('sphere', { ...plan, text: 'sphere', error: 1 })).toBe('sphere, error not predicted');
  });

  test('is silent where the server is', () => {
    expect(planText('auto', undefined)).toBe('');
  });
});

describe('the error of pictures', () => {
  const measured = { error: 0.00421, low: 0.0037, high: 0.00484 };
  const plan = { method: 'slabs', text: '', error: 0.003, ms: 1, relaxed: 0, promised: Math.fround(0.005) };
  const { promised: _, ...silent } = plan;

  test('is what is measured, with its bounds, beside what is promised', () => {
    expect(errorLine(measured, plan)).toEqual({ text: '0.42 % (0.37–0.48), promised 0.5 %', broken: false });
    expect(errorLine(measured, silent)).toEqual({ text: '0.42 % (0.37–0.48)', broken: false });
    expect(errorLine(measured, undefined)?.text).toBe('0.42 % (0.37–0.48)');
  });

  test('is more than promised only when the lower bound says so', () => {
    expect(errorLine(measured, { ...plan, promised: 0.004 })?.broken).toBe(false);
    expect(errorLine(measured, { ...plan, promised: 0.0036 })?.broken).toBe(true);
  });

  test('is predicted until it is measured, or not known', () => {
    expect(errorLine(undefined, plan)?.text).toBe('0.3 % predicted, promised 0.5 %');
    expect(errorLine(undefined, { ...plan, error: 1 })).toBeUndefined();
    expect(errorLine(undefined, undefined)).toBeUndefined();
  });
});

describe('latency', () => {
  const frame = { clientTimeUs: 1_000_000n, stages: { wait: 4, render: 10, encode: 1, queue: 0.5, gpu: 8 } };

  test('its stages add up to input to present', () => {
    const split = splitLatency(frame, { received: 1030, decoded: 1033, presented: 1050 });
    expect(split).toEqual({
      ...{ input: 0, wait: 4, render: 10, encode: 1, queue: 0.5, decode: 3, present: 17 },
      ...{ network: 14.5, total: 50 },
    });
    expect(STAGES.reduce((sum, stage) => sum + split[stage], 0)).toBeCloseTo(split.total, 9);
  });

  test('begins with the input', () => {
    const split = splitLatency(frame, { received: 1030, decoded: 1033, presented: 1050 }, 7);
    expect(split).toMatchObject({ input: 7, network: 14.5, total: 57 });
  });

  test('its percentiles are samples, of the newest only', () => {
    const window = new LatencyWindow(100);
    expect(window.percentile(50)).toBeUndefined();
    const sample = (total: number) => ({
      ...{ input: 0, wait: 0, render: 200 - total, encode: 0, queue: 0, network: 0 },
      ...{ decode: 0, present: 0, total },
    });
    for (let i = 0; i < 50; ++i) window.add(sample(1000)); // forgotten again
    for (let i = 100; i >= 1; --i) window.add(sample(i));
    expect(window.count).toBe(100);
    expect([50, 95, 99, 100].map((percent) => window.percentile(percent)?.total)).toEqual([50, 95, 99, 100]);
    expect(window.percentile(99)?.render).toBe(198); // each stage on its own
    window.reset();
    window.add(sample(3));
    expect([50, 99].map((percent) => window.percentile(percent)?.total)).toEqual([3, 3]);
  });

  test('the network takes no less than nothing', () => {
    const split = splitLatency(frame, { received: 1001, decoded: 1002, presented: 1003 });
    expect(split.network).toBe(0);
  });

  test('the average moves toward its samples', () => {
    const average = new LatencyAverage(0.5);
    expect(average.get()).toBeUndefined();
    const split = splitLatency(frame, { received: 1030, decoded: 1033, presented: 1050 });
    average.add(split);
    average.add({ ...split, total: 100 });
    expect(average.get()?.total).toBe(75);
    expect(split.total).toBe(50); // samples stay as they were
  });

  test('rates count the last second only', () => {
    const rate = new Rate(1000);
    for (let at = 0; at < 3000; at += 20) rate.add(at, 10);
    expect(rate.perSecond(2980)).toBe(500);
    expect(rate.perSecond(3480)).toBe(250);
    expect(rate.perSecond(9000)).toBe(0);
  });
});

describe('picture size', () => {
  const cap = { width: 960, height: 540 };

  test('is the canvas’s own when that is small, in device pixels', () => {
    expect(requestedSize(640, 360, 1, cap)).toEqual({ width: 640, height: 360 });
    expect(requestedSize(320, 180, 2, cap)).toEqual({ width: 640, height: 360 });
  });

  test('keeps the shape, the area within the cap, and both sides even', () => {
    expect(requestedSize(1920, 1080, 2, cap)).toEqual(cap);
    expect(requestedSize(1080, 1920, 1, cap)).toEqual({ width: 540, height: 960 });
    for (const [w, h] of [
      [1711, 953],
      [390, 844],
      [2560, 1080],
    ] as const) {
      const size = requestedSize(w, h, 3, cap);
      expect(size.width % 2).toBe(0);
      expect(size.height % 2).toBe(0);
      expect(size.width / size.height / (w / h)).toBeCloseTo(1, 2);
      expect(size.width * size.height).toBeLessThanOrEqual(cap.width * cap.height * 1.01);
    }
  });

  test('starts smaller on a device that draws in software', () => {
    expect(SIZE_CAPS[defaultCap('NVIDIA GeForce RTX 4070')]).toMatchObject(cap);
    expect(SIZE_CAPS[defaultCap('llvmpipe (LLVM 15.0.6, 256 bits)')]).toMatchObject({ width: 640, height: 360 });
  });

  test('survives a canvas that has no size', () => {
    const size = requestedSize(0, 0, 1, cap);
    expect(size).toEqual({ width: 64, height: 64 });
    for (const { width, height } of SIZE_CAPS) expect((width % 2) + (height % 2)).toBe(0);
  });
});

describe('colour and light', () => {
  test('sRGB and back', () => {
    expect(toSrgb(0)).toBe(0);
    expect(toSrgb(1)).toBeCloseTo(1, 12);
    expect(toSrgb(0.18)).toBeCloseTo(0.4614, 4);
    for (const x of [0.001, 0.04, 0.5, 0.9]) expect(toLinear(toSrgb(x))).toBeCloseTo(x, 12);
    expect(toHex([1, 0, 0.5])).toBe('#ff00bc');
    expect(toHex(fromHex('#12ab9f'))).toBe('#12ab9f');
    expect(toHex(fromHex('nonsense'))).toBe('#ffffff');
  });

  test('irradiance is a colour times an intensity', () => {
    expect(splitIrradiance([10, 5, 2.5])).toEqual({ colour: [1, 0.5, 0.25], intensity: 10 });
    expect(joinIrradiance([1, 0.5, 0.25], 10)).toEqual([10, 5, 2.5]);
    expect(joinIrradiance([0.5, 0.25, 0], 4)).toEqual([4, 2, 0]);
    expect(splitIrradiance([0, 0, 0]).intensity).toBe(0);
    expect(joinIrradiance([0, 0, 0], 4)).toEqual([0, 0, 0]);
  });

  test('angles and back', () => {
    for (const [azimuth, elevation] of [
      [0, 0],
      [42, 53],
      [359, -80],
      [180, 89],
    ] as const) {
      const found = toAngles(fromAngles(azimuth, elevation));
      expect(found.azimuth).toBeCloseTo(azimuth, 9);
      expect(found.elevation).toBeCloseTo(elevation, 9);
    }
    const up = fromAngles(0, 90);
    expect(up[1]).toBe(1);
    expect(Math.hypot(...fromAngles(77, 13))).toBeCloseTo(1, 12);
  });
});

describe('pushing', () => {
  const ray = { origin: [0, 0, 10] as Vec3, direction: [0, 0, -1] as Vec3 };
  function pushed(): { sent: Command[]; pusher: Pusher } {
    const sent: Command[] = [];
    return { sent, pusher: new Pusher((command) => sent.push(command)) };
  }

  test('a drag sends thirty impulses a second at most, with the cursor’s velocity', () => {
    const { sent, pusher } = pushed();
    pusher.begin(0, ray);
    for (let now = 4; now <= 1000; now += 4) {
      pusher.drag(now, ray, [0.02, 0, 0]); // 5 m/s
      pusher.update(now);
    }
    pusher.end(1000);
    expect(sent.length).toBeGreaterThan(24);
    expect(sent.length).toBeLessThanOrEqual(30);
    for (const command of sent) {
      const wanted = { kind: 'impulse', ...ray, push: [expect.closeTo(5, 9), 0, 0], strength: expect.closeTo(0.54, 9) };
      expect(command).toEqual(wanted); // every 36 ms
    }
  });

  test('a slow page pushes as much as a quick one', () => {
    const total = (interval: number): number => {
      const { sent, pusher } = pushed();
      pusher.begin(0, ray);
      for (let now = interval; now <= 1200; now += interval) {
        pusher.drag(now, ray, [interval * 0.005, 0, 0]);
        pusher.update(now);
      }
      return sent.reduce((sum, c) => sum + (c.kind === 'impulse' ? (c.push?.[0] ?? 0) * c.strength : NaN), 0);
    };
    expect(total(120)).toBeCloseTo(total(40), 9);
    expect(total(40)).toBeCloseTo(15 * 6, 9); // 15/s over 6 m
  });

  test('no drag is faster than the server allows', () => {
    const { sent, pusher } = pushed();
    pusher.begin(0, ray);
    pusher.drag(40, ray, [3000, 4000, 0]);
    pusher.update(40);
    const push = [expect.closeTo(36, 9), expect.closeTo(48, 9), 0];
    expect(sent).toEqual([{ kind: 'impulse', ...ray, push, strength: expect.closeTo(0.6, 9) }]);
  });

  test('a click pushes once, away from the ray', () => {
    const { sent, pusher } = pushed();
    pusher.begin(0, ray);
    pusher.update(16);
    pusher.end(80);
    expect(sent).toEqual([{ kind: 'impulse', ...ray, strength: 2.5 }]);
  });

  test('a resting cursor keeps blowing, gently', () => {
    const { sent, pusher } = pushed();
    pusher.begin(0, ray);
    for (let now = 0; now <= 1000; now += 10) pusher.update(now);
    pusher.end(1000);
    expect(sent.length).toBeGreaterThan(10);
    expect(sent.length).toBeLessThanOrEqual(23);
    for (const command of sent) expect(command).toEqual({ kind: 'impulse', ...ray, strength: 0.3 });
  });

  test('nothing is sent before a press, after the end or when cancelled', () => {
    const { sent, pusher } = pushed();
    pusher.update(100);
    pusher.drag(100, ray, [1, 0, 0]);
    pusher.begin(200, ray);
    pusher.cancel();
    pusher.update(900);
    pusher.end(901);
    expect(sent).toEqual([]);
  });
});

describe('token and role', () => {
  test('the token comes from the fragment alone', () => {
    expect(tokenIn('#token=abc.d-e_f')).toBe('abc.d-e_f');
    expect(tokenIn('#a=b&token=x')).toBe('x');
    expect(tokenIn('#token=')).toBe('');
    expect(tokenIn('')).toBeUndefined();
    expect(tokenIn('#elsewhere')).toBeUndefined();
  });

  test('a role allows what it is for, and one that is not known only looks', () => {
    const order = ['viewer', 'pusher', 'controller', 'presenter', 'operator'] as const;
    expect([1, 4, 2, 5, 3].map(roleOf)).toEqual(order);
    expect([0, 6].map(roleOf)).toEqual(['viewer', 'viewer']);
    expect(order.map(mayPush)).toEqual([false, true, true, true, true]);
    expect(order.map(mayControl)).toEqual([false, false, true, true, true]);
    expect(order.map(mayOperate)).toEqual([false, false, false, false, true]);
  });
});
