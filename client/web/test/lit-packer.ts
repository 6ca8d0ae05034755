// Packs particles as a server does, written a second time, and makes their messages.
import { Builder } from 'flatbuffers';
import { deflateSync } from 'node:zlib';
import { COLUMNS } from '../src/lit-columns';
import type { Rows } from '../src/lit-columns';
import type { LitParticles } from '../src/protocol';
import { Body } from '../src/wire/brume/wire/body';
import { Hue } from '../src/wire/brume/wire/hue';
import { LitParticles as Wire } from '../src/wire/brume/wire/lit-particles';
import { Message } from '../src/wire/brume/wire/message';
import { Object_ } from '../src/wire/brume/wire/object';
import { Vec3 } from '../src/wire/brume/wire/vec3';

// Places, scale, extinction, albedo, and of each channel the fluence, have two bytes.
const WIDE = [...Array.from({ length: 8 }, (_, i) => i), 38, 42, 46];

// Rows of these columns; others are absent.
export function rows(
  first: number | bigint,
  count: number,
  numbers: { [column: number]: (row: number) => number },
): Rows {
  const columns: Rows['columns'] = Array.from({ length: COLUMNS.count });
  for (const [column, of] of Object.entries(numbers))
    columns[Number(column)] = Uint16Array.from({ length: count }, (_, i) => of(i));
  return { first: BigInt(first), count, columns };
}

// As `at`, counted by id: 0 for a particle that is not there.
const numberAt = (all: Rows | undefined, column: number, id: bigint): number =>
  all && id >= all.first && id < all.first + BigInt(all.count)
    ? (all.columns[column]?.[Number(id - all.first)] ?? 0)
    : 0;

export function pack(own: Rows, reference: Rows | undefined): { present: bigint; bytes: Uint8Array<ArrayBuffer> } {
  const plain: number[] = [];
  let present = 0n;
  for (let column = 0; column < COLUMNS.count; ++column) {
    const modulus = WIDE.includes(column) ? 65_536 : 256;
    const folded = Array.from({ length: own.count }, (_, i) => {
      const id = own.first + BigInt(i);
      let apart = numberAt(own, column, id) - numberAt(reference, column, id);
      if (apart >= modulus / 2) apart -= modulus;
      if (apart < -modulus / 2) apart += modulus;
      return apart >= 0 ? 2 * apart : -2 * apart - 1;
    });
    if (folded.every((x) => x === 0)) continue;
    present |= 1n << BigInt(column);
    plain.push(...folded.map((x) => x % 256));
    if (modulus > 256) plain.push(...folded.map((x) => Math.floor(x / 256)));
  }
  return { present, bytes: Uint8Array.from(deflateSync(Uint8Array.from(plain), { level: 1 })) };
}

export const SAMPLE: LitParticles = {
  ...{ kind: 'lit', id: 1, tick: 0n, stateHash: 0n, number: 1, reference: 0, first: 0n, count: 0, present: 0 },
  ...{ origin: [0, 0, 0], step: 1, falloff: 1.5, toLight: [0, 1, 0], irradiance: [1, 1, 1], phase: [0, 0, 0, 0] },
  ...{ ambient: [0, 0, 0], emission: [0, 0, 0], coldAlbedo: [1, 1, 1] },
  ...{ hues: [{ channels: 7, extinction: 1 }], straight: [1, 1, 1], meanCosine: 0 },
  ...{ zenith: [0, 0, 1], horizon: [1, 1, 1], haze: 0, exposure: 1, filmic: false, objects: [], ageMs: 0 },
  bytes: new Uint8Array(0),
};

// A message with these rows.
export function messageOf(
  own: Rows,
  reference: { number: number; rows: Rows } | undefined,
  more: Partial<LitParticles>,
): LitParticles {
  const { present, bytes } = pack(own, reference?.rows);
  const head = { first: own.first, count: own.count, present: Number(present), reference: reference?.number ?? 0 };
  return { ...SAMPLE, ...head, bytes, ...more };
}

// Bytes of a message with these fields. `left`: names of required ones that are left out.
export function wireOf(
  m: LitParticles,
  { left = [], bytes = m.bytes.length }: { left?: string[]; bytes?: number } = {},
): ArrayBuffer {
  const b = new Builder(512);
  Wire.startHuesVector(b, m.hues.length);
  for (const { channels, extinction } of [...m.hues].reverse()) Hue.createHue(b, channels, extinction);
  const hues = b.endVector();
  Wire.startObjectsVector(b, m.objects.length);
  for (const o of [...m.objects].reverse())
    Object_.createObject(b, o.kind, ...o.centre, ...o.halfSize, o.yaw, ...o.albedo);
  const objects = b.endVector();
  const phase = Wire.createPhaseVector(b, [...m.phase]);
  Wire.startLitParticles(b);
  Wire.addId(b, m.id);
  Wire.addTick(b, m.tick);
  Wire.addNumber(b, m.number);
  Wire.addReference(b, m.reference);
  Wire.addFirst(b, m.first);
  Wire.addCount(b, m.count);
  Wire.addPresent(b, BigInt(m.present));
  Wire.addStep(b, m.step);
  Wire.addFalloff(b, m.falloff);
  Wire.addPhase(b, phase);
  Wire.addHues(b, hues);
  Wire.addObjects(b, objects);
  Wire.addExposure(b, m.exposure);
  Wire.addHaze(b, m.haze);
  const vectors = {
    ...{ origin: Wire.addOrigin, toLight: Wire.addToLight, irradiance: Wire.addIrradiance, ambient: Wire.addAmbient },
    ...{ straight: Wire.addStraight, zenith: Wire.addZenith, horizon: Wire.addHorizon },
    ...{ emission: Wire.addEmission, coldAlbedo: Wire.addColdAlbedo },
  };
  for (const [name, add] of Object.entries(vectors))
    if (!left.includes(name)) add(b, Vec3.createVec3(b, ...m[name as keyof typeof vectors]));
  Wire.addMeasured(b, m.measured?.error ?? 0);
  Wire.addPredicted(b, m.predicted ?? 0);
  Wire.addBytes(b, bytes);
  const end = b.endObject(); // endLitParticles() would miss what is left out
  Message.finishSizePrefixedMessageBuffer(b, Message.createMessage(b, Body.LitParticles, end));
  return Uint8Array.from([...b.asUint8Array(), ...m.bytes]).buffer;
}
