// Decides when pictures are redrawn from layers with depth though nobody asked: while the server gives few pictures or
// late ones. It has no clock: callers pass the time.
import { hasParts } from './protocol';
import type { DepthLayers } from './protocol';

const FEW = 30; // pictures a second, below which a moving camera is seen to step
const LATE_MS = 50; // from input to picture, above which the picture is felt to lag behind
const STEADY_MS = 3000; // for which that has to last
const MISSING_MS = 8000; // for which pictures come without layers: shaders are compiled within this time
const LOOK_MS = 250; // between two looks
const GAP_MS = 1000; // without looks, after which those before say nothing: the page was hidden
const DRAWS_MS = 28; // mean time between pictures of the display, above which this machine is too slow for layers
const NEWEST = 0.02; // weight of the newest picture in that mean

export interface AutoLayersHost {
  // How pictures come. `rate`: a second; undefined while the server has no reason to send them. `latencyMs`: from input
  // to picture; 0: not known.
  pace(now: number): { rate: number | undefined; latencyMs: number };
  // Draws with layers from now on, or without. Returns false if this browser should not.
  use(layers: boolean): boolean;
}

export class AutoLayers {
  taken = false; // true: pictures are redrawn from layers
  private useless = false; // true: this browser or this way of rendering has none
  private lookedAt = -Infinity; // ms
  private slowSince: number | undefined; // ms
  private missingSince: number | undefined; // ms, when a picture came without the layers that were asked for
  private scene: string | undefined;
  private method: string | undefined;
  private drawnAt = -Infinity; // ms, the display's last picture
  private drawsMs = 0; // between pictures of the display since layers were taken, a mean

  constructor(private readonly host: AutoLayersHost) {}

  // Another choice: nothing is known.
  begin(): void {
    if (this.taken) this.host.use(false);
    this.taken = this.useless = false;
    this.slowSince = this.missingSince = undefined;
  }

  // Another connection. In the same scene what was decided stays.
  connect(scene: string): void {
    if (scene !== this.scene) this.begin();
    this.scene = scene;
    this.slowSince = this.missingSince = undefined;
  }

  // What is rendered with now: another method may have layers, or none.
  follow(method: string | undefined): void {
    if (method === this.method) return;
    this.method = method;
    this.useless = false;
  }

  // To be called once per animation frame.
  look(now: number): void {
    if (this.taken) this.watch(now - this.drawnAt);
    this.drawnAt = now;
    if (this.taken || this.useless || now - this.lookedAt < LOOK_MS) return;
    if (now - this.lookedAt > GAP_MS) this.slowSince = undefined;
    this.lookedAt = now;
    const { rate, latencyMs } = this.host.pace(now);
    const slow = rate !== undefined && (rate < FEW || latencyMs > LATE_MS);
    this.slowSince = slow ? (this.slowSince ?? now) : undefined;
    if (this.slowSince === undefined || now - this.slowSince < STEADY_MS) return;
    this.taken = this.host.use(true);
    this.useless = !this.taken;
    this.missingSince = undefined;
    this.drawsMs = 0;
  }

  // Gives up where redrawing itself makes the display's pictures few.
  private watch(betweenMs: number): void {
    if (betweenMs > GAP_MS) return; // the page was hidden
    this.drawsMs += (betweenMs - this.drawsMs) * NEWEST;
    if (this.drawsMs > DRAWS_MS) this.giveUp();
  }

  private giveUp(): void {
    this.begin();
    this.useless = true;
  }

  // A picture came for which layers were asked.
  came(layers: readonly DepthLayers[] | undefined, now: number): void {
    if (!this.taken) return;
    this.missingSince = layers?.some(hasParts) ? undefined : (this.missingSince ?? now);
    if (this.missingSince === undefined || now - this.missingSince <= MISSING_MS) return;
    this.giveUp();
  }
}
