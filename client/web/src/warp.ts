// Draws pictures of one or two eyes with WebGL, each through a homography (projection.ts).
import { makeProgram } from './program';
import type { Area } from './program';
import type { Matrix3 } from './projection';

const VERTEX = `#version 300 es
out vec2 place; // -1 ... 1
void main() { // one triangle that covers the viewport
  place = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = vec4(place, 0.0, 1.0);
}`;

// Beyond its sides a picture is continued by its last pixels. On a soft medium and a sky this shows less than a black
// border.
const FRAGMENT = `#version 300 es
precision highp float;
uniform mat3 warp;
uniform sampler2D picture;
in vec2 place;
out vec4 colour;
void main() {
  vec3 at = warp * vec3(place, 1.0);
  colour = vec4(at.z > 0.0 ? texture(picture, at.xy / at.z).rgb : vec3(0.0), 1.0);
}`;

// Tells of a WebGL context that the browser takes away, and of its return, empty.
export function watchContext(
  canvas: HTMLCanvasElement,
  ending: AbortSignal,
  lost: () => void,
  restored: () => void,
): void {
  const until = { signal: ending };
  const taken = (event: Event): void => {
    event.preventDefault(); // else it would never return
    lost();
  };
  canvas.addEventListener('webglcontextlost', taken, until);
  canvas.addEventListener('webglcontextrestored', restored, until);
}

export class Warp {
  private readonly program: WebGLProgram;
  private readonly matrix: WebGLUniformLocation | null;
  private readonly textures: WebGLTexture[] = [];

  // Throws if the WebGL context cannot compile it.
  constructor(private readonly gl: WebGL2RenderingContext) {
    this.program = makeProgram(gl, VERTEX, FRAGMENT);
    this.matrix = gl.getUniformLocation(this.program, 'warp');
  }

  // Uploads one picture for each eye. The bitmaps stay the caller's.
  upload(bitmaps: readonly ImageBitmap[]): void {
    const { gl } = this;
    gl.activeTexture(gl.TEXTURE0); // others use the context, too
    bitmaps.forEach((bitmap, eye) => {
      this.textures[eye] ??= gl.createTexture();
      gl.bindTexture(gl.TEXTURE_2D, this.textures[eye]);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
      for (const side of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T])
        gl.texParameteri(gl.TEXTURE_2D, side, gl.CLAMP_TO_EDGE);
      for (const scale of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
        gl.texParameteri(gl.TEXTURE_2D, scale, gl.LINEAR);
    });
  }

  draw(eye: number, matrix: Matrix3, { framebuffer, x, y, width, height }: Area): void {
    const { gl } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    gl.viewport(x, y, width, height);
    gl.useProgram(this.program);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.textures[eye] ?? null);
    gl.uniformMatrix3fv(this.matrix, false, matrix);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }
}

// Names of drivers that draw in software, where the browser does not own up to that.
const SOFTWARE = /swiftshader|llvmpipe|softpipe|software|basic render/i;

// True: this browser draws WebGL 2 with hardware. Software takes longer than a picture of the display.
export function drawsWithHardware(): boolean {
  const gl = document.createElement('canvas').getContext('webgl2', { failIfMajorPerformanceCaveat: true });
  if (!gl) return false;
  const name = gl.getParameter(gl.getExtension('WEBGL_debug_renderer_info')?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER);
  gl.getExtension('WEBGL_lose_context')?.loseContext(); // browsers keep some sixteen contexts
  return !SOFTWARE.test(String(name));
}
