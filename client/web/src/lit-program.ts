// A WebGL program with its uniforms, and textures that are drawn into, by name.
import { makeProgram } from './program';
import type { Source } from './lit-shaders';

export class Program {
  private readonly program: WebGLProgram;
  private readonly places = new Map<string, WebGLUniformLocation | null>();

  // Throws if the context cannot.
  constructor(
    private readonly gl: WebGL2RenderingContext,
    { vertex, fragment }: Source,
  ) {
    this.program = makeProgram(gl, vertex, fragment);
  }

  use(): this {
    this.gl.useProgram(this.program);
    return this;
  }

  // Numbers of a float, or of a vector; of the program that is used. What it does not ask for is passed over.
  set(uniforms: Readonly<Record<string, number | readonly number[]>>): this {
    const { gl } = this;
    for (const [name, value] of Object.entries(uniforms)) {
      const numbers = typeof value === 'number' ? [value] : value;
      const at = this.place(name);
      if (numbers.length === 1) gl.uniform1fv(at, numbers);
      else if (numbers.length === 2) gl.uniform2fv(at, numbers);
      else if (numbers.length === 3) gl.uniform3fv(at, numbers);
      else gl.uniform4fv(at, numbers);
    }
    return this;
  }

  // An array of vectors of three numbers.
  setVectors(name: string, numbers: readonly number[]): this {
    this.gl.uniform3fv(this.place(name), numbers);
    return this;
  }

  setWhole(uniforms: Readonly<Record<string, number>>): this {
    for (const [name, value] of Object.entries(uniforms)) this.gl.uniform1i(this.place(name), value);
    return this;
  }

  textures(textures: Readonly<Record<string, Pick<Target, 'texture' | 'layers'>>>): this {
    const { gl } = this;
    Object.entries(textures).forEach(([name, { texture, layers }], unit) => {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(layers ? gl.TEXTURE_2D_ARRAY : gl.TEXTURE_2D, texture);
      gl.uniform1i(this.place(name), unit);
    });
    return this;
  }

  dispose(): void {
    this.gl.deleteProgram(this.program);
  }

  private place(name: string): WebGLUniformLocation | null {
    const known = this.places.get(name);
    if (known !== undefined) return known;
    const place = this.gl.getUniformLocation(this.program, name);
    this.places.set(name, place);
    return place;
  }
}

export interface Target {
  texture: WebGLTexture;
  width: number;
  height: number;
  layers: number; // 0: it is no array
  format: GLenum;
  framebuffers: Map<string, WebGLFramebuffer | undefined>; // undefined: the context cannot draw so
}

const SPARE_UNIT = 8; // of textures that are made: it disturbs none that is drawn with

export class Targets {
  private readonly all = new Map<string, Target>();

  constructor(private readonly gl: WebGL2RenderingContext) {}

  // The texture of that name. With another size or format it is made anew, and what it showed is lost.
  of(name: string, format: GLenum, width: number, height: number, layers = 0): Target {
    const { gl } = this;
    const known = this.all.get(name);
    if (known?.width === width && known.height === height && known.layers === layers && known.format === format)
      return known;
    if (known) this.drop(known);
    const texture = gl.createTexture();
    const kind = layers ? gl.TEXTURE_2D_ARRAY : gl.TEXTURE_2D;
    gl.activeTexture(gl.TEXTURE0 + SPARE_UNIT);
    gl.bindTexture(kind, texture);
    if (layers) gl.texStorage3D(kind, 1, format, width, height, layers);
    else gl.texStorage2D(kind, 1, format, width, height);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(kind, filter, gl.NEAREST);
    for (const side of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(kind, side, gl.CLAMP_TO_EDGE);
    const made = { texture, width, height, layers, format, framebuffers: new Map() };
    this.all.set(name, made);
    return made;
  }

  // Draws from now on into this texture; of an array into layers first, first + 1 ... of `count`. Returns false if the
  // context cannot.
  into(target: Target, first = 0, count = 1): boolean {
    const { gl } = this;
    const key = `${first} ${count}`;
    if (!target.framebuffers.has(key)) target.framebuffers.set(key, this.framebufferOf(target, first, count));
    const framebuffer = target.framebuffers.get(key);
    if (!framebuffer) return false;
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    gl.viewport(0, 0, target.width, target.height);
    return true;
  }

  dispose(): void {
    for (const target of this.all.values()) this.drop(target);
    this.all.clear();
  }

  private framebufferOf(target: Target, first: number, count: number): WebGLFramebuffer | undefined {
    const { gl } = this;
    const framebuffer = gl.createFramebuffer();
    const attachments = Array.from({ length: count }, (_, i) => gl.COLOR_ATTACHMENT0 + i);
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    attachments.forEach((at, i) => {
      if (target.layers) gl.framebufferTextureLayer(gl.FRAMEBUFFER, at, target.texture, 0, first + i);
      else gl.framebufferTexture2D(gl.FRAMEBUFFER, at, gl.TEXTURE_2D, target.texture, 0);
    });
    gl.drawBuffers(attachments);
    if (gl.checkFramebufferStatus(gl.FRAMEBUFFER) === gl.FRAMEBUFFER_COMPLETE) return framebuffer;
    gl.deleteFramebuffer(framebuffer);
    return undefined;
  }

  private drop({ texture, framebuffers }: Target): void {
    for (const framebuffer of framebuffers.values()) if (framebuffer) this.gl.deleteFramebuffer(framebuffer);
    this.gl.deleteTexture(texture);
  }
}
