// Redraws pictures as seen from where the eye is now, from their layers with depth, with WebGL 2. A picture of the
// server is taken apart once: what each layer sends, and what is behind all of them. Then every picture of the display
// is one pass over its pixels, which finds for each where its ray meets the layers. common/redraw.cpp does the same.
import { conjugate, multiply, rotate } from './projection';
import type { View } from './projection';
import { subtract } from './camera';
import type { LayerBitmaps } from './picture';
import { makeProgram } from './program';
import type { DepthLayers, Frame } from './protocol';
import { APART, DRAW, EVERYWHERE, QUAD, REST, SPLINE } from './redraw-shaders';

const MOST_LAYERS = 8;
const SPARE_UNIT = 8; // of textures that are made: it disturbs none that is drawn with

interface Target {
  texture: WebGLTexture;
  width: number;
  height: number;
  deep: number; // textures one behind the other; 0: it is none of several
}

export class Redraw {
  private readonly spline: WebGLProgram;
  private readonly everywhere: WebGLProgram;
  private readonly rest: WebGLProgram;
  private readonly apart: WebGLProgram;
  private readonly drawn: WebGLProgram;
  private readonly framebuffer: WebGLFramebuffer;
  private readonly targets = new Map<string, Target>();
  private readonly pictures = new Map<string, Target>();
  private layers: DepthLayers | undefined;
  private size = { width: 0, height: 0 };
  private whole = true; // true: the picture has not been taken apart yet

  // Throws if the WebGL context cannot do it.
  constructor(private readonly gl: WebGL2RenderingContext) {
    if (!gl.getExtension('EXT_color_buffer_float') && !gl.getExtension('EXT_color_buffer_half_float'))
      throw new Error('this graphics context draws no numbers with fractions');
    this.spline = makeProgram(gl, QUAD, SPLINE);
    this.everywhere = makeProgram(gl, QUAD, EVERYWHERE);
    this.rest = makeProgram(gl, QUAD, REST);
    this.apart = makeProgram(gl, QUAD, APART);
    this.drawn = makeProgram(gl, QUAD, DRAW);
    this.framebuffer = gl.createFramebuffer();
  }

  // Takes a picture, and takes it apart when it is first drawn. The bitmaps stay the caller's.
  take(picture: ImageBitmap, bitmaps: LayerBitmaps, frame: Frame, layers: DepthLayers): void {
    this.layers = layers;
    this.size = { width: frame.width, height: frame.height };
    this.whole = true;
    this.upload('picture', picture);
    for (const name of ['colours', 'data', 'surface'] as const) this.upload(name, bitmaps[name]);
  }

  private takeApart({ count, columns, rows, surface }: DepthLayers): void {
    const { gl } = this;
    const { width, height } = this.size;
    const sky = count > 0 && surface.length === 0;
    const blocks = count + (sky ? 1 : 0);
    const coefficients = this.target('coefficients', columns || 1, rows * blocks || 1);
    const layers = this.target('layers', width, height, { deep: MOST_LAYERS + 1 });
    if (blocks > 0) {
      this.use(this.spline, { colours: this.picture('colours'), data: this.picture('data') });
      this.pass([coefficients]);
      const program = this.use(this.everywhere, { coefficients });
      for (let block = 0; block < blocks; ++block) {
        gl.uniform1i(gl.getUniformLocation(program, 'block'), block);
        this.pass([layers], block);
      }
    }
    const common = { picture: this.picture('picture'), layers };
    const levels = 1 + Math.floor(Math.log2(Math.max(width, height)));
    const means = this.target('means', width, height, { levels });
    if (!sky) {
      this.use(this.rest, common);
      this.pass([means]);
      gl.bindTexture(gl.TEXTURE_2D, means.texture);
      gl.generateMipmap(gl.TEXTURE_2D);
    }
    const program = this.use(this.apart, { ...common, means });
    gl.uniform1i(gl.getUniformLocation(program, 'sky'), Number(sky));
    gl.uniform1i(gl.getUniformLocation(program, 'levels'), levels);
    this.pass([this.target('behind', width, height), this.target('factor', width, height)]);
    this.whole = false;
  }

  // Draws what `shown` sees into a rectangle of `framebuffer`, in pixels from its lower left corner. `made`: the view
  // of the picture that was taken.
  draw(
    made: View,
    shown: View,
    framebuffer: WebGLFramebuffer | null,
    x: number,
    y: number,
    width: number,
    height: number,
  ): void {
    const { gl, layers } = this;
    if (!layers) return;
    if (this.whole) this.takeApart(layers);
    const { width: wide, height: high } = this.size;
    const program = this.use(this.drawn, {
      data: this.picture('data'),
      surface: this.picture('surface'),
      layers: this.target('layers', wide, high, { deep: MOST_LAYERS + 1 }),
      behind: this.target('behind', wide, high),
      factor: this.target('factor', wide, high),
    });
    const into = conjugate(made.orientation);
    const seen = (v: readonly [number, number, number]): [number, number, number] => {
      const own = rotate(into, [...v]);
      return [own[0], own[1], -own[2]];
    };
    const turn = multiply(into, shown.orientation);
    const ray = (v: [number, number, number]): [number, number, number] => {
      const own = rotate(turn, v);
      return [own[0], own[1], -own[2]];
    };
    const at = (name: string): WebGLUniformLocation | null => gl.getUniformLocation(program, name);
    const { left, right, up, down } = shown.frustum;
    const f = made.frustum;
    gl.uniform3fv(at('from'), seen(subtract(shown.position, made.position)));
    gl.uniform3fv(at('corner'), ray([-left, up, -1]));
    gl.uniform3fv(at('across'), ray([left + right, 0, 0]));
    gl.uniform3fv(at('down'), ray([0, -(up + down), 0]));
    gl.uniform4f(at('frustum'), f.left, f.up, f.left + f.right, f.up + f.down);
    gl.uniform2f(at('size'), this.size.width, this.size.height);
    gl.uniform2f(at('depths'), layers.near, layers.far);
    gl.uniform2f(at('surfaces'), layers.nearSurface, layers.farSurface);
    gl.uniform1f(at('nearest'), layers.nearest);
    gl.uniform1i(at('rows_apart'), layers.blockRows);
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    gl.viewport(x, y, width, height);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  // Binds a program with its textures, and with what all of them ask for.
  private use(program: WebGLProgram, textures: Record<string, Target>): WebGLProgram {
    const { gl, layers } = this;
    gl.useProgram(program);
    Object.entries(textures).forEach(([name, texture], unit) => {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(texture.deep ? gl.TEXTURE_2D_ARRAY : gl.TEXTURE_2D, texture.texture);
      gl.uniform1i(gl.getUniformLocation(program, name), unit);
    });
    if (!layers) return program;
    gl.uniform1i(gl.getUniformLocation(program, 'filmic'), Number(layers.filmic));
    gl.uniform1i(gl.getUniformLocation(program, 'count'), layers.count);
    gl.uniform3i(gl.getUniformLocation(program, 'lattice'), layers.columns, layers.rows, layers.blockRows);
    gl.uniform2f(gl.getUniformLocation(program, 'nodes'), layers.spacing, layers.first);
    return program;
  }

  // Draws into whole targets; of a deep one into that part.
  private pass(targets: Target[], part = 0): void {
    const { gl } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.framebuffer);
    [0, 1].forEach((i) => {
      const [at, to] = [gl.COLOR_ATTACHMENT0 + i, targets[i]];
      if (to?.deep) gl.framebufferTextureLayer(gl.FRAMEBUFFER, at, to.texture, 0, part);
      else gl.framebufferTexture2D(gl.FRAMEBUFFER, at, gl.TEXTURE_2D, to?.texture ?? null, 0);
    });
    gl.drawBuffers(targets.map((_, i) => gl.COLOR_ATTACHMENT0 + i));
    const [first] = targets;
    if (first) gl.viewport(0, 0, first.width, first.height);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  // A texture of numbers with fractions, to be drawn into.
  private target(name: string, width: number, height: number, { levels = 1, deep = 0 } = {}): Target {
    const { gl } = this;
    const known = this.targets.get(name);
    if (known && known.width === width && known.height === height) return known;
    if (known) gl.deleteTexture(known.texture);
    const texture = gl.createTexture();
    const kind = deep ? gl.TEXTURE_2D_ARRAY : gl.TEXTURE_2D;
    gl.activeTexture(gl.TEXTURE0 + SPARE_UNIT);
    gl.bindTexture(kind, texture);
    if (deep) gl.texStorage3D(kind, 1, gl.RGBA16F, width, height, deep);
    else gl.texStorage2D(kind, levels, gl.RGBA16F, width, height);
    smooth(gl, kind, levels > 1 ? gl.LINEAR_MIPMAP_NEAREST : gl.LINEAR);
    const made = { texture, width, height, deep };
    this.targets.set(name, made);
    return made;
  }

  private picture(name: string): Target {
    return this.pictures.get(name) ?? this.upload(name, undefined);
  }

  private upload(name: string, bitmap: ImageBitmap | undefined): Target {
    const { gl } = this;
    const known = this.pictures.get(name);
    const made = { texture: known?.texture ?? gl.createTexture(), width: 1, height: 1, deep: 0 };
    gl.activeTexture(gl.TEXTURE0 + SPARE_UNIT);
    gl.bindTexture(gl.TEXTURE_2D, made.texture);
    if (bitmap) gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
    else gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 1, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, null);
    smooth(gl, gl.TEXTURE_2D, gl.LINEAR);
    this.pictures.set(name, made);
    return made;
  }
}

function smooth(gl: WebGL2RenderingContext, kind: number, minify: number): void {
  for (const side of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(kind, side, gl.CLAMP_TO_EDGE);
  gl.texParameteri(kind, gl.TEXTURE_MIN_FILTER, minify);
  gl.texParameteri(kind, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
}
