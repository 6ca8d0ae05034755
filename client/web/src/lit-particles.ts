// Decodes the head of LitParticles; the columns behind it stay packed (lit-columns.ts).
import { COLUMNS, MOST_PARTICLES } from './lit-columns';
import { ProtocolError } from './protocol';
import type { Hue, LitObject, LitParticles, Vec3 } from './protocol';
import type { LitParticles as WireParticles } from './wire/brume/wire/lit-particles';
import type { Vec3 as WireVec3 } from './wire/brume/wire/vec3';

const MOST_HUES = 3;
const MOST_OBJECTS = 64;
const KINDS = 3; // of objects
const PHASE_NUMBERS = 4;
const ALL_CHANNELS = 7;
const MOST_PACKED = 16 * 1024 * 1024; // bytes: more than the most particles have, unpacked

function finite(...numbers: number[]): void {
  if (!numbers.every(Number.isFinite)) throw new ProtocolError('a number of particles that is none');
}

function toVec3(v: WireVec3 | null): Vec3 {
  if (!v) throw new ProtocolError('a vector of particles is missing');
  const vector = [v.x(), v.y(), v.z()] as const;
  finite(...vector);
  return vector;
}

function huesOf(wire: WireParticles): Hue[] {
  const count = wire.huesLength();
  if (count < 1 || count > MOST_HUES) throw new ProtocolError('particles of no hue, or of too many');
  const hues = Array.from({ length: count }, (_, i) => {
    const hue = wire.hues(i);
    return { channels: hue?.channels() ?? 0, extinction: hue?.extinction() ?? 0 };
  });
  finite(...hues.map(({ extinction }) => extinction));
  const sum = hues.reduce((all, { channels }) => all + channels, 0);
  const union = hues.reduce((all, { channels }) => all | channels, 0);
  if (sum !== ALL_CHANNELS || union !== ALL_CHANNELS) throw new ProtocolError('a channel of no hue, or of two');
  return hues;
}

function objectsOf(wire: WireParticles): LitObject[] {
  const count = wire.objectsLength();
  if (count > MOST_OBJECTS) throw new ProtocolError('too many objects');
  return Array.from({ length: count }, (_, i) => {
    const object = wire.objects(i);
    const [kind, yaw] = [object?.kind() ?? KINDS, object?.yaw() ?? 0];
    if (!object || kind >= KINDS) throw new ProtocolError('an object of no kind');
    finite(yaw);
    return {
      kind,
      centre: toVec3(object.centre()),
      halfSize: toVec3(object.halfSize()),
      yaw,
      albedo: toVec3(object.albedo()),
    };
  });
}

// `tail`: the bytes behind the message.
export function decodeParticles(wire: WireParticles, tail: Uint8Array<ArrayBuffer>): LitParticles {
  const [count, bytes, phase] = [
    wire.count(),
    wire.bytes(),
    Array.from({ length: Math.min(wire.phaseLength(), PHASE_NUMBERS + 1) }, (_, i) => wire.phase(i) ?? NaN),
  ];
  if (count > MOST_PARTICLES) throw new ProtocolError('too many particles');
  if (wire.present() >> BigInt(COLUMNS.count) !== 0n) throw new ProtocolError('columns of particles that are none');
  if (wire.number() === 0) throw new ProtocolError('particles without a number');
  if (bytes !== tail.length || bytes > MOST_PACKED) throw new ProtocolError('bytes of particles do not match');
  if (phase.length !== PHASE_NUMBERS) throw new ProtocolError('a phase function of other numbers');
  const [error, low, high] = [wire.measured(), wire.measuredLow(), wire.measuredHigh()];
  const numbers = {
    step: wire.step(),
    falloff: wire.falloff(),
    meanCosine: wire.meanCosine(),
    haze: wire.haze(),
    exposure: wire.exposure(),
    ageMs: wire.ageMs(),
  };
  finite(...Object.values(numbers), ...phase, wire.predicted(), error, low, high);
  const coldAlbedo = wire.coldAlbedo() ? toVec3(wire.coldAlbedo()) : ([1, 1, 1] as const);
  if (!(Math.min(...coldAlbedo) > 0)) throw new ProtocolError("particles' cold albedo is not above 0");
  return {
    kind: 'lit',
    id: wire.id(),
    tick: wire.tick(),
    stateHash: wire.stateHash(),
    number: wire.number(),
    reference: wire.reference(),
    first: wire.first(),
    count,
    present: Number(wire.present()),
    origin: toVec3(wire.origin()),
    ...numbers,
    toLight: toVec3(wire.toLight()),
    irradiance: toVec3(wire.irradiance()),
    phase,
    ambient: toVec3(wire.ambient()),
    emission: wire.emission() ? toVec3(wire.emission()) : [0, 0, 0],
    coldAlbedo,
    hues: huesOf(wire),
    straight: toVec3(wire.straight()),
    zenith: toVec3(wire.zenith()),
    horizon: toVec3(wire.horizon()),
    filmic: wire.filmic(),
    objects: objectsOf(wire),
    ...(wire.predicted() > 0 ? { predicted: wire.predicted() } : {}),
    ...(error > 0 ? { measured: { error, low, high } } : {}),
    bytes: tail,
  };
}
