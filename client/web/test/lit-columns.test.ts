import { deflateSync } from 'node:zlib';
import { describe, expect, test } from 'vitest';
import { decode } from '../src/decode';
import { COLUMNS, OF_LOG, OF_ROOT, OF_SIGNED, inflated, plainBytes, rowsOf } from '../src/lit-columns';
import type { Rows } from '../src/lit-columns';
import { ProtocolError } from '../src/protocol';
import type { LitParticles } from '../src/protocol';
import { bytesOf } from './examples';
import { SAMPLE, messageOf, pack, rows, wireOf } from './lit-packer';

async function unpacked(own: Rows, reference?: Rows): Promise<Rows> {
  const { present, bytes } = pack(own, reference);
  const head = { first: own.first, count: own.count, present: Number(present) };
  return rowsOf(head, await inflated(bytes, plainBytes(head.present, head.count)), reference);
}

const random = (seed: number, most: number): ((row: number) => number) => {
  let state = seed;
  return () => (state = (state * 16_807) % 2_147_483_647) % most;
};

// Particles with all columns.
const whole = (first: number | bigint, count: number, seed: number): Rows =>
  rows(
    first,
    count,
    Object.fromEntries(
      Array.from({ length: COLUMNS.count }, (_, column) => [
        column,
        random(seed + column + 1, column < 8 || [38, 42, 46].includes(column) ? 65_536 : 256),
      ]),
    ),
  );

describe('columns of particles', () => {
  test('come back as they were packed', async () => {
    const own = whole(7, 300, 1);
    expect(await unpacked(own)).toEqual(own);
    expect(await unpacked(rows(3, 0, {}))).toEqual(rows(3, 0, {}));
  });

  test('as differences to others, of particles that were born and died since', async () => {
    const before = whole(100, 50, 3);
    for (const [first, count] of [
      [100, 50],
      [120, 50], // the first 20 died, 20 were born
      [90, 80], // older ones than the reference has
      [500, 10], // none of them
    ] as const)
      expect(await unpacked(whole(first, count, 9), before), `${first}`).toEqual(whole(first, count, 9));
  });

  test('with ids beyond what a float holds', async () => {
    const start = 2n ** 64n - 10n;
    const before = whole(start, 8, 5);
    expect(await unpacked(whole(start + 3n, 5, 6), before)).toEqual(whole(start + 3n, 5, 6));
  });

  test('that are absent are as before, or 0', async () => {
    const before = rows(0, 3, { 0: (i) => 10 + i, 9: () => 200 });
    const own = rows(1, 3, { 0: (i) => (i < 2 ? 11 + i : 0), 3: (i) => i, 9: (i) => (i < 2 ? 200 : 0) });
    expect(pack(own, before).present).toBe(1n << 3n); // only the scale has changed
    expect(await unpacked(own, before)).toEqual(own);
  });

  test('mean what the server means', () => {
    const log = (x: number): number => Math.round((Math.log2(x) + 32) * 1024);
    for (const x of [2 ** -31, 0.013, 1, 52, 4e9]) expect(Math.abs((OF_LOG[log(x)] ?? 0) / x - 1)).toBeLessThan(3.4e-4);
    expect([OF_LOG[0], OF_ROOT[0], OF_SIGNED[0]]).toEqual([0, 0, 0]);
    expect([OF_ROOT[255], OF_SIGNED[127], OF_SIGNED[129]]).toEqual([1, 1, -1]);
    expect(OF_SIGNED[256 - 64]).toBeCloseTo(-((64 / 127) ** 2), 6);
  });

  test('are refused where their bytes are not exactly theirs', async () => {
    const { present, bytes } = pack(whole(0, 20, 1), undefined);
    const size = plainBytes(Number(present), 20);
    await expect(inflated(bytes, size - 1)).rejects.toThrow(ProtocolError);
    await expect(inflated(bytes, size + 1)).rejects.toThrow(ProtocolError);
    await expect(inflated(bytes.subarray(0, bytes.length - 9), size)).rejects.toThrow();
    await expect(inflated(Uint8Array.of(1, 2, 3), 3)).rejects.toThrow();
    // Few bytes that become many.
    await expect(inflated(Uint8Array.from(deflateSync(Buffer.alloc(1e7))), 100)).rejects.toThrow(ProtocolError);
    expect(() => rowsOf({ first: 0n, count: 20, present: 1 }, new Uint8Array(41), undefined)).toThrow(ProtocolError);
  });
});

describe('messages of particles', () => {
  const sample = messageOf(whole(5, 4, 2), undefined, { number: 3, tick: 12n });
  const box = { kind: 1, centre: [1, 2, 3], halfSize: [1, 1, 2], yaw: 0.5, albedo: [0.5, 0.5, 0.5] } as const;

  test('are read', () => {
    const told = {
      ...sample,
      objects: [box],
      predicted: 0.25,
      hues: [5, 2].map((channels) => ({ channels, extinction: 2 })),
    };
    expect(decode(wireOf(told))).toEqual(told);
  });

  test('as the frozen example', () => {
    expect(decode(bytesOf('lit_particles'))).toMatchObject({
      ...{ kind: 'lit', id: 41, number: 12, reference: 8, count: 500, first: 9_007_199_254_740_993n, filmic: true },
      ...{ present: 8_589_934_849, origin: [1.5, -2.25, 26], step: 0.0078125, haze: 0.015625, ageMs: 2.5 },
      measured: { error: 0.00390625, low: 0.001953125, high: 0.0078125 },
      hues: [
        { channels: 3, extinction: 1 },
        { channels: 4, extinction: 0.5 },
      ],
      objects: [{ kind: 1, yaw: 0.25 }],
    });
  });

  const bad: [what: string, change: Partial<LitParticles>][] = [
    ['too many particles', { count: 65_537 }],
    ['no number', { number: 0 }],
    ['columns that are none', { present: 2 ** 50 }],
    ['a phase function of three numbers', { phase: [0, 0, 0] }],
    ['a phase function of five numbers', { phase: [0, 0, 0, 0, 0] }],
    ['a cold albedo of 0', { coldAlbedo: [1, 0, 1] }],
    ['a phase function that is no number', { phase: [0, NaN, 0, 0] }],
    ['no hue', { hues: [] }],
    ['four hues', { hues: [1, 2, 4, 0].map((channels) => ({ channels, extinction: 1 })) }],
    ['a channel of no hue', { hues: [{ channels: 3, extinction: 1 }] }],
    ['a channel of two hues', { hues: [7, 4].map((channels) => ({ channels, extinction: 1 })) }],
    ['an infinite extinction', { hues: [{ channels: 7, extinction: Infinity }] }],
    ['65 objects', { objects: Array.from({ length: 65 }, () => box) }],
    ['an object of no kind', { objects: [{ ...box, kind: 3 }] }],
    ['an object that is nowhere', { objects: [{ ...box, centre: [0, NaN, 0] }] }],
    ['an object that is turned by no angle', { objects: [{ ...box, yaw: NaN }] }],
    ['a step that is no number', { step: NaN }],
    ['an infinite exposure', { exposure: Infinity }],
    ['a sun from nowhere', { toLight: [NaN, 0, 0] }],
    ['an error that is no number', { predicted: NaN }],
  ];
  test.each(bad)('with %s are refused', (_, change) => {
    expect(() => decode(wireOf({ ...sample, ...change }))).toThrow(ProtocolError);
  });

  test('without a vector, or with other bytes behind them, are refused', () => {
    for (const name of ['origin', 'toLight', 'irradiance', 'ambient', 'straight', 'zenith', 'horizon'])
      expect(() => decode(wireOf(sample, { left: [name] })), name).toThrow(ProtocolError);
    expect(() => decode(wireOf(sample, { bytes: sample.bytes.length + 1 }))).toThrow(ProtocolError);
    expect(() => decode(wireOf(SAMPLE, { bytes: 2 ** 31 }))).toThrow(ProtocolError);
  });
});
