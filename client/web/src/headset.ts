// A WebXR session. It asks the server for pictures with the headset's pose, eye separation and projections. At every
// frame of the headset's display it draws each eye's newest picture, turned to where that eye looks now. With layers it
// asks for one picture from between the eyes, and redraws it as each eye sees it from where it is now.
import { add, length, orientation, scale, subtract } from './camera';
import type { LayerBitmaps, Surface } from './picture';
import { covering, fromProjection, multiply, rotate, shaped, together, warp, widened } from './projection';
import type { View } from './projection';
import type { Frame, Quat, Vec3 } from './protocol';
import { Redraw } from './redraw';
import { requestedSize } from './size';
import { LAYERS, MARGIN, viewOf } from './viewing';
import type { PoseWish, ViewingHost } from './viewing';
import { Warp, watchContext } from './warp';

export interface HeadsetEvents {
  ask(wish: PoseWish): void;
  // Called before each frame of the display: hands the newest picture to show().
  beforeFrame(): void;
  worn(): void; // it was put on or taken off: `hidden` may have changed
  ended(why: string): void;
}

export async function headsetSupported(): Promise<boolean> {
  return (await navigator.xr?.isSessionSupported('immersive-vr').catch(() => false)) ?? false;
}

// A worn headset's session lasts so long without a connection: it cannot begin again by itself, and a headset that was
// put on has to find its network first.
const LOST_MS = 10_000;
const LAYER = { antialias: false, alpha: false, depth: false };
const reason = (error: unknown): string => (error instanceof Error ? error.message : String(error));
const vec = (p: DOMPointReadOnly): Vec3 => [p.x, p.y, p.z];
const quat = (p: DOMPointReadOnly): Quat => [p.x, p.y, p.z, p.w];

// Undefined: this browser cannot redraw pictures from layers.
function redrawOf(gl: WebGL2RenderingContext): Redraw | undefined {
  try {
    return new Redraw(gl);
  } catch (error) {
    console.error('brume: pictures cannot be redrawn from layers:', error);
    return undefined;
  }
}

export class Headset implements Surface {
  // For tests: number of display frames drawn, and the last pose that was asked for.
  drawn = 0;
  asked: PoseWish | undefined;
  private frame: Frame | undefined;
  private layered = false; // true: `redraw` has the frame's layers
  private lostAt: number | undefined; // ms, when the connection was lost or the headset put on since
  private why = 'The headset’s session has ended.';

  private constructor(
    private readonly session: XRSession,
    private readonly space: XRReferenceSpace,
    private layer: XRWebGLLayer,
    private readonly gl: WebGL2RenderingContext,
    private warp: Warp | undefined, // undefined while the graphics context is lost
    private redraw: Redraw | undefined, // the same, and without layers
    private readonly place: ViewingHost,
    private readonly events: HeadsetEvents,
    private readonly base: { position: Vec3; orientation: Quat },
  ) {}

  // Starts a session, upright, at the page's camera. To be called in the handler of a click: browsers start a session
  // from nothing else. Throws an Error whose message says in one line why there is none.
  // `layered`: true for layers, if this browser can draw them.
  static async start(place: ViewingHost, layered: boolean, events: HeadsetEvents): Promise<Headset> {
    const session = await navigator.xr?.requestSession('immersive-vr').catch((error: unknown) => {
      throw new Error(`The headset did not start: ${reason(error)}`);
    });
    if (!session) throw new Error('This browser knows no headsets.');
    try {
      const canvas = document.createElement('canvas');
      const gl = canvas.getContext('webgl2', { xrCompatible: true, antialias: false });
      if (!gl) throw new Error('this browser has no WebGL 2');
      const layer = new XRWebGLLayer(session, gl, LAYER);
      await session.updateRenderState({ baseLayer: layer });
      const space = await session.requestReferenceSpace('local');
      const { camera } = place;
      const base = { position: camera.position, orientation: orientation({ ...camera, pitch: 0 }) };
      const redraw = layered ? redrawOf(gl) : undefined;
      const headset = new Headset(session, space, layer, gl, new Warp(gl), redraw, place, events, base);
      const ending = new AbortController();
      watchContext(canvas, ending.signal, headset.lose, headset.renew);
      const worn = (): void => {
        if (headset.lostAt !== undefined) headset.lostAt = performance.now();
        events.worn();
      };
      session.addEventListener('visibilitychange', worn, { signal: ending.signal });
      session.addEventListener('end', () => {
        ending.abort();
        // Browsers keep some sixteen contexts, and take the page's own when more wait for the garbage collector.
        gl.getExtension('WEBGL_lose_context')?.loseContext();
        events.ended(headset.why);
      });
      session.requestAnimationFrame(headset.step);
      return headset;
    } catch (error) {
      await session.end().catch(() => undefined);
      throw new Error(`The headset did not start: ${reason(error)}`);
    }
  }

  // Pictures that are asked for.
  get views(): 1 | 2 {
    return this.redraw ? 1 : 2;
  }

  // True while nobody wears it: its display then has no frames.
  get hidden(): boolean {
    return this.session.visibilityState === 'hidden';
  }

  // To be called when the connection is there, and while it is not.
  linked(connected: boolean): void {
    this.lostAt = connected ? undefined : (this.lostAt ?? performance.now());
  }

  end(why?: string): void {
    if (why) this.why = why;
    void this.session.end().catch(() => undefined); // it may have ended already
  }

  show(bitmaps: ImageBitmap[], frame: Frame, layers: LayerBitmaps[] = []): void {
    const [picture, of, told] = [bitmaps[0], layers[0], frame.layers?.[0]];
    this.layered = this.redraw !== undefined && told !== undefined && of !== undefined;
    if (this.layered && picture && of && told) this.redraw?.take(picture, of, frame, told);
    if (this.warp && bitmaps.length === this.views) {
      this.warp.upload(bitmaps);
      this.frame = frame;
    }
    for (const bitmap of bitmaps) bitmap.close();
  }

  private readonly lose = (): void => {
    this.warp = this.frame = undefined;
    this.layered = false;
  };

  // The graphics context is back, without what it held. The session's layer belonged to the lost one.
  private readonly renew = async (): Promise<void> => {
    try {
      await this.gl.makeXRCompatible();
      this.layer = new XRWebGLLayer(this.session, this.gl, LAYER);
      await this.session.updateRenderState({ baseLayer: this.layer });
      this.warp = new Warp(this.gl);
      if (this.redraw) this.redraw = redrawOf(this.gl);
      this.place.again();
    } catch (error) {
      this.end(`The headset’s pictures were lost: ${reason(error)}`);
    }
  };

  private readonly step = (_: number, now: XRFrame): void => {
    this.session.requestAnimationFrame(this.step);
    this.events.beforeFrame();
    if (this.lostAt !== undefined && performance.now() - this.lostAt > LOST_MS)
      this.end('The connection was lost: the headset’s session has ended.');
    const { gl, layer, frame, warp: painter } = this;
    if (!painter) return;
    const pose = now.getViewerPose(this.space);
    if (!pose) return; // the headset has lost its tracking: the last picture stays
    const eyes = pose.views.filter((view) => view.eye !== 'none').slice(0, 2);
    const shown = (eyes.length > 0 ? eyes : pose.views.slice(0, 1)).map((view) => ({ view, seen: this.inWorld(view) }));
    this.ask(quat(pose.transform.orientation), shown);
    gl.bindFramebuffer(gl.FRAMEBUFFER, layer.framebuffer);
    gl.clearColor(0, 0, 0, 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
    if (!frame) return;
    shown.forEach(({ view, seen }, eye) => {
      const at = layer.getViewport(view);
      if (!at) return;
      const from = Math.min(eye, frame.jpeg.length - 1);
      const made = viewOf(frame, from, 0);
      if (this.layered) this.redraw?.draw(made, seen, layer.framebuffer, at.x, at.y, at.width, at.height);
      else painter.draw(from, warp(made, seen), at.x, at.y, at.width, at.height);
    });
    this.drawn += 1;
  };

  private ask(looks: Quat, shown: readonly { view: XRView; seen: View }[]): void {
    const turn = multiply(this.base.orientation, looks);
    const [left, right = left] = shown;
    const at = left && this.layer.getViewport(left.view);
    if (!left || !right || !at) return;
    const size = requestedSize(at.width, at.height, 1 + MARGIN, this.place.cap);
    const frusta = [left, right].map(({ seen }) =>
      shaped(widened(covering(seen, turn), MARGIN), size.width / size.height),
    );
    const head = {
      position: scale(add(left.seen.position, right.seen.position), 0.5),
      orientation: turn,
      fovY: this.place.fovY,
      ...size,
    };
    const [one, other = one] = frusta;
    if (this.redraw && one && other) {
      const both = shaped(together(one, other), size.width / size.height);
      this.asked = { ...head, frusta: [both], layers: LAYERS };
    } else {
      this.asked = { ...head, frusta, eyeSeparation: length(subtract(right.seen.position, left.seen.position)) };
    }
    this.events.ask(this.asked);
  }

  private inWorld(view: XRView): View {
    const { position, orientation: turn } = view.transform;
    return {
      position: add(this.base.position, rotate(this.base.orientation, vec(position))),
      orientation: multiply(this.base.orientation, quat(turn)),
      frustum: fromProjection(view.projectionMatrix),
    };
  }
}
