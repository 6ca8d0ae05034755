// A WebXR session. It asks the server for pictures with the headset's pose, eye separation and projections. At every
// frame of the headset's display it draws each eye's newest picture, reprojected to where that eye looks now.
import { add, length, orientation, scale, subtract } from './camera';
import type { Surface } from './picture';
import { covering, fromProjection, multiply, rotate, shaped, warp, widened } from './projection';
import type { View } from './projection';
import type { Frame, Quat, Vec3 } from './protocol';
import { requestedSize } from './size';
import { MARGIN, viewOf } from './viewing';
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

export class Headset implements Surface {
  // For tests: number of display frames drawn, and the last pose that was asked for.
  drawn = 0;
  asked: PoseWish | undefined;
  private frame: Frame | undefined;
  private lostAt: number | undefined; // ms, when the connection was lost or the headset put on since
  private why = 'The headset’s session has ended.';

  private constructor(
    private readonly session: XRSession,
    private readonly space: XRReferenceSpace,
    private layer: XRWebGLLayer,
    private readonly gl: WebGL2RenderingContext,
    private warp: Warp | undefined, // undefined while the graphics context is lost
    private readonly place: ViewingHost,
    private readonly events: HeadsetEvents,
    private readonly base: { position: Vec3; orientation: Quat },
  ) {}

  // Starts a session, upright, at the page's camera. To be called in the handler of a click: browsers start a session
  // from nothing else. Throws an Error whose message says in one line why there is none.
  static async start(place: ViewingHost, events: HeadsetEvents): Promise<Headset> {
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
      const headset = new Headset(session, space, layer, gl, new Warp(gl), place, events, base);
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

  show(bitmaps: ImageBitmap[], frame: Frame): void {
    if (this.warp && bitmaps.length === 2) {
      this.warp.upload(bitmaps);
      this.frame = frame;
    }
    for (const bitmap of bitmaps) bitmap.close();
  }

  private readonly lose = (): void => {
    this.warp = this.frame = undefined;
  };

  // The graphics context is back, without what it held. The session's layer belonged to the lost one.
  private readonly renew = async (): Promise<void> => {
    try {
      await this.gl.makeXRCompatible();
      this.layer = new XRWebGLLayer(this.session, this.gl, LAYER);
      await this.session.updateRenderState({ baseLayer: this.layer });
      this.warp = new Warp(this.gl);
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
      if (at) painter.draw(eye, warp(viewOf(frame, eye, 0), seen), at.x, at.y, at.width, at.height);
    });
    this.drawn += 1;
  };

  private ask(head: Quat, shown: readonly { view: XRView; seen: View }[]): void {
    const turn = multiply(this.base.orientation, head);
    const [left, right = left] = shown;
    const at = left && this.layer.getViewport(left.view);
    if (!left || !right || !at) return;
    const size = requestedSize(at.width, at.height, 1 + MARGIN, this.place.cap);
    const frusta = [left, right].map(({ seen }) =>
      shaped(widened(covering(seen, turn), MARGIN), size.width / size.height),
    );
    this.asked = {
      position: scale(add(left.seen.position, right.seen.position), 0.5),
      orientation: turn,
      fovY: this.place.fovY,
      eyeSeparation: length(subtract(right.seen.position, left.seen.position)),
      frusta,
      ...size,
    };
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
