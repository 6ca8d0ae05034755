// A WebXR session. It asks the server for pictures with the headset's pose, eye separation and projections. At every
// frame of the headset's display it draws each eye's newest picture, turned to where that eye looks now. With layers it
// asks for one picture from between the eyes, and redraws it as each eye sees it from where it is now. Poses are asked
// for where the head will be when their pictures are seen. Where the page draws by itself, each eye sees the medium as
// it is now.
import { add, length, orientation, scale, subtract } from './camera';
import type { LayerBitmaps, Surface } from './picture';
import { conjugate, covering, fromProjection, multiply, rotate, shaped, together, warp, widened } from './projection';
import type { View } from './projection';
import { hasParts } from './protocol';
import type { Command, Frame, Quat, Vec3 } from './protocol';
import { Fade } from './fade';
import { Hands } from './headset-hands';
import type { HandsHost } from './headset-hands';
import { LitMedium } from './lit-medium';
import type { Drawable } from './lit-stream';
import { coverBy } from './program';
import type { Area } from './program';
import { Predictor, headGoesOn } from './predict';
import type { Head } from './predict';
import { Redraw } from './redraw';
import { requestedSize } from './size';
import { LAYERS, MARGIN, viewOf } from './viewing';
import type { PoseWish, ViewingHost } from './viewing';
import { Warp, watchContext } from './warp';

// vr: the picture is all that is seen. ar: the medium and objects hang in the wearer's room.
export type HeadsetMode = 'vr' | 'ar';

export interface HeadsetPlace extends ViewingHost {
  readonly drawing: ViewingHost['drawing'] & { at(now: number): Drawable | undefined };
  readonly mayPush: boolean;
  readonly latencyMs: number; // from a pose to its picture; 0: not known
}

export interface HeadsetEvents {
  ask(wish: PoseWish): void;
  push(command: Command): void;
  // Pictures of this way of rendering have no layers: the headset asks for those of both eyes from now on.
  asksForBoth(): void;
  // Called before each frame of the display: hands the newest picture to show().
  beforeFrame(): void;
  worn(): void; // it was put on or taken off: `hidden` may have changed
  ended(why: string): void;
}

export async function headsetSupported(mode: HeadsetMode): Promise<boolean> {
  return (await navigator.xr?.isSessionSupported(`immersive-${mode}`).catch(() => false)) ?? false;
}

// A worn headset's session lasts so long without a connection: it cannot begin again by itself, and a headset that was
// put on has to find its network first.
const LOST_MS = 10_000;
const EYE_HEIGHT = 1.6; // m above the floor that the page's camera stands for
const layerOf = (session: XRSession, gl: WebGL2RenderingContext, mode: HeadsetMode): XRWebGLLayer =>
  new XRWebGLLayer(session, gl, { antialias: false, alpha: mode === 'ar', depth: false });
const reason = (error: unknown): string => (error instanceof Error ? error.message : String(error));
const vec = (p: DOMPointReadOnly): Vec3 => [p.x, p.y, p.z];
const quat = (p: DOMPointReadOnly): Quat => [p.x, p.y, p.z, p.w];

// The floor of the room that the headset knows, or else where it was put on.
async function spaceOf(session: XRSession): Promise<{ space: XRReferenceSpace; height: number }> {
  try {
    return { space: await session.requestReferenceSpace('local-floor'), height: EYE_HEIGHT };
  } catch {
    return { space: await session.requestReferenceSpace('local'), height: 0 };
  }
}

// The most pictures a second that its display can show: redrawing them takes little.
function askForFastest(session: XRSession): void {
  const rates = [...(session.supportedFrameRates ?? [])];
  if (rates.length > 0) void session.updateTargetFrameRate(Math.max(...rates)).catch(() => undefined);
}

// Undefined: this browser cannot redraw pictures from layers.
function redrawOf(gl: WebGL2RenderingContext, mode: HeadsetMode): Redraw | undefined {
  try {
    return new Redraw(gl, mode === 'ar');
  } catch (error) {
    console.error('brume: pictures cannot be redrawn from layers:', error);
    return undefined;
  }
}

// Undefined: this browser cannot draw the medium by itself, or may not: what is drawn here hides the wearer's room.
function mediumOf(gl: WebGL2RenderingContext, mode: HeadsetMode): LitMedium | undefined {
  try {
    return mode === 'vr' ? new LitMedium(gl) : undefined;
  } catch (error) {
    console.error('brume: the medium cannot be drawn here:', error);
    return undefined;
  }
}

export class Headset implements Surface {
  // For tests: number of display frames drawn, and the last pose that was asked for.
  drawn = 0;
  asked: PoseWish | undefined;
  readonly draws: boolean; // true: it can draw the medium by itself
  private medium: LitMedium | undefined; // undefined also while the graphics context is lost
  private frame: Frame | undefined;
  private readonly fade = new Fade();
  private layered = false; // true: `redraw` has the frame's layers
  private lostAt: number | undefined; // ms, when the connection was lost or the headset put on since
  private why = 'The headset’s session has ended.';
  private readonly path = new Predictor<Head>(headGoesOn);
  private hands: Hands | undefined;

  private constructor(
    private readonly session: XRSession,
    private readonly space: XRReferenceSpace,
    private layer: XRWebGLLayer,
    private readonly gl: WebGL2RenderingContext,
    private warp: Warp | undefined, // undefined while the graphics context is lost
    private redraw: Redraw | undefined, // the same, and without layers
    private readonly place: HeadsetPlace,
    readonly mode: HeadsetMode,
    private readonly events: HeadsetEvents,
    private readonly base: Head,
  ) {
    this.medium = mediumOf(gl, mode);
    this.draws = this.medium !== undefined;
  }

  // Starts a session, upright, at the page's camera. To be called in the handler of a click: browsers start a session
  // from nothing else. Throws an Error whose message says in one line why there is none.
  // `layered`: true for layers, if this browser can draw them. Without them nothing can be seen through.
  static async start(
    place: HeadsetPlace,
    mode: HeadsetMode,
    layered: boolean,
    events: HeadsetEvents,
  ): Promise<Headset> {
    const wish = { optionalFeatures: ['local-floor'] };
    const session = await navigator.xr?.requestSession(`immersive-${mode}`, wish).catch((error: unknown) => {
      throw new Error(`The headset did not start: ${reason(error)}`);
    });
    if (!session) throw new Error('This browser knows no headsets.');
    try {
      const canvas = document.createElement('canvas');
      const gl = canvas.getContext('webgl2', { xrCompatible: true, antialias: false });
      if (!gl) throw new Error('this browser has no WebGL 2');
      const layer = layerOf(session, gl, mode);
      await session.updateRenderState({ baseLayer: layer });
      const { space, height } = await spaceOf(session);
      askForFastest(session);
      const { camera } = place;
      const position = subtract(camera.position, [0, height, 0]);
      const base = { position, orientation: orientation({ ...camera, pitch: 0 }) };
      const redraw = layered || mode === 'ar' ? redrawOf(gl, mode) : undefined;
      if (mode === 'ar' && !redraw) throw new Error('this browser cannot draw what is seen through');
      const headset = new Headset(session, space, layer, gl, new Warp(gl), redraw, place, mode, events, base);
      const ending = new AbortController();
      watchContext(canvas, ending.signal, headset.lose, headset.renew);
      headset.hands = new Hands(session, headset.handsHost(), ending.signal);
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
    const before = this.layered;
    this.place.drawing.yield();
    this.layered = this.redraw !== undefined && told !== undefined && hasParts(told) && of !== undefined;
    if (this.layered && picture && of && told) this.redraw?.take(picture, of, told, viewOf(frame, 0, 0));
    this.fade.begin(before && this.layered, performance.now());
    if (this.redraw && told && !hasParts(told)) this.doWithout();
    if (this.warp && bitmaps.length === this.views) {
      this.warp.upload(bitmaps);
      this.frame = frame;
    }
    for (const bitmap of bitmaps) bitmap.close();
  }

  // This way of rendering has no layers.
  private doWithout(): void {
    if (this.mode === 'ar')
      return this.end('This way of rendering cannot be seen through: the headset’s session has ended.');
    this.redraw = undefined;
    this.events.asksForBoth();
  }

  private readonly lose = (): void => {
    this.warp = this.frame = this.medium = undefined;
    this.layered = false;
  };

  // The graphics context is back, without what it held. The session's layer belonged to the lost one.
  private readonly renew = async (): Promise<void> => {
    try {
      await this.gl.makeXRCompatible();
      this.layer = layerOf(this.session, this.gl, this.mode);
      await this.session.updateRenderState({ baseLayer: this.layer });
      this.warp = new Warp(this.gl);
      this.medium = mediumOf(this.gl, this.mode);
      if (this.redraw) this.redraw = redrawOf(this.gl, this.mode);
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
    this.hands?.follow(this.session.inputSources, (source) => {
      const at = now.getPose(source.targetRaySpace, this.space);
      return at && this.worldOf(at.transform);
    });
    this.ask(this.worldOf(pose.transform), shown);
    gl.bindFramebuffer(gl.FRAMEBUFFER, layer.framebuffer);
    gl.clearColor(0, 0, 0, this.mode === 'ar' ? 0 : 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
    const moment = this.medium && this.place.drawing.at(performance.now());
    if (moment) this.medium?.take(moment);
    else if (!frame) return;
    const part = this.fade.part(performance.now());
    shown.forEach(({ view, seen }, eye) => {
      const at = layer.getViewport(view);
      if (!at) return;
      const area = { framebuffer: layer.framebuffer, x: at.x, y: at.y, width: at.width, height: at.height };
      if (moment) return this.medium?.draw(seen, area);
      if (part < 1 && this.redraw?.drawBefore(seen, area)) coverBy(gl, part);
      if (this.layered) this.redraw?.draw(seen, area);
      else if (frame && this.mode === 'vr') this.drawFlat(painter, frame, eye, seen, area);
      coverBy(gl, 1);
    });
    this.drawn += 1;
  };

  private drawFlat(painter: Warp, frame: Frame, eye: number, seen: View, area: Area): void {
    const from = Math.min(eye, frame.jpeg.length - 1);
    painter.draw(from, warp(viewOf(frame, from, 0), seen), area);
  }

  private ask(head: Head, shown: readonly { view: XRView; seen: View }[]): void {
    const [left, right = left] = shown;
    const at = left && this.layer.getViewport(left.view);
    if (!left || !right || !at) return;
    this.path.add(performance.now(), head);
    const then = this.path.predict(this.place.latencyMs) ?? head;
    // What the head turns until then, both eyes turn too.
    const turn = multiply(then.orientation, conjugate(head.orientation));
    const size = requestedSize(at.width, at.height, 1 + MARGIN, this.place.cap);
    const frusta = [left, right].map(({ seen: { frustum, orientation: own } }) =>
      shaped(
        widened(covering({ orientation: multiply(turn, own), frustum }, then.orientation), MARGIN),
        size.width / size.height,
      ),
    );
    const middle = scale(add(left.seen.position, right.seen.position), 0.5);
    const wish = {
      position: add(then.position, rotate(turn, subtract(middle, head.position))),
      orientation: then.orientation,
      fovY: this.place.fovY,
      ...size,
    };
    const [one, other = one] = frusta;
    if (this.redraw && one && other) {
      const both = shaped(together(one, other), size.width / size.height);
      this.asked = { ...wish, frusta: [both], layers: LAYERS };
    } else {
      this.asked = { ...wish, frusta, eyeSeparation: length(subtract(right.seen.position, left.seen.position)) };
    }
    this.events.ask(this.asked);
  }

  private handsHost(): HandsHost {
    const { place, base, events } = this;
    return {
      get mayPush() {
        return place.mayPush;
      },
      get distance() {
        return place.camera.distance;
      },
      send: (command) => events.push(command),
      carry: (step) => (base.position = subtract(base.position, step)),
    };
  }

  private worldOf({ position, orientation: turn }: XRRigidTransform): Head {
    return {
      position: add(this.base.position, rotate(this.base.orientation, vec(position))),
      orientation: multiply(this.base.orientation, quat(turn)),
    };
  }

  private inWorld(view: XRView): View {
    return { ...this.worldOf(view.transform), frustum: fromProjection(view.projectionMatrix) };
  }
}
