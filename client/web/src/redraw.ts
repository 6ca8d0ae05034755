// Redraws pictures as seen from where the eye is now, from their layers with depth, with WebGL 2. A picture of the
// server is taken apart once: what each layer sends, and what is behind all of them. Then every picture of the display
// is one pass over its pixels, which finds for each where its ray meets the layers. common/redraw.cpp does the same.
// The picture before stays, so that a new one can be blended in.
import { conjugate, multiply, rotate } from './projection';
import type { View } from './projection';
import { subtract } from './camera';
import type { LayerBitmaps } from './picture';
import { makeProgram } from './program';
import type { Area } from './program';
import type { DepthLayers } from './protocol';
import { APART, DRAW, EVERYWHERE, QUAD, REST, SPLINE } from './redraw-shaders';
import { TakenPicture } from './taken-picture';
import type { Texture } from './taken-picture';

export class Redraw {
  private readonly spline: WebGLProgram;
  private readonly everywhere: WebGLProgram;
  private readonly rest: WebGLProgram;
  private readonly apart: WebGLProgram;
  private readonly drawn: WebGLProgram;
  private readonly framebuffer: WebGLFramebuffer;
  private newest: TakenPicture;
  private before: TakenPicture;

  // `seeThrough`: true draws no sky; what is seen of it has alpha below 1. Throws if the WebGL context cannot do it.
  constructor(
    private readonly gl: WebGL2RenderingContext,
    private readonly seeThrough = false,
  ) {
    if (!gl.getExtension('EXT_color_buffer_float') && !gl.getExtension('EXT_color_buffer_half_float'))
      throw new Error('this graphics context draws no numbers with fractions');
    this.spline = makeProgram(gl, QUAD, SPLINE);
    this.everywhere = makeProgram(gl, QUAD, EVERYWHERE);
    this.rest = makeProgram(gl, QUAD, REST);
    this.apart = makeProgram(gl, QUAD, APART);
    this.drawn = makeProgram(gl, QUAD, DRAW);
    this.framebuffer = gl.createFramebuffer();
    this.newest = new TakenPicture(gl);
    this.before = new TakenPicture(gl);
  }

  // Takes a picture, and takes it apart when it is first drawn. The bitmaps stay the caller's. `made`: its view.
  take(picture: ImageBitmap, bitmaps: LayerBitmaps, layers: DepthLayers, made: View): void {
    [this.newest, this.before] = [this.before, this.newest];
    this.newest.take(picture, bitmaps, layers, made);
  }

  // Draws what `shown` sees of the newest picture.
  draw(shown: View, to: Area): void {
    this.drawTaken(this.newest, shown, to);
  }

  // The same of the picture before it. Returns false if there is none.
  drawBefore(shown: View, to: Area): boolean {
    return this.drawTaken(this.before, shown, to);
  }

  private takeApart(taken: TakenPicture, { count, columns, rows, surface }: DepthLayers): void {
    const { gl } = this;
    const { width, height } = taken;
    const sky = count > 0 && surface.length === 0;
    const blocks = count + (sky ? 1 : 0);
    const coefficients = taken.target('coefficients', columns || 1, rows * blocks || 1);
    const layers = taken.target('layers', width, height, { deep: count + 1 });
    if (blocks > 0) {
      this.use(taken, this.spline, { colours: taken.picture('colours'), data: taken.picture('data') });
      this.pass([coefficients]);
      const program = this.use(taken, this.everywhere, { coefficients });
      for (let block = 0; block < blocks; ++block) {
        gl.uniform1i(gl.getUniformLocation(program, 'block'), block);
        this.pass([layers], block);
      }
    }
    const common = { picture: taken.picture('picture'), layers };
    const levels = 1 + Math.floor(Math.log2(Math.max(width, height)));
    const means = taken.target('means', width, height, { levels });
    if (!sky) {
      this.use(taken, this.rest, common);
      this.pass([means]);
      gl.bindTexture(gl.TEXTURE_2D, means.texture);
      gl.generateMipmap(gl.TEXTURE_2D);
    }
    const program = this.use(taken, this.apart, { ...common, means });
    gl.uniform1i(gl.getUniformLocation(program, 'sky'), Number(sky));
    gl.uniform1i(gl.getUniformLocation(program, 'levels'), levels);
    this.pass([taken.target('behind', width, height), taken.target('factor', width, height)]);
    taken.whole = false;
  }

  private drawTaken(taken: TakenPicture, shown: View, to: Area): boolean {
    const { gl } = this;
    const { layers, made, width, height } = taken;
    if (!layers || !made) return false;
    if (taken.whole) {
      const blends = gl.isEnabled(gl.BLEND);
      gl.disable(gl.BLEND);
      this.takeApart(taken, layers);
      if (blends) gl.enable(gl.BLEND);
    }
    const program = this.use(taken, this.drawn, {
      data: taken.picture('data'),
      surface: taken.picture('surface'),
      layers: taken.target('layers', width, height, { deep: layers.count + 1 }),
      behind: taken.target('behind', width, height),
      factor: taken.target('factor', width, height),
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
    gl.uniform2f(at('size'), width, height);
    gl.uniform2f(at('depths'), layers.near, layers.far);
    gl.uniform2f(at('surfaces'), layers.nearSurface, layers.farSurface);
    gl.uniform1f(at('nearest'), layers.nearest);
    gl.uniform1i(at('rows_apart'), layers.blockRows);
    gl.uniform1i(at('see_through'), Number(this.seeThrough));
    gl.bindFramebuffer(gl.FRAMEBUFFER, to.framebuffer);
    gl.viewport(to.x, to.y, to.width, to.height);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    return true;
  }

  // Binds a program with its textures, and with what all of them ask for.
  private use({ layers }: TakenPicture, program: WebGLProgram, textures: Record<string, Texture>): WebGLProgram {
    const { gl } = this;
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
  private pass(targets: Texture[], part = 0): void {
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
}
