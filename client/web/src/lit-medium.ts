// LitMedium draws the medium from particles that bring their light with them, with WebGL 2. Rays are traced on a grid
// that is as coarse as the particles allow. Each particle adds to the rays that it covers: first where their medium is,
// then its optical depth and light in eight slabs there. Sums need no order. A pixel's light comes from the rays
// around it.
import { add, scale, subtract } from './camera';
import { extentOf, lightSpaceOf, rateOf } from './lit-extent';
import type { Extent, LightSpace } from './lit-extent';
import { HEAD_NUMBERS, strideOf } from './lit-moment';
import type { Moment } from './lit-moment';
import { Program, Targets } from './lit-program';
import type { Target } from './lit-program';
import {
  MARGIN,
  SLABS,
  composeSource,
  placesSource,
  rangeSource,
  raysSource,
  shadowSource,
  slabsSource,
  splineSource,
  surfacesSource,
} from './lit-shaders';
import type { Source } from './lit-shaders';
import type { Area } from './program';
import { rotate } from './projection';
import type { View } from './projection';
import type { LitParticles, Vec3 } from './protocol';

const NEAR = 0.05; // m, view depth in front of which nothing is drawn
const SHADOW_TEXELS = 256; // of the map of the medium's shadow, a side
const SHADOW_PLANES = 4;
const FLOAT = 4; // bytes
const FLUENCE_AT = 11; // location of its first attribute

// What was drawn: particles in view, rays of the grid, pixels.
export interface Drawn {
  proxies: number;
  rays: number;
  pixels: number;
}

// A grid of rays over a picture, and how the particles are placed on it.
interface Grid {
  width: number;
  height: number;
  rate: number;
  uniforms: Record<string, readonly number[]>;
}

export class LitMedium {
  drawn: Drawn = { proxies: 0, rays: 0, pixels: 0 }; // last
  private readonly programs = new Map<string, Program>();
  private readonly targets: Targets;
  private readonly buffer: WebGLBuffer;
  private readonly vertices: WebGLVertexArrayObject;
  private readonly objects: WebGLTexture;
  private readonly summed: GLenum; // format of sums
  private readonly kept: GLenum; // of all else
  private atOnce: number; // slabs that are drawn at once
  private moment: (Moment & { version: number }) | undefined;
  private extent: Extent | undefined;
  private light: LightSpace | undefined;
  private shadowed = false; // true: the map of the shadow is of `moment`
  private rate = 1;

  // Throws an Error that says in one line what the context lacks.
  constructor(private readonly gl: WebGL2RenderingContext) {
    const whole = gl.getExtension('EXT_color_buffer_float') !== null;
    if (!whole && !gl.getExtension('EXT_color_buffer_half_float'))
      throw new Error('this browser’s WebGL 2 draws no numbers with fractions');
    // Sums of half floats are less exact.
    this.summed = whole && gl.getExtension('EXT_float_blend') ? gl.RGBA32F : gl.RGBA16F;
    this.kept = whole ? gl.RGBA32F : gl.RGBA16F;
    const most = Math.min(
      Number(gl.getParameter(gl.MAX_DRAW_BUFFERS)),
      Number(gl.getParameter(gl.MAX_COLOR_ATTACHMENTS)),
    );
    this.atOnce = most >= SLABS ? SLABS : SLABS / 2;
    this.targets = new Targets(gl);
    this.buffer = gl.createBuffer();
    this.vertices = gl.createVertexArray();
    this.objects = gl.createTexture();
  }

  // What is drawn from now on.
  take(moment: Moment & { version: number }): void {
    if (this.moment?.version === moment.version) return;
    const { gl } = this;
    const stride = strideOf(moment.layout);
    gl.bindVertexArray(this.vertices);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, moment.values, gl.DYNAMIC_DRAW, 0, moment.count * stride);
    if (moment.layout.hues !== this.moment?.layout.hues || moment.layout.fluences !== this.moment.layout.fluences)
      this.placeAttributes(moment);
    gl.bindVertexArray(null);
    if (moment.message !== this.moment?.message) this.takeObjects(moment.message);
    this.moment = moment;
    this.extent = extentOf(moment);
    this.shadowed = false;
  }

  // Draws what is taken as `view` sees it. `linear`: into two targets, light and transmittance of the medium alone.
  // `scene`: a picture of `to`'s size that is behind and within the medium, in place of the server's sky and objects.
  // It has linear light, and as alpha the distance from the eye along the ray, m. Only the medium before that is drawn.
  draw(view: View, to: Area, linear = false, scene?: WebGLTexture): void {
    const { gl, moment, extent } = this;
    if (!moment || !extent) return;
    const { message } = moment;
    const eye = subtract(view.position, message.origin);
    const grid = this.gridOf(moment, extent, eye, view, to);
    const behind = scene !== undefined || (message.objects.length > 0 && !linear);
    gl.disable(gl.BLEND);
    gl.disable(gl.DEPTH_TEST);
    gl.disable(gl.SCISSOR_TEST);
    const places = this.drawSlabs(moment, grid);
    const rays = this.drawRays(message, grid, behind);
    const own = raysOf(view, to.width, to.height, 1, 0);
    const common = { ...skyOf(message), ...grid.uniforms, factor: factorsOf(message) };
    const surfaces = scene
      ? { texture: scene, layers: 0 }
      : behind && this.drawSurfaces(moment, eye, { ...common, ...own }, to);
    gl.bindFramebuffer(gl.FRAMEBUFFER, to.framebuffer);
    gl.viewport(to.x, to.y, to.width, to.height);
    this.program(`compose ${behind} ${linear}`, () => composeSource(behind, linear))
      .use()
      .set({ ...common, own_corner: own['corner'] ?? [], own_across: own['across'] ?? [], own_rise: own['rise'] ?? [] })
      .set({ offset: [to.x, to.y], exposure: message.exposure })
      .setWhole({ rate: grid.rate, filmic: Number(message.filmic) })
      .textures({ rays, ...(surfaces ? { surfaces, places } : {}) });
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.bindVertexArray(null);
  }

  dispose(): void {
    const { gl } = this;
    for (const program of this.programs.values()) program.dispose();
    this.programs.clear();
    this.targets.dispose();
    gl.deleteBuffer(this.buffer);
    gl.deleteVertexArray(this.vertices);
    gl.deleteTexture(this.objects);
    this.moment = undefined;
  }

  private program(name: string, source: () => Source): Program {
    const known = this.programs.get(name);
    if (known) return known;
    const made = new Program(this.gl, source());
    this.programs.set(name, made);
    return made;
  }

  private placeAttributes({ layout }: Moment): void {
    const { gl } = this;
    const stride = strideOf(layout);
    let offset = 0;
    const place = (location: number, numbers: number): void => {
      gl.enableVertexAttribArray(location);
      gl.vertexAttribPointer(location, numbers, gl.FLOAT, false, stride * FLOAT, offset * FLOAT);
      gl.vertexAttribDivisor(location, 1);
      offset += numbers;
    };
    for (let location = 0; location <= FLUENCE_AT + 2; ++location) gl.disableVertexAttribArray(location);
    let location = 0;
    for (; offset < HEAD_NUMBERS; ++location) place(location, 4);
    for (let hue = 0; hue < layout.hues; ++hue) for (const numbers of [4, 3, 3]) place(location++, numbers);
    for (let channel = 0; channel < layout.fluences; ++channel) place(FLUENCE_AT + channel, 4);
  }

  // Three texels of each object.
  private takeObjects({ objects, origin }: LitParticles): void {
    const { gl } = this;
    const texels = objects.flatMap(({ kind, centre, halfSize, yaw, albedo }) => [
      ...[kind, ...subtract(centre, origin)],
      ...[...halfSize, Math.cos(yaw)],
      ...[...albedo, Math.sin(yaw)],
    ]);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.objects);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
      gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
    if (objects.length > 0)
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, 3, objects.length, 0, gl.RGBA, gl.FLOAT, Float32Array.from(texels));
  }

  private gridOf(moment: Moment, extent: Extent, eye: Vec3, view: View, { width, height }: Area): Grid {
    const { message } = moment;
    const { rate, proxies } = rateOf(moment, eye, view, width, height, this.rate);
    this.rate = rate;
    const { left, right, up, down } = view.frustum;
    const [across, along] = [width, height].map((pixels) => Math.floor((pixels - 1) / rate) + 2 + 2 * MARGIN);
    const [columns, rows] = [across ?? 1, along ?? 1];
    const clip = (pixels: number, tangents: number, before: number, nodes: number): [number, number] => [
      (2 * pixels) / (tangents * rate * nodes),
      (2 * (((before / tangents) * pixels - 0.5) / rate + 0.5 + MARGIN)) / nodes - 1,
    ];
    const [x, y] = [clip(width, left + right, left, columns), clip(height, up + down, down, rows)];
    this.drawn = { proxies, rays: columns * rows, pixels: width * height };
    return {
      width: columns,
      height: rows,
      rate,
      uniforms: {
        ...raysOf(view, width, height, rate, MARGIN),
        ...{ eye, right: rotate(view.orientation, [1, 0, 0]), up: rotate(view.orientation, [0, 1, 0]) },
        ...{ ahead: rotate(view.orientation, [0, 0, -1]), frame: [x[0], y[0], x[1], y[1]] },
        ...{ near: [NEAR], falloff: [message.falloff], thickest: [Math.max(...factorsOf(message))] },
        ...{ middle: subtract(extent.middle, eye), radius: [extent.radius] },
      },
    };
  }

  // Draws the particles into the slabs of each ray, and tells where those are.
  private drawSlabs({ message, layout, count }: Moment, { width, height, uniforms }: Grid): Target {
    const { gl, targets } = this;
    const range = targets.of('range', this.summed, width, height);
    targets.into(range);
    this.addParticles(this.program('range', rangeSource).use().set(uniforms), count);
    const places = targets.of('places', this.kept, width, height);
    targets.into(places);
    const sun = { to_light: message.toLight, irradiance: message.irradiance };
    this.program('places', placesSource)
      .use()
      .set({ ...uniforms, ...sun, lobes: message.phase })
      .textures({ range });
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    const slabs = targets.of('slabs', this.summed, width, height, SLABS);
    if (!targets.into(slabs, 0, this.atOnce)) this.atOnce = SLABS / 2;
    for (let first = 0; first < SLABS; first += this.atOnce) {
      targets.into(slabs, first, this.atOnce);
      const name = `slabs ${layout.hues} ${layout.fluences} ${first} ${this.atOnce}`;
      const program = this.program(name, () => slabsSource(layout, first, this.atOnce));
      program
        .use()
        .set({ ...uniforms, ...sun, ambient: message.ambient, straight: message.straight })
        .set({ emission: message.emission, cold_albedo: message.coldAlbedo })
        .set({ mean_cosine: message.meanCosine })
        .setVectors(
          'channels',
          message.hues.flatMap(({ channels }) => [channels & 1, (channels >> 1) & 1, channels >> 2]),
        )
        .textures({ places });
      this.addParticles(program, count);
    }
    return places;
  }

  private addParticles(program: Program, count: number): void {
    const { gl } = this;
    program.use();
    gl.bindVertexArray(this.vertices);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.enable(gl.BLEND);
    gl.blendEquation(gl.FUNC_ADD);
    gl.blendFunc(gl.ONE, gl.ONE);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count);
    gl.disable(gl.BLEND);
    gl.bindVertexArray(null);
  }

  // The light of each ray: of all of it, or with `parts` up to the end of each slab, in as many layers. Between rays a
  // spline goes through them.
  private drawRays(message: LitParticles, { width, height, rate }: Grid, parts: boolean): Target {
    const { targets } = this;
    const slabs = targets.of('slabs', this.summed, width, height, SLABS);
    const rays = targets.of('rays', this.kept, width, height, parts ? SLABS : 1);
    const factor = factorsOf(message);
    this.drawLayers(rays, (first, count) =>
      this.program(`rays ${first} ${count} ${parts}`, () => raysSource(parts ? first : SLABS - 1, count))
        .use()
        .set({ factor })
        .textures({ slabs }),
    );
    if (rate === 1) return rays;
    const splines = targets.of('splines', this.kept, width, height, rays.layers);
    this.drawLayers(splines, (first, count) =>
      this.program(`spline ${first} ${count}`, () => splineSource(first, count))
        .use()
        .textures({ rays }),
    );
    return splines;
  }

  // Draws all layers of a target, as many at once as it can. `use` takes the program of some of them.
  private drawLayers(target: Target, use: (first: number, count: number) => void): void {
    const count = Math.min(this.atOnce, target.layers);
    for (let first = 0; first < target.layers; first += count) {
      this.targets.into(target, first, count);
      use(first, count);
      this.gl.drawArrays(this.gl.TRIANGLES, 0, 3);
    }
  }

  // Sky and objects at each pixel.
  private drawSurfaces(
    moment: Moment,
    eye: Vec3,
    uniforms: Record<string, number | readonly number[]>,
    { width, height }: Area,
  ): Target {
    const { gl, targets } = this;
    const { message } = moment;
    const { depths, light } = this.shadow(moment);
    const surfaces = targets.of('surfaces', this.kept, width, height);
    targets.into(surfaces);
    const objects = { texture: this.objects, layers: 0 };
    this.program('surfaces', surfacesSource)
      .use()
      .set({ ...uniforms, ...light, eye, shift: message.origin, near: NEAR, haze: message.haze })
      .set({ to_light: message.toLight, irradiance: message.irradiance })
      .setWhole({ count: message.objects.length })
      .textures({ objects, depths });
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    return surfaces;
  }

  // The map of the light that passes the medium, once for all views of a moment.
  private shadow(moment: Moment): { depths: Target; light: Record<string, readonly number[]> } {
    const { message, count } = moment;
    if (!this.shadowed || !this.light) this.light = lightSpaceOf(moment);
    const { x, y, lo, hi } = this.light;
    const light = {
      ...{ light_x: x, light_y: y, map: [lo[0], lo[1], Math.max(hi[0] - lo[0], 1e-3), Math.max(hi[1] - lo[1], 1e-3)] },
      planes: [hi[2], Math.max(hi[2] - lo[2], 1e-3) / (SHADOW_PLANES - 1)],
    };
    const depths = this.targets.of('depths', this.summed, SHADOW_TEXELS, SHADOW_TEXELS);
    if (this.shadowed) return { depths, light };
    this.shadowed = true;
    this.targets.into(depths);
    const program = this.program('shadow', shadowSource)
      .use()
      .set({ ...light, to_light: message.toLight, falloff: message.falloff, texels: SHADOW_TEXELS })
      .set({ thickest: Math.max(...factorsOf(message)) });
    this.addParticles(program, count);
    return { depths, light };
  }
}

// Rays of unit view depth through a grid's points, as linear functions of their places. They are `rate` pixels apart,
// and `margin` of them are before the picture.
function raysOf({ orientation, frustum }: View, width: number, height: number, rate: number, margin: number) {
  const [right, up] = [rotate(orientation, [1, 0, 0]), rotate(orientation, [0, 1, 0])];
  const ahead = rotate(orientation, [0, 0, -1]);
  const [x, y] = [(frustum.left + frustum.right) / width, (frustum.up + frustum.down) / height]; // of a pixel
  const first = 0.5 - (0.5 + margin) * rate; // pixels
  const corner = add(ahead, add(scale(right, first * x - frustum.left), scale(up, first * y - frustum.down)));
  return { corner, across: scale(right, rate * x), rise: scale(up, rate * y) };
}

// Of each channel, on the extinction.
function factorsOf({ hues }: LitParticles): [number, number, number] {
  const of = (bit: number): number => hues.find(({ channels }) => channels & bit)?.extinction ?? 1;
  return [of(1), of(2), of(4)];
}

const skyOf = ({ zenith, horizon }: LitParticles): Record<string, readonly number[]> => ({ zenith, horizon });
