// Decodes messages from the server. One WebSocket message is one size-prefixed FlatBuffer; the JPEG bytes of a
// frame's views, or packed columns of particles, follow it.
import { ByteBuffer } from 'flatbuffers';
import { Body } from './wire/brume/wire/body';
import type { CameraKey as WireKey } from './wire/brume/wire/camera-key';
import type { Elements as WireElements } from './wire/brume/wire/elements';
import { DepthLayers as WireLayers } from './wire/brume/wire/depth-layers';
import { Error as WireError } from './wire/brume/wire/error';
import { Frame as WireFrame } from './wire/brume/wire/frame';
import { Goodbye as WireGoodbye } from './wire/brume/wire/goodbye';
import type { List as WireList } from './wire/brume/wire/list';
import { LitParticles as WireParticles } from './wire/brume/wire/lit-particles';
import { Message } from './wire/brume/wire/message';
import { People as WirePeople } from './wire/brume/wire/people';
import { Ping as WirePing } from './wire/brume/wire/ping';
import { Quat as WireQuat } from './wire/brume/wire/quat';
import type { Plan as WirePlan } from './wire/brume/wire/plan';
import { SettingKind as WireKind } from './wire/brume/wire/setting-kind';
import type { Setting as WireSetting } from './wire/brume/wire/setting';
import type { Value as WireValue } from './wire/brume/wire/value';
import { SceneState as WireSceneState } from './wire/brume/wire/scene-state';
import { Vec3 as WireVec3 } from './wire/brume/wire/vec3';
import { Welcome as WireWelcome } from './wire/brume/wire/welcome';
import { Frustum as WireFrustum } from './wire/brume/wire/frustum';
import { MOST_KEYS } from './camera-keys';
import type { CameraKey } from './camera-keys';
import { decodeParticles } from './lit-particles';
import { decodePeople } from './people-wire';
import { ProtocolError } from './protocol';
import { roleOf } from './role';
import type {
  DepthLayers,
  Frame,
  Frustum,
  List,
  Plan,
  Quat,
  SceneState,
  ServerMessage,
  Vec3,
  Welcome,
} from './protocol';
import type { Setting, SettingKind, SettingValue } from './protocol';

// The longest lists that a message may have; a longer one makes the message invalid.
const MAX_VIEWS = 2;
const MAX_LAYERS = 8; // with depth
const MAX_NAMES = 64;
const MAX_SETTINGS = 200;
const MAX_SCENES = 5000;
const MAX_LISTS = 16;
const MAX_VALUES = 100_000; // of all elements of a list
const MAX_LINE = 300; // characters of a line for people; the rest is cut off

// Throws ProtocolError for anything that is not a message of a brume.v1 server.
export function decode(data: ArrayBuffer): ServerMessage {
  const bytes = new Uint8Array(data);
  if (bytes.length < 12) throw new ProtocolError('message too short');
  const length = new DataView(data).getUint32(0, true);
  if (length < 8 || length > bytes.length - 4) throw new ProtocolError('length prefix beyond the message');
  const tail = bytes.subarray(4 + length);
  const buffer = new ByteBuffer(bytes.subarray(0, 4 + length));
  // The identifier of a size-prefixed buffer stands four bytes later than where __has_identifier looks.
  buffer.setPosition(4);
  if (!Message.bufferHasIdentifier(buffer)) throw new ProtocolError('not a BRM1 message');
  buffer.setPosition(0);
  const message = Message.getSizePrefixedRootAsMessage(buffer);
  const type = message.bodyType();
  if (type !== Body.Frame && type !== Body.LitParticles && tail.length > 0)
    throw new ProtocolError('bytes after the message');
  switch (type) {
    case Body.Welcome:
      return decodeWelcome(message.body(new WireWelcome()) as WireWelcome);
    case Body.SceneState:
      return decodeScene(message.body(new WireSceneState()) as WireSceneState);
    case Body.Frame:
      return decodeFrame(message.body(new WireFrame()) as WireFrame, tail);
    case Body.LitParticles:
      return decodeParticles(message.body(new WireParticles()) as WireParticles, tail);
    case Body.People:
      return decodePeople(message.body(new WirePeople()) as WirePeople);
    case Body.Error: {
      const error = message.body(new WireError()) as WireError;
      return { kind: 'error', code: error.code(), text: error.text() ?? '', inputSeq: error.inputSeq() };
    }
    case Body.Ping:
    case Body.Pong: {
      const ping = message.body(new WirePing()) as WirePing; // the same fields as Pong
      return { kind: type === Body.Ping ? 'ping' : 'pong', nonce: ping.nonce(), timeUs: ping.timeUs() };
    }
    case Body.Goodbye: {
      const goodbye = message.body(new WireGoodbye()) as WireGoodbye;
      const [reason, goTo] = [goodbye.reason() ?? '', goodbye.goTo() ?? ''];
      return { kind: 'goodbye', reason, retryAfterS: goodbye.retryAfterS(), goTo };
    }
    default:
      throw new ProtocolError(`unexpected message type ${type}`);
  }
}

function toVec3(v: WireVec3 | null, fallback?: Vec3): Vec3 {
  if (v) return [v.x(), v.y(), v.z()];
  if (fallback) return fallback;
  throw new ProtocolError('a required vector is missing');
}

function toQuat(q: WireQuat | null): Quat {
  if (!q) throw new ProtocolError('a required orientation is missing');
  return [q.x(), q.y(), q.z(), q.w()];
}

const toFrustum = (f: WireFrustum): Frustum => ({ left: f.left(), right: f.right(), up: f.up(), down: f.down() });

function toList<T>(count: number, limit: number, item: (index: number) => T): T[] {
  if (count > limit) throw new ProtocolError('a list is too long');
  return Array.from({ length: count }, (_, index) => item(index));
}

const KINDS: Record<number, SettingKind> = {
  [WireKind.boolean]: 'boolean',
  [WireKind.whole]: 'whole',
  [WireKind.number]: 'number',
  [WireKind.vector]: 'vector',
  [WireKind.colour]: 'colour',
  [WireKind.direction]: 'direction',
  [WireKind.text]: 'text',
};

function decodeSetting(s: WireSetting | null): Setting {
  if (!s) throw new ProtocolError('a setting that is not there');
  return {
    path: s.path() ?? '',
    kind: KINDS[s.kind()],
    unit: s.unit() ?? '',
    help: s.help() ?? '',
    leastRole: roleOf(s.leastRole()),
    lowest: s.lowest(),
    highest: s.highest(),
    usualLowest: s.usualLowest(),
    usualHighest: s.usualHighest(),
    choices: toList(s.choicesLength(), MAX_NAMES, (i) => s.choices(i)),
    onlyType: s.onlyType() ?? '',
  };
}

function decodeList(list: WireList | null): List {
  if (!list) throw new ProtocolError('a list that is not there');
  const settings = toList(list.settingsLength(), MAX_SETTINGS, (i) => decodeSetting(list.settings(i)));
  return { name: list.name() ?? '', most: list.most(), settings };
}

function decodeValue(v: WireValue | null): SettingValue {
  const vector = v?.vector();
  return vector ? toVec3(vector) : (v?.text() ?? v?.number() ?? 0);
}

function decodeKey(key: WireKey | null): CameraKey {
  if (!key) throw new ProtocolError('a key view that is not there');
  return {
    position: toVec3(key.position()),
    target: toVec3(key.target()),
    fovY: key.fovY(),
    seconds: key.seconds(),
  };
}

function decodeWelcome(w: WireWelcome): Welcome {
  const camera = w.camera();
  if (!camera) throw new ProtocolError('welcome without a camera');
  return {
    kind: 'welcome',
    viewer: w.viewer(),
    server: w.server() ?? '',
    scene: w.scene() ?? '',
    device: w.device() ?? '',
    width: w.width(),
    height: w.height(),
    tickHz: w.tickHz(),
    maxInFlight: w.maxInFlight(),
    camera: { position: toVec3(camera.position()), target: toVec3(camera.target()), fovY: camera.fovY() },
    settings: toList(w.settingsLength(), MAX_SETTINGS, (i) => decodeSetting(w.settings(i))),
    resume: w.resume() ?? '',
    role: roleOf(w.role()),
    starts: toList(w.startsLength(), MAX_SETTINGS, (i) => decodeValue(w.starts(i))),
    scenes: toList(w.scenesLength(), MAX_SCENES, (i) => w.scenes(i)),
    lists: toList(w.listsLength(), MAX_LISTS, (i) => decodeList(w.lists(i))),
    medium: w.medium() ?? '',
    people: w.people(),
    path: toList(w.pathLength(), MOST_KEYS, (i) => decodeKey(w.path(i))),
  };
}

function decodePlan(p: WirePlan): Plan {
  return {
    method: p.method() ?? '',
    text: p.text() ?? '',
    error: p.error(),
    ms: p.ms(),
    relaxed: p.relaxed(),
    ...(p.promised() > 0 ? { promised: p.promised() } : {}),
  };
}

const decodeElements = (list: WireElements | null): number[] =>
  toList(list?.valuesLength() ?? 0, MAX_VALUES, (i) => list?.values(i) ?? 0);

function decodeScene(s: WireSceneState): SceneState {
  const [plan, lo, hi] = [s.plan(), s.lo(), s.hi()];
  const [standstill, preparing, notDrawable, undo] = [s.standstill(), s.preparing(), s.notDrawable(), s.undo()];
  return {
    kind: 'scene',
    tick: s.tick(),
    stateHash: s.stateHash(),
    viewers: s.viewers(),
    particles: s.particles(),
    settings: toList(s.settingsLength(), MAX_SETTINGS, (i) => decodeValue(s.settings(i))),
    passes: toList(s.passesLength(), MAX_NAMES, (i) => {
      const pass = s.passes(i);
      return { name: pass?.name() ?? '', ms: pass?.ms() ?? 0 };
    }),
    ...(lo && hi ? { box: { lo: toVec3(lo), hi: toVec3(hi) } } : {}),
    ...(plan ? { plan: decodePlan(plan) } : {}),
    ...(s.listsLength() > 0 ? { lists: toList(s.listsLength(), MAX_LISTS, (i) => decodeElements(s.lists(i))) } : {}),
    ...(standstill ? { standstill: standstill.slice(0, MAX_LINE) } : {}),
    ...(preparing ? { preparing: preparing.slice(0, MAX_LINE) } : {}),
    ...(notDrawable ? { notDrawable: notDrawable.slice(0, MAX_LINE) } : {}),
    ...(undo ? { undo: undo.slice(0, MAX_LINE) } : {}),
  };
}

function decodeFrame(f: WireFrame, tail: Uint8Array<ArrayBuffer>): Frame {
  const stages = f.stages();
  if (!stages) throw new ProtocolError('frame without stages');
  let begin = 0;
  const take = (bytes: number | null): Uint8Array<ArrayBuffer> => {
    const end = begin + (bytes ?? 0);
    const picture = tail.subarray(begin, end);
    begin = end;
    return picture;
  };
  const jpeg = toList(f.jpegBytesLength(), MAX_VIEWS, (i) => take(f.jpegBytes(i)));
  const layers = toList(f.layersLength(), MAX_VIEWS, (i) => decodeLayers(f.layers(i), take));
  if (jpeg.length === 0 || begin !== tail.length) throw new ProtocolError('picture bytes do not match their lengths');
  const reduced = ([undefined, 'link', 'device'] as const)[f.reduced()];
  return {
    kind: 'frame',
    id: f.id(),
    tick: f.tick(),
    stateHash: f.stateHash(),
    poseSeq: f.poseSeq(),
    clientTimeUs: f.clientTimeUs(),
    position: toVec3(f.position()),
    orientation: toQuat(f.orientation()),
    fovY: f.fovY(),
    frusta: jpeg.map((_, i) => (i === 0 ? f.frustum() : f.rightFrustum())).flatMap((g) => (g ? [toFrustum(g)] : [])),
    width: f.width(),
    height: f.height(),
    quality: f.quality(),
    stages: {
      wait: stages.wait(),
      render: stages.render(),
      encode: stages.encode(),
      queue: stages.queue(),
      gpu: stages.gpu(),
    },
    ...(reduced ? { reduced } : {}),
    ...(f.measured() > 0 ? { measured: { error: f.measured(), low: f.measuredLow(), high: f.measuredHigh() } } : {}),
    jpeg,
    follows: f.follows(),
    ...(layers.length === jpeg.length ? { layers } : {}),
  };
}

function decodeLayers(l: WireLayers | null, take: (bytes: number | null) => Uint8Array<ArrayBuffer>): DepthLayers {
  if (!l || l.bytesLength() !== 3) throw new ProtocolError('layers without their pictures');
  if (l.count() > MAX_LAYERS) throw new ProtocolError('too many layers');
  return {
    count: l.count(),
    columns: l.columns(),
    rows: l.rows(),
    blockRows: l.blockRows(),
    spacing: l.spacing(),
    first: l.first(),
    near: l.near(),
    far: l.far(),
    filmic: l.filmic(),
    nearSurface: l.nearSurface(),
    farSurface: l.farSurface(),
    nearest: l.nearest(),
    colours: take(l.bytes(0)),
    data: take(l.bytes(1)),
    surface: take(l.bytes(2)),
  };
}
