// What soak.mjs puts into a page before its own scripts.

// Makes the page's time pass `factor` times as fast: clocks, timers, events and animation frames, sixty for each
// of its seconds. The network and the server keep their own.
export function faster(factor) {
  const real = performance.now.bind(performance);
  const began = real();
  const since = Date.now() - began;
  const at = (ms) => began + (ms - began) * factor;
  performance.now = () => at(real());
  Date.now = () => Math.round(since + performance.now());
  const stamp = Object.getOwnPropertyDescriptor(Event.prototype, 'timeStamp').get;
  Object.defineProperty(Event.prototype, 'timeStamp', {
    get() {
      return at(stamp.call(this));
    },
  });
  for (const name of ['setTimeout', 'setInterval']) {
    const own = window[name].bind(window);
    window[name] = (call, ms = 0, ...rest) => own(call, ms / factor, ...rest);
  }
  const ask = window.requestAnimationFrame.bind(window);
  let waiting = new Map();
  let last = 0;
  let asked = false;
  let drawn = performance.now();
  const frame = () => {
    const now = performance.now();
    const count = Math.max(1, Math.min(10 * factor, Math.round((now - drawn) * 0.06)));
    for (let i = 1; i <= count; ++i) {
      const calls = waiting;
      waiting = new Map();
      for (const call of calls.values()) call(drawn + ((now - drawn) * i) / count);
    }
    drawn = now;
    asked = false;
    follow();
  };
  const follow = () => {
    if (asked || waiting.size === 0) return;
    asked = true;
    ask(frame);
  };
  window.requestAnimationFrame = (call) => {
    waiting.set(++last, call);
    follow();
    return last;
  };
  window.cancelAnimationFrame = (id) => void waiting.delete(id);
}

// window.counted: what the garbage collector does not see, or frees late. Objects of WebGL 2 are gone when they are
// deleted or collected, pictures when they are closed or given to a canvas.
export function count() {
  const counted = { gpu: 0, bitmaps: 0, sockets: 0, latencies: [], frames: 0 };
  window.counted = counted;
  const collected = new FinalizationRegistry(() => --counted.gpu);
  const gl = WebGL2RenderingContext.prototype;
  for (const kind of ['Texture', 'Buffer', 'Framebuffer', 'Program', 'Shader', 'VertexArray', 'Renderbuffer']) {
    const [make, free] = [gl[`create${kind}`], gl[`delete${kind}`]];
    gl[`create${kind}`] = function (...how) {
      const made = make.apply(this, how);
      if (!made) return made;
      ++counted.gpu;
      collected.register(made, kind, made);
      return made;
    };
    gl[`delete${kind}`] = function (object) {
      if (object && collected.unregister(object)) --counted.gpu;
      free.call(this, object);
    };
  }
  const open = new WeakSet();
  const gone = (bitmap) => open.delete(bitmap) && --counted.bitmaps;
  const decode = window.createImageBitmap.bind(window);
  window.createImageBitmap = async (...how) => {
    const bitmap = await decode(...how);
    open.add(bitmap);
    ++counted.bitmaps;
    return bitmap;
  };
  const close = ImageBitmap.prototype.close;
  ImageBitmap.prototype.close = function () {
    gone(this);
    close.call(this);
  };
  const show = ImageBitmapRenderingContext.prototype.transferFromImageBitmap;
  ImageBitmapRenderingContext.prototype.transferFromImageBitmap = function (bitmap) {
    if (bitmap) gone(bitmap);
    show.call(this, bitmap);
  };
  const Socket = window.WebSocket;
  window.WebSocket = class extends Socket {
    constructor(...how) {
      super(...how);
      ++counted.sockets;
      this.addEventListener('close', () => --counted.sockets);
    }
  };
}

// Notes how old pictures are when they are seen, in ms of the page's clock.
export const listen = () =>
  document.getElementById('view').addEventListener('picture', ({ detail: { latency } }) => {
    ++window.counted.frames;
    if (latency) window.counted.latencies.push(latency.total);
  });

// As many viewers one after another as come in `ms`, each with a picture and pushes. Returns how many.
export async function visit(ms) {
  let visitors = 0;
  for (const end = performance.now() + ms; performance.now() < end; ++visitors) {
    const view = document.createElement('brume-view');
    for (const [name, value] of [
      ['src', location.href],
      ['size', '64x64'],
      ['idle', '2'],
    ])
      view.setAttribute(name, value);
    view.style.height = '64px';
    document.body.append(view);
    const seen = await new Promise((done) => {
      const timer = setTimeout(() => done(false), 10_000);
      const came = () => {
        clearTimeout(timer); // it would keep the view
        done(true);
      };
      view.addEventListener('picture', came, { once: true });
    });
    if (!seen) return -1;
    const push = { kind: 'impulse', origin: [0, 2, 26], direction: [0, 0, -1], strength: 0.5 };
    for (let i = 0; i < 20; ++i) view.viewer.command(push);
    view.remove();
  }
  return visitors;
}
