// Compiles and links a WebGL program. Throws if the context cannot.
export function makeProgram(gl: WebGL2RenderingContext, vertex: string, fragment: string): WebGLProgram {
  const program = gl.createProgram();
  for (const [type, source] of [
    [gl.VERTEX_SHADER, vertex],
    [gl.FRAGMENT_SHADER, fragment],
  ] as const) {
    const shader = gl.createShader(type);
    if (!shader) throw new Error('the graphics context was lost');
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost())
      throw new Error(gl.getShaderInfoLog(shader) ?? 'a shader does not compile');
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) {
    throw new Error(gl.getProgramInfoLog(program) ?? 'the graphics context was lost');
  }
  return program;
}

// What is drawn from now on covers so much of what is there: 0 ... 1.
export function coverBy(gl: WebGL2RenderingContext, part: number): void {
  if (part < 1) gl.enable(gl.BLEND);
  else gl.disable(gl.BLEND);
  gl.blendColor(0, 0, 0, part);
  gl.blendFunc(gl.CONSTANT_ALPHA, gl.ONE_MINUS_CONSTANT_ALPHA);
}

// A rectangle of a framebuffer, in pixels from its lower left corner. null: the canvas.
export interface Area {
  framebuffer: WebGLFramebuffer | null;
  x: number;
  y: number;
  width: number;
  height: number;
}
