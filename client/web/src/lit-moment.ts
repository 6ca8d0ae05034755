// Moment: the particles of a message as numbers to draw with, and what lies between two of them.
import { COLUMNS, FIT_COLUMNS, FLUENCE_COLUMNS, OF_LOG, OF_ROOT, OF_SIGNED, rowsFrom } from './lit-columns';
import type { Rows } from './lit-columns';
import type { LitParticles } from './protocol';

// What a particle's numbers are, one after the other: place (m, from the message's origin), scale (m), extinction
// (1/m), albedo; of each hue the fit to the sun's light: middle, slope, bend and twist; of each channel with light that
// scattered more than once its net flux and its fluence.
export interface Layout {
  hues: number;
  fluences: 0 | 1 | 3; // 1: of all channels
}
export const HEAD_NUMBERS = 8;
export const strideOf = ({ hues, fluences }: Layout): number =>
  HEAD_NUMBERS + FIT_COLUMNS * hues + FLUENCE_COLUMNS * fluences;

export interface Moment {
  message: LitParticles;
  layout: Layout;
  count: number;
  values: Float32Array; // `count` particles; it may be longer
}

// Of particles that go farther than this between two messages, in their own scales, nobody knows the way.
const LEAP = 4;

const hasAny = (rows: Rows, column: number): boolean => rows.columns[column]?.some((code) => code !== 0) ?? false;

function fluencesOf(rows: Rows): Layout['fluences'] {
  const has = (channel: number): boolean => hasAny(rows, COLUMNS.fluence + channel * FLUENCE_COLUMNS);
  return has(1) || has(2) ? 3 : has(0) ? 1 : 0;
}

// `spare`: memory that may be taken.
export function momentOf(message: LitParticles, rows: Rows, spare?: Float32Array): Moment {
  const layout = { hues: message.hues.length, fluences: fluencesOf(rows) };
  const stride = strideOf(layout);
  const { count } = message;
  const values = spare && spare.length >= count * stride ? spare : new Float32Array(count * stride);
  const write = (at: number, column: number, numberOf: (code: number) => number): void => {
    const codes = rows.columns[column];
    for (let i = 0, to = at; i < count; ++i, to += stride) values[to] = numberOf(codes?.[i] ?? 0);
  };
  const log = (code: number): number => OF_LOG[code] ?? 0;
  const root = (code: number): number => OF_ROOT[code] ?? 0;
  const signed = (code: number): number => OF_SIGNED[code] ?? 0;
  for (let i = 0; i < 3; ++i) {
    write(i, COLUMNS.place + i, (code) => code * message.step);
    write(5 + i, COLUMNS.albedo + i, (code) => code / 65_535);
  }
  write(3, COLUMNS.scale, log);
  write(4, COLUMNS.extinction, log);
  let at = HEAD_NUMBERS;
  for (let hue = 0; hue < layout.hues; ++hue)
    for (let i = 0; i < FIT_COLUMNS; ++i, ++at) write(at, COLUMNS.fit + hue * FIT_COLUMNS + i, i === 0 ? root : signed);
  for (let channel = 0; channel < layout.fluences; ++channel, at += FLUENCE_COLUMNS) {
    const column = COLUMNS.fluence + channel * FLUENCE_COLUMNS;
    write(at + 3, column, log);
    for (let i = 0; i < 3; ++i) {
      write(at + i, column + 1 + i, signed);
      for (let k = at; k < count * stride; k += stride) values[k + i] = (values[k + i] ?? 0) * (values[k + 3] ?? 0);
    }
  }
  return { message, layout, count, values };
}

// Writes the particles of `from` into `to`, `part` of the way to where they are in `next`: from the origin of `next`.
// Those that are gone there, or far away, stay where they are.
export function between(from: Moment, next: Moment, part: number, to: Float32Array): void {
  const stride = strideOf(from.layout);
  const shift = from.message.origin.map((x, i) => x - (next.message.origin[i] ?? 0));
  const [x, y, z] = [shift[0] ?? 0, shift[1] ?? 0, shift[2] ?? 0];
  const [a, b] = [from.values, next.values];
  const offset = rowsFrom(next.message.first, from.message.first) * stride;
  const end = next.count * stride;
  for (let at = 0; at < from.count * stride; at += stride) {
    const other = at + offset;
    for (let i = 0; i < stride; ++i) to[at + i] = a[at + i] ?? 0;
    to[at] = (a[at] ?? 0) + x;
    to[at + 1] = (a[at + 1] ?? 0) + y;
    to[at + 2] = (a[at + 2] ?? 0) + z;
    if (other < 0 || other >= end) continue;
    const across = (b[other] ?? 0) - (to[at] ?? 0);
    const up = (b[other + 1] ?? 0) - (to[at + 1] ?? 0);
    const along = (b[other + 2] ?? 0) - (to[at + 2] ?? 0);
    const reach = LEAP * (a[at + 3] ?? 0);
    if (across * across + up * up + along * along > reach * reach) continue;
    for (let i = 0; i < stride; ++i) to[at + i] = (to[at + i] ?? 0) + part * ((b[other + i] ?? 0) - (to[at + i] ?? 0));
  }
}
