// GpuTimer: how long a graphics card takes for what is drawn between begin() and end(), where the browser tells.
const PENDING = 4; // measurements that are not known yet; more are not begun

// Of EXT_disjoint_timer_query_webgl2.
interface Extension {
  readonly TIME_ELAPSED_EXT: GLenum;
  readonly GPU_DISJOINT_EXT: GLenum;
}

export class GpuTimer {
  ms: number | undefined; // of the newest that is known
  private readonly extension: Extension | null;
  private readonly pending: WebGLQuery[] = [];
  private running = false;

  constructor(private readonly gl: WebGL2RenderingContext) {
    this.extension = gl.getExtension('EXT_disjoint_timer_query_webgl2') as Extension | null;
  }

  begin(): void {
    if (!this.extension || this.pending.length >= PENDING) return;
    const query = this.gl.createQuery();
    if (!query) return;
    this.gl.beginQuery(this.extension.TIME_ELAPSED_EXT, query);
    this.pending.push(query);
    this.running = true;
  }

  end(): void {
    const { gl, extension } = this;
    if (!extension) return;
    if (this.running) gl.endQuery(extension.TIME_ELAPSED_EXT);
    this.running = false;
    const disjoint = Boolean(gl.getParameter(extension.GPU_DISJOINT_EXT)); // the card did something else meanwhile
    for (;;) {
      const [query] = this.pending;
      if (!query || !gl.getQueryParameter(query, gl.QUERY_RESULT_AVAILABLE)) return;
      if (!disjoint) this.ms = Number(gl.getQueryParameter(query, gl.QUERY_RESULT)) / 1e6;
      gl.deleteQuery(query);
      this.pending.shift();
    }
  }
}
