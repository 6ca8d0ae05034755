// SharedMedium: a server's medium in another renderer's scene. It connects, receives lit particles, and draws them in
// that renderer's own WebGL 2 context, with its colours and depths. three-example.ts shows how.
import { socketAddress } from './address';
import { Connection } from './connection';
import sky from './glsl/sky.glsl?glsl';
import sceneFragment from './glsl/scene.frag.glsl?glsl';
import { LitMedium } from './lit-medium';
import { Program, Targets } from './lit-program';
import { WHOLE, source } from './lit-shaders';
import { LitStream } from './lit-stream';
import type { Area } from './program';
import { fromProjection, rotate } from './projection';
import type { View } from './projection';
import type { LitParticles, Quat, Welcome } from './protocol';

const DRAW_HZ = 30; // messages a second to ask for
const POSE_MS = 200; // between poses, which tell the server that somebody looks, and where

// 4x4 matrices, columns first: clip from view, as WebGL has it, and world from view, without scale. Metres, +Y up.
export interface SharedCamera {
  projection: ArrayLike<number>;
  world: ArrayLike<number>;
}

// What the renderer has drawn, of the target's size. `colour`: linear light times alpha. `depth`: its depth buffer;
// reversed or logarithmic depth is not read.
export interface SharedScene {
  colour: WebGLTexture;
  depth: WebGLTexture;
}

export class SharedMedium {
  visible = true;
  error: string | undefined; // why nothing comes
  readonly welcome: Promise<Welcome>; // the server's first: scene, camera, settings
  private readonly link: Connection;
  private readonly stream: LitStream;
  private readonly medium: LitMedium;
  private readonly program: Program;
  private readonly targets: Targets;
  private readonly ending = new AbortController();
  private posedAt = -Infinity;

  // `address`: of the server's page or socket. Throws an Error if the context cannot.
  constructor(
    private readonly gl: WebGL2RenderingContext,
    address: string,
    token?: string,
  ) {
    this.medium = new LitMedium(gl);
    this.targets = new Targets(gl);
    this.program = new Program(gl, source({}, [WHOLE], [sky, sceneFragment]));
    this.stream = new LitStream({
      taken: (message) => this.link.acknowledge(message.id),
      unreadable: (error) => this.link.unreadable(error),
    });
    let welcomed: (welcome: Welcome) => void;
    this.welcome = new Promise((resolve) => (welcomed = resolve));
    const { drawingBufferWidth: width, drawingBufferHeight: height } = gl;
    this.link = new Connection(
      socketAddress(address, token),
      {
        hello: () => ({ client: 'brume-shared-medium', width, height, quality: 0, drawHz: DRAW_HZ }),
        state: (state) => {
          this.error = 'text' in state ? state.text : undefined;
          if (state.name !== 'connected') return;
          this.stream.clear();
          this.posedAt = -Infinity;
          welcomed(state.welcome);
        },
        message: (message) => {
          if (message.kind === 'lit') this.stream.receive(message);
          // A server that cannot send this scene's particles sends pictures, which nobody shows here.
          if (message.kind === 'frame') this.link.acknowledge(message.id);
          if (message.kind === 'error') this.error = message.text;
        },
        roundTrip: () => {},
        moved: () => {}, // it stays with its address, and connects there again after a while
      },
      this.ending.signal,
    );
    this.link.start();
  }

  // The newest numbers of sun and sky (toLight, irradiance, zenith, horizon), for the renderer's own lights. Undefined
  // until particles came.
  get light(): LitParticles | undefined {
    return this.stream.newest?.message;
  }

  // Draws `scene` with the medium in front of each of its pixels into `to`, as brume's page shows it: with exposure, in
  // sRGB. Returns false if nothing came yet; then nothing is drawn. It changes the context's state: a renderer that
  // remembers it must forget (Three.js: renderer.resetState()).
  draw(camera: SharedCamera, scene: SharedScene, to: Area): boolean {
    const view = viewOf(camera);
    this.look(view, to);
    const moment = this.stream.at(performance.now());
    if (!moment) return false;
    this.medium.take(this.visible ? moment : { ...moment, count: 0, version: -moment.version });
    const { gl } = this;
    for (const test of [gl.BLEND, gl.CULL_FACE, gl.DEPTH_TEST, gl.SCISSOR_TEST, gl.STENCIL_TEST]) gl.disable(test);
    gl.colorMask(true, true, true, true);
    gl.bindVertexArray(null);
    this.medium.draw(view, to, false, this.taken(camera, view, scene, moment.message, to));
    return true;
  }

  // The scene as LitMedium takes it: light and distance.
  private taken(
    { projection }: SharedCamera,
    { orientation, frustum }: View,
    { colour, depth }: SharedScene,
    { zenith, horizon }: LitParticles,
    { width, height }: Area,
  ): WebGLTexture {
    const { gl } = this;
    const { left, right, up, down } = frustum;
    // A half float ends at 65504 m, which is as good as infinitely far.
    const format = gl.getExtension('EXT_color_buffer_float') ? gl.RGBA32F : gl.RGBA16F;
    const target = this.targets.of('scene', format, width, height);
    this.targets.into(target);
    this.program
      .use()
      .set({ zenith, horizon, sides: [-left, -down, left + right, up + down] })
      .set({ projection: [projection[10] ?? -1, projection[14] ?? 0] })
      .set({ right: rotate(orientation, [1, 0, 0]), up: rotate(orientation, [0, 1, 0]) })
      .set({ ahead: rotate(orientation, [0, 0, -1]) })
      .textures({ colours: { texture: colour, layers: 0 }, depths: { texture: depth, layers: 0 } });
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    return target.texture;
  }

  private look({ position, orientation, frustum }: View, { width, height }: Area): void {
    const now = performance.now();
    if (now - this.posedAt < POSE_MS) return;
    const fovY = Math.atan(frustum.up) + Math.atan(frustum.down);
    if (this.link.sendPose({ position, orientation, fovY, width, height })) this.posedAt = now;
  }

  // Says goodbye and frees what is on the graphics card.
  dispose(): void {
    this.ending.abort();
    this.link.stop();
    this.stream.clear();
    this.medium.dispose();
    this.program.dispose();
    this.targets.dispose();
  }
}

function viewOf({ projection, world }: SharedCamera): View {
  const m = (row: number, column: number): number => world[4 * column + row] ?? 0;
  // Of the four forms of a quaternion the one whose own number is largest is exact.
  const [x, y, z] = [m(0, 0), m(1, 1), m(2, 2)];
  const forms: Quat[] = [
    [1 + x - y - z, m(1, 0) + m(0, 1), m(0, 2) + m(2, 0), m(2, 1) - m(1, 2)],
    [m(1, 0) + m(0, 1), 1 - x + y - z, m(2, 1) + m(1, 2), m(0, 2) - m(2, 0)],
    [m(0, 2) + m(2, 0), m(2, 1) + m(1, 2), 1 - x - y + z, m(1, 0) - m(0, 1)],
    [m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1), 1 + x + y + z],
  ];
  const best = forms.reduce((a, b) => (Math.hypot(...b) > Math.hypot(...a) ? b : a));
  const size = Math.hypot(...best) || 1;
  return {
    position: [m(0, 3), m(1, 3), m(2, 3)],
    orientation: [best[0] / size, best[1] / size, best[2] / size, best[3] / size],
    frustum: fromProjection(projection),
  };
}
