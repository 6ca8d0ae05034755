// A small stand-in for brume-server, for working on the page without one: the same messages, a toy picture.
//   npm run mock -- [--port N] [--web-root DIR] [--max-viewers N]
// GET /mock?goodbye=SECONDS[&go_to=URL]|error=TEXT|version=0|1|standstill=TEXT makes it misbehave on request. The scene
// stands still until the text is empty; commands are refused meanwhile.
import { Builder, ByteBuffer } from 'flatbuffers';
import { readFile } from 'node:fs/promises';
import { createServer } from 'node:http';
import type { AddressInfo } from 'node:net';
import { extname, join, normalize } from 'node:path';
import { WebSocketServer } from 'ws';
import type { WebSocket } from 'ws';
import { Body } from '../src/wire/brume/wire/body';
import { Camera } from '../src/wire/brume/wire/camera';
import { Command } from '../src/wire/brume/wire/command';
import { Error as WireError } from '../src/wire/brume/wire/error';
import { ErrorCode } from '../src/wire/brume/wire/error-code';
import { Frame } from '../src/wire/brume/wire/frame';
import { Goodbye } from '../src/wire/brume/wire/goodbye';
import { Ack } from '../src/wire/brume/wire/ack';
import { Hello } from '../src/wire/brume/wire/hello';
import { Impulse } from '../src/wire/brume/wire/impulse';
import { Input } from '../src/wire/brume/wire/input';
import { Message } from '../src/wire/brume/wire/message';
import { PassTime } from '../src/wire/brume/wire/pass-time';
import { Ping } from '../src/wire/brume/wire/ping';
import { Pong } from '../src/wire/brume/wire/pong';
import { Pose } from '../src/wire/brume/wire/pose';
import { Quat } from '../src/wire/brume/wire/quat';
import { Plan } from '../src/wire/brume/wire/plan';
import { Role } from '../src/wire/brume/wire/role';
import { SceneState } from '../src/wire/brume/wire/scene-state';
import { Set as WireSet } from '../src/wire/brume/wire/set';
import { Setting } from '../src/wire/brume/wire/setting';
import { Value } from '../src/wire/brume/wire/value';
import { Stages } from '../src/wire/brume/wire/stages';
import { Vec3 } from '../src/wire/brume/wire/vec3';
import { Welcome } from '../src/wire/brume/wire/welcome';
import { MockScene, SETTINGS } from './mock-scene';
import type { View } from './mock-scene';

// Options of the real server that are not here are ignored.
function option(name: string, fallback: string): string {
  const at = process.argv.indexOf(`--${name}`);
  return (at >= 0 ? process.argv[at + 1] : undefined) ?? fallback;
}
const port = Number(option('port', '8080'));
const webRoot = option('web-root', 'dist');
const maxViewers = Number(option('max-viewers', '8'));
const sceneName = option('scene', 'mock');

type V3 = [number, number, number];
interface Viewer {
  id: number;
  socket: WebSocket;
  greeted: boolean;
  quality: number;
  pose: { view: View; seq: number; time: bigint; at: number } | undefined;
  frame: number;
  acked: number;
}

let scene = new MockScene();
let version = 1;
let standstill = ''; // why no tick comes; empty: ticks come
let nextId = 1;
const viewers = new Set<Viewer>();

const v3 = (v: Vec3 | null): V3 | undefined => (v ? [v.x(), v.y(), v.z()] : undefined);

function message(type: Body, build: (b: Builder) => number, tail?: Uint8Array): Uint8Array {
  const builder = new Builder(512);
  Message.finishSizePrefixedMessageBuffer(builder, Message.createMessage(builder, type, build(builder)));
  return tail ? Buffer.concat([builder.asUint8Array(), tail]) : builder.asUint8Array();
}

const goodbye = (reason: string, retry: number, goTo = ''): Uint8Array =>
  message(Body.Goodbye, (b) =>
    Goodbye.createGoodbye(b, b.createString(reason), retry, goTo ? b.createString(goTo) : 0),
  );

const error = (code: ErrorCode, text: string, input = 0): Uint8Array =>
  message(Body.Error, (b) => WireError.createError(b, code, b.createString(text), input));

const welcome = (viewer: Viewer): Uint8Array =>
  message(Body.Welcome, (b) => {
    const strings = ['mock 0.1.0', sceneName, 'no device'].map((text) => b.createString(text));
    const settings = Welcome.createSettingsVector(
      b,
      SETTINGS.map(({ path, kind, range, choices }) => {
        const names = (choices ?? []).map((name) => b.createString(name));
        return Setting.createSetting(
          b,
          b.createString(path),
          kind,
          b.createString(''),
          b.createString('Of the stand-in.'),
          Role.controller,
          ...range,
          ...range,
          Setting.createChoicesVector(b, names),
          0,
        );
      }),
    );
    Camera.startCamera(b);
    Camera.addPosition(b, Vec3.createVec3(b, 0, 2, 16));
    Camera.addTarget(b, Vec3.createVec3(b, 0, 0, 0));
    Camera.addFovY(b, 0.8);
    const camera = Camera.endCamera(b);
    Welcome.startWelcome(b);
    Welcome.addViewer(b, viewer.id);
    Welcome.addServer(b, strings[0] ?? 0);
    Welcome.addScene(b, strings[1] ?? 0);
    Welcome.addDevice(b, strings[2] ?? 0);
    Welcome.addTickHz(b, 60);
    Welcome.addMaxInFlight(b, 2);
    Welcome.addViews(b, 1);
    Welcome.addCamera(b, camera);
    Welcome.addSettings(b, settings);
    return Welcome.endWelcome(b);
  });

function packed(b: Builder, value: number | V3 | string): number {
  const text = typeof value === 'string' ? b.createString(value) : 0;
  Value.startValue(b);
  if (typeof value === 'number') Value.addNumber(b, value);
  if (typeof value === 'object') Value.addVector(b, Vec3.createVec3(b, ...value));
  if (text) Value.addText(b, text);
  return Value.endValue(b);
}

const sceneState = (): Uint8Array =>
  message(Body.SceneState, (b) => {
    const passes = SceneState.createPassesVector(
      b,
      (
        [
          ['shadow map', 2.9],
          ['sort', 0.4],
          ['medium', 7.2],
          ['compose', 0.9],
        ] as const
      ).map(([name, ms]) => PassTime.createPassTime(b, b.createString(name), ms)),
    );
    const method = b.createString(String(scene.settings.get('render.method')));
    const plan = Plan.createPlan(b, method, 0, 0, 0, 0.015, 11.4, 0, method, 0.02);
    const values = SceneState.createSettingsVector(
      b,
      SETTINGS.map(({ path }) => packed(b, scene.settings.get(path) ?? 0)),
    );
    const why = standstill ? b.createString(standstill) : 0;
    SceneState.startSceneState(b);
    if (why) SceneState.addStandstill(b, why);
    SceneState.addTick(b, BigInt(scene.tick));
    SceneState.addStateHash(b, scene.hash());
    SceneState.addViewers(b, [...viewers].filter((viewer) => viewer.greeted).length);
    SceneState.addParticles(b, 500);
    SceneState.addSettings(b, values);
    SceneState.addPasses(b, passes);
    SceneState.addPlan(b, plan);
    return SceneState.endSceneState(b);
  });

function command(input: Input): void {
  switch (input.commandType()) {
    case Command.Impulse: {
      const c = input.command(new Impulse()) as Impulse;
      scene.impulse(v3(c.origin()) ?? [0, 0, 0], v3(c.direction()) ?? [0, 0, -1], v3(c.push()), c.strength());
      return;
    }
    case Command.Set: {
      const set = input.command(new WireSet()) as WireSet;
      for (let i = 0; i < set.changesLength(); ++i) {
        const change = set.changes(i);
        const value = v3(change?.vector() ?? null) ?? change?.text() ?? change?.number();
        if (value !== undefined && value !== null) scene.settings.set(change?.path() ?? '', value);
      }
      return;
    }
    case Command.Restart:
      scene = new MockScene();
  }
}

function receive(viewer: Viewer, data: Uint8Array): void {
  const incoming = Message.getSizePrefixedRootAsMessage(new ByteBuffer(data));
  switch (incoming.bodyType()) {
    case Body.Hello: {
      const hello = incoming.body(new Hello()) as Hello;
      viewer.quality = hello.quality() || 80;
      if ([...viewers].filter((other) => other.greeted).length >= maxViewers) {
        viewer.socket.send(error(ErrorCode.full, 'no room for another viewer'));
        viewer.socket.send(goodbye('no room for another viewer', 4));
        viewer.socket.close();
        return;
      }
      viewer.greeted = true;
      viewer.socket.send(welcome(viewer));
      for (const other of viewers) if (other.greeted) other.socket.send(sceneState());
      return;
    }
    case Body.Pose: {
      const pose = incoming.body(new Pose()) as Pose;
      const q = pose.orientation();
      const orientation: View['orientation'] = q ? [q.x(), q.y(), q.z(), q.w()] : [0, 0, 0, 1];
      const [width, height] = [pose.width() || 640, pose.height() || 360];
      const view: View = { position: v3(pose.position()) ?? [0, 0, 0], orientation, fovY: pose.fovY(), width, height };
      viewer.pose = pose.hidden()
        ? undefined
        : { view, seq: pose.seq(), time: pose.clientTimeUs(), at: performance.now() };
      return;
    }
    case Body.Input:
      if (standstill) {
        const input = incoming.body(new Input()) as Input;
        viewer.socket.send(error(ErrorCode.busy, 'too many commands wait for their tick', input.seq()));
        return;
      }
      command(incoming.body(new Input()) as Input);
      for (const other of viewers) if (other.greeted) other.socket.send(sceneState());
      return;
    case Body.Ack:
      viewer.acked = Math.max(viewer.acked, (incoming.body(new Ack()) as Ack).frame());
      return;
    case Body.Ping: {
      const ping = incoming.body(new Ping()) as Ping;
      viewer.socket.send(message(Body.Pong, (b) => Pong.createPong(b, ping.nonce(), ping.timeUs())));
    }
  }
}

function render(viewer: Viewer): void {
  const { pose } = viewer;
  if (!pose || viewer.frame - viewer.acked >= 2) return;
  const begin = performance.now();
  const image = scene.draw(pose.view, viewer.quality);
  const drawn = performance.now() - begin;
  viewer.frame += 1;
  const bytes = message(
    Body.Frame,
    (b) => {
      const sizes = Frame.createJpegBytesVector(b, [image.bytes.length]);
      Frame.startFrame(b);
      Frame.addId(b, viewer.frame);
      Frame.addTick(b, BigInt(scene.tick));
      Frame.addStateHash(b, scene.hash());
      Frame.addPoseSeq(b, pose.seq);
      Frame.addClientTimeUs(b, pose.time);
      Frame.addPosition(b, Vec3.createVec3(b, ...pose.view.position));
      Frame.addOrientation(b, Quat.createQuat(b, ...pose.view.orientation));
      Frame.addFovY(b, pose.view.fovY);
      Frame.addWidth(b, image.width);
      Frame.addHeight(b, image.height);
      Frame.addQuality(b, viewer.quality);
      Frame.addStages(b, Stages.createStages(b, begin - pose.at, drawn * 0.7, drawn * 0.3, 0.05, drawn * 0.6));
      Frame.addJpegBytes(b, sizes);
      Frame.addMeasured(b, 0.012);
      Frame.addMeasuredLow(b, 0.011);
      Frame.addMeasuredHigh(b, 0.0135);
      return Frame.endFrame(b);
    },
    image.bytes,
  );
  viewer.socket.send(bytes);
}

// ---- one port: the page and the socket ----

const TYPES: Record<string, string> = {
  '.html': 'text/html; charset=utf-8',
  '.js': 'text/javascript',
  '.css': 'text/css',
  '.svg': 'image/svg+xml',
};

const http = createServer((request, response) => {
  const url = new URL(request.url ?? '/', 'http://mock');
  if (url.pathname === '/healthz') return void response.end('ok');
  if (url.pathname === '/mock') {
    misbehave(url.searchParams);
    return void response.end('ok');
  }
  const path = normalize(url.pathname === '/' ? '/index.html' : url.pathname);
  readFile(join(webRoot, path)).then(
    (body) => response.setHeader('content-type', TYPES[extname(path)] ?? 'application/octet-stream').end(body),
    () => response.writeHead(404).end('not found'),
  );
});

function misbehave(how: URLSearchParams): void {
  const farewell = how.get('goodbye');
  for (const { socket } of viewers) {
    if (farewell !== null) {
      socket.send(goodbye('the server is being updated', Number(farewell), how.get('go_to') ?? ''));
      socket.close();
    }
    if (how.has('error')) socket.send(error(ErrorCode.out_of_range, how.get('error') ?? ''));
  }
  if (how.has('standstill')) {
    standstill = how.get('standstill') ?? '';
    for (const viewer of viewers) if (viewer.greeted) viewer.socket.send(sceneState());
  }
  if (how.has('version')) {
    version = Number(how.get('version'));
    if (version !== 1) for (const { socket } of viewers) socket.terminate();
  }
}

const sockets = new WebSocketServer({
  noServer: true,
  handleProtocols: (offered) => offered.has('brume.v1') && 'brume.v1',
});
http.on('upgrade', (request, socket, head) => {
  if (version !== 1) return void socket.end('HTTP/1.1 400 Bad Request\r\nConnection: close\r\n\r\n');
  sockets.handleUpgrade(request, socket, head, (client) => {
    const viewer: Viewer = {
      id: nextId++,
      socket: client,
      greeted: false,
      quality: 80,
      pose: undefined,
      frame: 0,
      acked: 0,
    };
    viewers.add(viewer);
    client.on('message', (data) => receive(viewer, new Uint8Array(data as Buffer)));
    client.on('close', () => viewers.delete(viewer));
  });
});

setInterval(() => {
  if (standstill) return;
  scene.step(1 / 60);
  for (const viewer of viewers) if (viewer.greeted) render(viewer);
}, 1000 / 60);
setInterval(() => {
  for (const viewer of viewers) if (viewer.greeted) viewer.socket.send(sceneState());
}, 1000);

http.listen(port, '127.0.0.1', () => {
  console.log(`listening on http://127.0.0.1:${(http.address() as AddressInfo).port}`);
});
process.on('SIGTERM', () => {
  for (const { socket } of viewers) socket.send(goodbye('the server stops', 0));
  setTimeout(() => process.exit(0), 50);
});
