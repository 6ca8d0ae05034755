// Drawing: the page draws the medium by itself, from lit particles that the server sends in the place of pictures.
import { DRAW_HZ, DrawChoice } from './draw-choice';
import { GpuTimer } from './gpu-timer';
import { Rate } from './latency';
import { LitMedium } from './lit-medium';
import type { Drawn } from './lit-medium';
import { LitStream } from './lit-stream';
import type { Drawable } from './lit-stream';
import type { Area } from './program';
import type { View } from './projection';
import type { LitParticles } from './protocol';

export interface DrawingHost {
  readonly wishes: { readonly view: string };
  readonly headset: { readonly draws: boolean } | undefined;
  readonly connected: boolean;
  context(): WebGL2RenderingContext | undefined; // of the page
  hasHardware(): boolean; // a graphics card draws for this browser
  reconnect(): void;
  taken(message: LitParticles): void;
  unreadable(error: unknown): void;
  note(text: string): void;
}

export class Drawing {
  // True: what is shown is drawn here. False: it is the server's pictures.
  shown = false;
  asked = 0; // messages a second, by the last hello; 0: pictures
  readonly choice = new DrawChoice();
  readonly rate = new Rate(2000); // pictures that were drawn
  private came = false; // true: particles came last, not a picture
  private readonly stream: LitStream;
  private medium: LitMedium | undefined;
  private timer: GpuTimer | undefined;

  constructor(private readonly host: DrawingHost) {
    this.stream = new LitStream({
      taken: (message) => {
        this.shown = this.came;
        host.taken(message);
      },
      unreadable: (error) => host.unreadable(error),
    });
  }

  // Messages a second to ask for, of a new connection; 0: pictures.
  hello(): number {
    this.asked = this.wanted();
    return this.asked;
  }

  receive(message: LitParticles): void {
    this.came = true;
    this.stream.receive(message);
  }

  // A picture of the server came, and will be shown when it is decoded.
  pictureCame(): void {
    this.came = false;
  }

  // It is to be shown, unless particles came since.
  yield(): void {
    if (!this.came) this.shown = false;
  }

  // To be called for a new connection.
  clear(): void {
    this.shown = this.came = false;
    this.stream.clear();
  }

  // To be called when the page's graphics context was lost, or is back.
  lose(): void {
    this.medium = this.timer = undefined;
  }

  // To be called once per animation frame: connects again where something else is wanted than was asked for.
  follow(): void {
    if (this.host.connected && this.wanted() !== this.asked) this.host.reconnect();
  }

  // The scene now, where particles are what is shown.
  at(now: number): Drawable | undefined {
    return this.shown ? this.stream.at(now) : undefined;
  }

  // The newest that came, as it came.
  get newest(): LitParticles | undefined {
    return this.shown ? this.stream.newest?.message : undefined;
  }

  // Draws by `draw`, and measures that. Returns false if nothing can be drawn now.
  measure(draw: (medium: LitMedium) => void, now: number): boolean {
    const { medium, timer } = this;
    if (!medium || !timer) return false;
    timer.begin();
    try {
      draw(medium);
    } catch (error) {
      this.fail('this browser’s WebGL 2 does not take its shaders', error);
      return false;
    } finally {
      timer.end();
    }
    this.rate.add(now);
    const ms = this.choice.drew(now, timer.ms);
    if (ms !== undefined)
      this.host.note(`Drawing here took ${ms.toFixed(0)} ms a picture: the server draws from now on.`);
    return true;
  }

  // Draws the newest particles that came, as they came. Returns their message; undefined: nothing was drawn.
  drawNewest(view: View, to: Area): LitParticles | undefined {
    const moment = this.shown ? this.stream.whole() : undefined;
    if (!moment || !this.medium) return undefined;
    this.medium.take(moment);
    this.medium.draw(view, to);
    return moment.message;
  }

  // Of the last picture that was drawn here; undefined: the server's pictures are shown.
  get drawn(): (Drawn & { gpuMs: number | undefined }) | undefined {
    return this.shown && this.medium ? { ...this.medium.drawn, gpuMs: this.timer?.ms } : undefined;
  }

  private wanted(): number {
    const { wishes, headset } = this.host;
    if (wishes.view !== 'picture' || headset?.draws === false) return 0;
    return this.choice.wants(() => this.host.hasHardware()) && this.prepare() ? DRAW_HZ : 0;
  }

  // Also true while the context is lost: it will be back.
  private prepare(): boolean {
    if (this.medium) return true;
    const gl = this.host.context();
    if (gl?.isContextLost()) return true;
    try {
      if (!gl) throw new Error('this browser has no WebGL 2');
      this.medium = new LitMedium(gl);
      this.timer = new GpuTimer(gl);
      return true;
    } catch (error) {
      this.fail(error instanceof Error ? error.message : String(error), error);
      return false;
    }
  }

  private fail(why: string, error: unknown): void {
    console.error('brume: the medium cannot be drawn here:', error);
    this.lose();
    this.choice.fail();
    this.host.note(`Not drawn here: ${why}.`);
  }
}
