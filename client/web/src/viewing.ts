// Draws pictures on the page: as they come, side by side for two eyes, or reprojected to where the camera is now.
import { add, scale } from './camera';
import type { Camera } from './camera';
import { orientation } from './camera';
import { Fade } from './fade';
import { flatSurface } from './picture';
import type { LayerBitmaps, Surface } from './picture';
import type { Seen } from './live';
import { meanDepth, rotate, shaped, symmetric, warp, widened } from './projection';
import type { View } from './projection';
import { hasParts } from './protocol';
import type { Drawing } from './drawing';
import type { Drawable } from './lit-stream';
import type { Frame, PoseMessage, SceneState, Vec3 } from './protocol';
import { coverBy } from './program';
import type { Area } from './program';
import { Redraw } from './redraw';
import { requestedSize } from './size';
import type { Size } from './size';
import type { View as Made } from './views';
import { Warp, drawsWithHardware, watchContext } from './warp';

export type Eyes = 'one' | 'side';
// off: frames are drawn as they are. rotation: they are turned as the camera has turned since. plane: they also
// follow its moves, exactly at the distance of the pivot.
// layers: they are redrawn from layers with depth, as seen from where the camera is, for both eyes from one picture.
export type Reprojection = 'off' | 'rotation' | 'plane' | 'layers';
// auto: layers where the server gives few pictures or late ones and this browser draws with hardware, else off.
export type ReprojectionWish = Reprojection | 'auto';

export const EYES: readonly Eyes[] = ['one', 'side'];
export const REPROJECTIONS: readonly ReprojectionWish[] = ['auto', 'off', 'rotation', 'plane', 'layers'];
export const eyesOf = (text: string | null): Eyes => EYES.find((eyes) => eyes === text) ?? 'one';
export const reprojectionOf = (text: string | null): ReprojectionWish =>
  REPROJECTIONS.find((way) => way === text) ?? 'auto';

// Pictures for reprojection are wider and higher by the factor 1 + MARGIN.
export const MARGIN = 0.1;
// Layers with depth that are asked for.
export const LAYERS = 4;
// Distance between a person's eyes, m.
export const EYE_SEPARATION = 0.064;

export type PoseWish = Omit<PoseMessage, 'seq' | 'clientTimeUs'>;

// The view of one eye of `frame`, whose eyes stand `separation` m apart.
export function viewOf(frame: Frame, eye: number, separation: number): View {
  const frustum = frame.frusta[eye] ?? symmetric(frame.fovY, frame.width / frame.height);
  return {
    position: eyePosition(frame.position, frame.orientation, eye, frame.jpeg.length, separation),
    orientation: frame.orientation,
    frustum,
  };
}

// As exact as the wire's numbers.
function sameView(frame: Frame, position: Vec3, turn: View['orientation']): boolean {
  const near = (a: readonly number[], b: readonly number[]): boolean =>
    a.every((x, i) => Math.abs(x - (b[i] ?? 0)) < 1e-6 * (1 + Math.abs(x)));
  return near(position, frame.position) && near(turn, frame.orientation);
}

function eyePosition(head: Vec3, turn: View['orientation'], eye: number, views: number, separation: number): Vec3 {
  const side = views < 2 ? 0 : eye === 0 ? -0.5 : 0.5;
  return add(head, rotate(turn, [side * separation, 0, 0]));
}

type Pose = Omit<View, 'frustum'>;

export interface ViewingHost {
  readonly camera: Camera; // the newest
  readonly fovY: number;
  readonly cap: Size;
  readonly scene: SceneState | undefined;
  // view: drawn in the picture's place; cap: the most pixels that were asked for by hand.
  readonly wishes: { readonly view: Made; readonly cap?: Size | undefined };
  readonly drawing: { readonly shown: boolean; yield(): void };
  again(): void; // draws the newest picture once more: a graphics context was lost, or is back
}

export class Viewing implements Surface {
  eyes: Eyes = 'one';
  wished: ReprojectionWish = 'auto';
  reprojection: Reprojection = 'off'; // of `wished`, as it is drawn now
  // The pose that the screen shows, the one that its picture was made for, and how much of that covers the picture
  // before: 0 ... 1.
  shown: (Pose & { made: Pose; part: number }) | undefined;
  private readonly flat: Surface;
  private warp: Warp | undefined; // undefined also while the graphics context is lost
  private redraw: Redraw | undefined; // the same; and until layers are asked for
  private layered = false; // true: `redraw` has the frame's layers
  private gl: WebGL2RenderingContext | undefined;
  private frame: Frame | undefined; // the frame whose pictures are in the textures
  private readonly fade = new Fade();
  private drawnAs: readonly number[] = []; // of the moment that is on the canvas: all that it was drawn from
  private hardware: boolean | undefined; // undefined: nobody asked yet

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly warped: HTMLCanvasElement,
    private readonly host: ViewingHost,
    ending: AbortSignal,
  ) {
    this.flat = flatSurface(canvas);
    // Meanwhile pictures are drawn as they are.
    watchContext(
      warped,
      ending,
      () => this.renew(undefined),
      () => this.renew(this.makeWarp()),
    );
  }

  // Pictures that are asked for: with layers, both eyes are drawn from one.
  get views(): 1 | 2 {
    return this.reprojection === 'layers' ? 1 : this.parts;
  }

  // Eyes that are drawn.
  get parts(): 1 | 2 {
    return this.eyes === 'side' ? 2 : 1;
  }

  // Returns false and changes nothing if this browser has no WebGL 2 for it. Automatic ones begin without.
  choose(eyes: Eyes, wished: ReprojectionWish): boolean {
    const reprojection = wished !== 'auto' ? wished : this.wished === 'auto' ? this.reprojection : 'off';
    if (!this.use(eyes, reprojection)) return false;
    this.wished = wished;
    return true;
  }

  // Of automatic ones: with layers, or without. Returns false and changes nothing where that is not to be had.
  takeLayers(taken: boolean): boolean {
    if (this.wished !== 'auto') return false;
    return (!taken || this.hasHardware()) && this.use(this.eyes, taken ? 'layers' : 'off');
  }

  // Until the first picture for it the screen stays as it is.
  private use(eyes: Eyes, reprojection: Reprojection): boolean {
    const plain = eyes === 'one' && reprojection === 'off';
    if (!plain && !this.prepare()) return false;
    if (reprojection === 'layers' && !this.prepareLayers()) return false;
    if (reprojection !== 'layers') this.dropLayers();
    [this.eyes, this.reprojection] = [eyes, reprojection];
    return true;
  }

  // The size of one eye's picture to ask for, within `cap`.
  size(cap = this.host.cap): Size {
    const { clientWidth, clientHeight } = this.canvas;
    const grown = this.grows ? 1 + MARGIN : 1;
    return requestedSize(clientWidth / this.parts, clientHeight, window.devicePixelRatio * grown, cap);
  }

  wish(camera: Camera, size: Size): PoseWish {
    const { fovY, wishes } = this.host;
    const pose = { position: camera.position, orientation: orientation(camera), fovY, ...size, view: wishes.view };
    const stereo = this.views === 2 ? { eyeSeparation: EYE_SEPARATION } : {};
    if (!this.grows) return { ...pose, ...stereo };
    const frustum = shaped(widened(symmetric(fovY, this.aspect()), MARGIN), size.width / size.height);
    const layers = this.asksForLayers ? { layers: LAYERS } : {};
    return { ...pose, ...stereo, ...layers, frusta: this.views === 2 ? [frustum, frustum] : [frustum] };
  }

  // True: a headset should be drawn with layers, which hide how late its pictures are.
  get wantsLayers(): boolean {
    return this.wished === 'layers' || (this.wished === 'auto' && this.hasHardware());
  }

  // drawsWithHardware(), which is asked once.
  hasHardware(): boolean {
    return (this.hardware ??= drawsWithHardware());
  }

  // Whether pictures are redrawn from layers, for the status line (live.ts).
  get redrawn(): Seen['redrawn'] {
    const told = this.frame?.layers?.[0];
    if (this.reprojection !== 'layers' || this.host.drawing.shown) return 'no';
    if (told && !hasParts(told)) return 'missing';
    return this.wished === 'auto' ? 'unasked' : 'yes';
  }

  show(bitmaps: ImageBitmap[], frame: Frame, layers: LayerBitmaps[] = []): void {
    this.host.drawing.yield();
    this.drawnAs = [];
    this.warped.hidden = !this.warp || (this.eyes === 'one' && this.reprojection === 'off');
    if (!this.warp || this.warped.hidden) {
      this.frame = undefined;
      this.flat.show(bitmaps, frame);
      this.shown = { position: frame.position, orientation: frame.orientation, made: frame, part: 1 };
      return;
    }
    const [picture, of, told] = [bitmaps[0], layers[0], frame.layers?.[0]];
    const before = this.layered;
    this.layered = false;
    if (this.reprojection === 'layers' && this.redraw && picture && of && told && hasParts(told)) {
      this.redraw.take(picture, of, told, viewOf(frame, 0, EYE_SEPARATION));
      this.layered = true;
    }
    // A camera that stands sees the medium go on, which needs no blending.
    const moved = this.frame !== undefined && !sameView(frame, this.frame.position, this.frame.orientation);
    this.fade.begin(before && this.layered && moved, performance.now());
    this.warp.upload(bitmaps);
    for (const bitmap of bitmaps) bitmap.close();
    this.frame = frame;
  }

  // To be called once per animation frame, after Picture.draw().
  draw(): void {
    const { frame, gl } = this;
    if (!this.warp || !gl || !frame || this.warped.hidden || gl.isContextLost() || !this.fit()) return;
    const { camera } = this.host;
    const still = this.reprojection === 'off';
    const position = still ? frame.position : camera.position;
    const turn = still ? frame.orientation : orientation(camera);
    const part = this.fade.part(performance.now());
    this.forEyes(position, turn, (shown, area, eye) => {
      coverBy(gl, 1);
      if (part < 1 && this.redraw?.drawBefore(shown, area)) coverBy(gl, part);
      // From its own place a picture is what it is.
      if (this.layered && (this.parts === 2 || !sameView(frame, position, turn))) this.redraw?.draw(shown, area);
      else this.drawFlat(frame, eye, shown, area);
    });
    coverBy(gl, 1);
    this.shown = { position, orientation: turn, made: frame, part };
  }

  // The same in the place of pictures: a moment that is drawn here. What is on the canvas already is not drawn again.
  drawMoment(moment: Drawable, drawing: Drawing, now: number): void {
    const { warped, host } = this;
    const { camera, fovY } = host;
    if (!this.gl || this.gl.isContextLost()) return;
    warped.hidden = false;
    this.clear();
    if (!this.fit(host.wishes.cap)) return;
    const [position, turn] = [camera.position, orientation(camera)];
    const drawnAs = [moment.version, ...position, ...turn, fovY, warped.width, warped.height, this.parts];
    if (drawnAs.every((x, i) => x === this.drawnAs[i])) return;
    const drew = drawing.measure((medium) => {
      medium.take(moment);
      this.forEyes(position, turn, (shown, area) => medium.draw(shown, area));
    }, now);
    if (!drew) return;
    this.drawnAs = drawnAs;
    const pose = { position, orientation: turn };
    this.shown = { ...pose, made: pose, part: 1 };
  }

  // Pixels of one eye that is drawn here.
  get drawnSize(): Size {
    return { width: Math.floor(this.warped.width / this.parts), height: this.warped.height };
  }

  // Gives the canvas for WebGL its size, with at most the pixels of `cap`. Returns false where it has none.
  private fit(cap: Size = { width: Infinity, height: Infinity }): boolean {
    const { clientWidth, clientHeight } = this.warped;
    if (!clientWidth || !clientHeight) return false;
    const shrink = Math.min(
      1,
      Math.sqrt((cap.width * cap.height) / (clientWidth * clientHeight)) / window.devicePixelRatio,
    );
    const [width, height] = [clientWidth, clientHeight].map((x) => Math.round(x * window.devicePixelRatio * shrink));
    if (this.warped.width !== width || this.warped.height !== height) Object.assign(this.warped, { width, height });
    return true;
  }

  // Calls `draw` for each eye of a head, with its view and its part of the canvas.
  private forEyes(head: Vec3, turn: View['orientation'], draw: (shown: View, area: Area, eye: number) => void): void {
    const { width, height } = this.warped;
    const frustum = symmetric(this.host.fovY, this.aspect());
    const across = Math.floor(width / this.parts);
    for (let eye = 0; eye < this.parts; ++eye) {
      const position = eyePosition(head, turn, eye, this.parts, EYE_SEPARATION);
      const area = { framebuffer: null, x: eye * across, y: 0, width: across, height };
      draw({ position, orientation: turn, frustum }, area, eye);
    }
  }

  // To be called for a new connection: frames of the old one are not drawn any more.
  clear(): void {
    this.frame = undefined;
    this.layered = false;
  }

  private drawFlat(frame: Frame, eye: number, shown: View, area: Area): void {
    const from = Math.min(eye, frame.jpeg.length - 1);
    // Without layers all moves as the middle of the medium does.
    const { camera, scene } = this.host;
    const made = viewOf(frame, from, EYE_SEPARATION);
    const depths = { plane: camera.distance, layers: meanDepth(scene?.box, made), off: Infinity, rotation: Infinity };
    this.warp?.draw(from, warp(made, shown, depths[this.reprojection]), area);
  }

  // True: pictures are asked for with layers.
  get asksForLayers(): boolean {
    return this.grows && this.reprojection === 'layers';
  }

  // True: pictures have a margin that is seen when the camera turns. The legend of a view would lie in it.
  private get grows(): boolean {
    const { wishes, drawing } = this.host;
    return this.warp !== undefined && this.reprojection !== 'off' && wishes.view === 'picture' && !drawing.shown;
  }

  private aspect(): number {
    return this.canvas.clientWidth / this.parts / Math.max(1, this.canvas.clientHeight);
  }

  // Also true while the context is lost: it will be back.
  private prepare(): boolean {
    if (this.warp) return true;
    this.warp = this.context() && this.makeWarp();
    return this.warp !== undefined || (this.gl?.isContextLost() ?? false);
  }

  // Of the canvas above the first, for WebGL; undefined: this browser has none.
  context(): WebGL2RenderingContext | undefined {
    this.gl ??= this.warped.getContext('webgl2', { alpha: false, antialias: false, depth: false }) ?? undefined;
    return this.gl;
  }

  // The same for layers.
  private prepareLayers(): boolean {
    if (this.redraw || !this.gl || this.gl.isContextLost()) return true;
    try {
      this.redraw = new Redraw(this.gl);
    } catch (error) {
      console.error('brume: pictures cannot be redrawn from layers:', error);
    }
    return this.redraw !== undefined;
  }

  private makeWarp(): Warp | undefined {
    if (!this.gl || this.gl.isContextLost()) return undefined;
    try {
      return new Warp(this.gl);
    } catch (error) {
      console.error('brume: pictures cannot be warped:', error);
      return undefined;
    }
  }

  // Their textures are large.
  private dropLayers(): void {
    this.redraw = undefined;
    this.layered = false;
  }

  // The context was lost, and what was in it; or is back.
  private renew(warp: Warp | undefined): void {
    this.warp = warp;
    this.frame = undefined;
    this.drawnAs = [];
    this.dropLayers();
    if (warp && this.reprojection === 'layers') this.prepareLayers();
    if (!warp) this.warped.hidden = true;
    this.host.again();
  }
}
