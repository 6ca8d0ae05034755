// Columns of LitParticles: what their numbers mean, and how a message packs them. As protocol/lit_particles.h has it,
// which says what each column is.
import { ProtocolError } from './protocol';

export const COLUMNS = { place: 0, scale: 3, extinction: 4, albedo: 5, fit: 8, fluence: 38, count: 50 } as const;
export const FIT_COLUMNS = 10; // of each hue
export const FLUENCE_COLUMNS = 4; // of each channel
export const MOST_PARTICLES = 65_536; // of a message

// Particles first, first + 1 ... first + count - 1.
export interface Rows {
  first: bigint;
  count: number;
  columns: (Uint16Array | undefined)[]; // undefined: all are 0
}

// Bytes of one of a column's numbers.
const bytesOf = (column: number): 1 | 2 => {
  const { fit, fluence } = COLUMNS;
  return column < fit || (column >= fluence && (column - fluence) % FLUENCE_COLUMNS === 0) ? 2 : 1;
};

const isPresent = (present: number, column: number): boolean => Math.floor(present / 2 ** column) % 2 === 1;
const EVERY = Array.from({ length: COLUMNS.count }, (_, column) => column);

// Bytes of columns before they are packed.
export const plainBytes = (present: number, count: number): number =>
  EVERY.reduce((sum, column) => sum + (isPresent(present, column) ? bytesOf(column) * count : 0), 0);

const tableOf = (length: number, of: (code: number) => number): Float32Array =>
  Float32Array.from({ length }, (_, i) => of(i));
const signed = (code: number): number => {
  const part = (code < 128 ? code : code - 256) / 127;
  return part * Math.abs(part);
};
// Numbers of codes.
export const OF_LOG = tableOf(65_536, (code) => (code === 0 ? 0 : 2 ** (code / 1024 - 32)));
export const OF_ROOT = tableOf(256, (code) => (code / 255) ** 2);
export const OF_SIGNED = tableOf(256, signed);

// Small differences, up or down, come as small numbers.
const unfolded = (number: number): number => (number >> 1) ^ (number & 1 ? 0xffff : 0);

// How many ids `to` is after `from`, which are the same modulo 2 ^ 64.
export const rowsFrom = (from: bigint, to: bigint): number => Number(BigInt.asIntN(64, to - from));

// The rows of a message. `plain`: its columns, unpacked. `reference`: the rows that it names; undefined: none.
export function rowsOf(
  { first, count, present }: { first: bigint; count: number; present: number },
  plain: Uint8Array,
  reference: Rows | undefined,
): Rows {
  if (plain.length !== plainBytes(present, count)) throw new ProtocolError('columns of particles of another length');
  const offset = reference ? rowsFrom(reference.first, first) : 0;
  let at = 0;
  const columns = EVERY.map((column) => {
    const there = isPresent(present, column);
    const before = reference?.columns[column];
    if (!there && !before) return undefined;
    const wide = bytesOf(column) === 2;
    const mask = wide ? 0xffff : 0xff;
    const numbers = new Uint16Array(count);
    for (let i = 0; i < count; ++i) {
      let number = 0;
      if (there) number = (plain[at + i] ?? 0) | (wide ? (plain[at + count + i] ?? 0) << 8 : 0);
      numbers[i] = ((before?.[i + offset] ?? 0) + unfolded(number)) & mask;
    }
    if (there) at += bytesOf(column) * count;
    return numbers;
  });
  return { first, count, columns };
}

// What zlib packed, of exactly `size` bytes. No more than those are ever kept.
export async function inflated(bytes: Uint8Array<ArrayBuffer>, size: number): Promise<Uint8Array> {
  const plain = new Uint8Array(size);
  let length = 0;
  const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate')).getReader();
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    if (length + value.length > size) {
      void reader.cancel().catch(() => undefined);
      throw new ProtocolError('particles of more bytes than their columns have');
    }
    plain.set(value, length);
    length += value.length;
  }
  if (length !== size) throw new ProtocolError('particles of fewer bytes than their columns have');
  return plain;
}
