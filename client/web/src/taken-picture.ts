// A picture of the server with its layers, in textures: as it came, and taken apart (redraw.ts).
import type { LayerBitmaps } from './picture';
import type { View } from './projection';
import type { DepthLayers } from './protocol';

const SPARE_UNIT = 8; // of textures that are made: it disturbs none that is drawn with

export interface Texture {
  texture: WebGLTexture;
  width: number;
  height: number;
  deep: number; // textures one behind the other; 0: it is none of several
}

export class TakenPicture {
  layers: DepthLayers | undefined; // undefined: no picture was taken
  made: View | undefined; // the view it was made for
  width = 0;
  height = 0;
  whole = true; // true: it has not been taken apart yet
  private readonly targets = new Map<string, Texture>();
  private readonly pictures = new Map<string, Texture>();

  constructor(private readonly gl: WebGL2RenderingContext) {}

  // The bitmaps stay the caller's.
  take(picture: ImageBitmap, bitmaps: LayerBitmaps, layers: DepthLayers, made: View): void {
    [this.layers, this.made, this.width, this.height] = [layers, made, picture.width, picture.height];
    this.whole = true;
    this.upload('picture', picture);
    for (const name of ['colours', 'data', 'surface'] as const) this.upload(name, bitmaps[name]);
  }

  // A texture of numbers with fractions, to be drawn into.
  target(name: string, width: number, height: number, { levels = 1, deep = 0 } = {}): Texture {
    const { gl } = this;
    const known = this.targets.get(name);
    if (known && known.width === width && known.height === height && known.deep === deep) return known;
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

  // One that came. Of those that did not come a black pixel.
  picture(name: string): Texture {
    return this.pictures.get(name) ?? this.upload(name, undefined);
  }

  private upload(name: string, bitmap: ImageBitmap | undefined): Texture {
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
