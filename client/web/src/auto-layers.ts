// Decides when pictures are redrawn from layers with depth though nobody asked: while the server gives few pictures or
// late ones. It has no clock: callers pass the time.
import type { DepthLayers } from './protocol';

const FEW = 30; // pictures a second, below which a moving camera is seen to step
const LATE_MS = 50; // from input to picture, above which the picture is felt to lag behind
const STEADY_MS = 3000; // for which that has to last
const MISSING_MS = 8000; // without layers, though asked for: shaders are compiled within this time
const LOOK_MS = 250; // between two looks

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
  private cameAt = 0; // ms, when layers last came, or were first asked for
  private method: string | undefined;

  constructor(private readonly host: AutoLayersHost) {}

  // Another connection, or another choice: nothing is known.
  begin(): void {
    if (this.taken) this.host.use(false);
    this.taken = this.useless = false;
    this.slowSince = undefined;
  }

  // What is rendered with now: another method may have layers, or none.
  follow(method: string | undefined): void {
    if (method === this.method) return;
    this.method = method;
    this.useless = false;
  }

  // To be called once per animation frame.
  look(now: number): void {
    if (this.taken || this.useless || now - this.lookedAt < LOOK_MS) return;
    this.lookedAt = now;
    const { rate, latencyMs } = this.host.pace(now);
    const slow = rate !== undefined && (rate < FEW || latencyMs > LATE_MS);
    this.slowSince = slow ? (this.slowSince ?? now) : undefined;
    if (this.slowSince === undefined || now - this.slowSince < STEADY_MS) return;
    this.taken = this.host.use(true);
    this.useless = !this.taken;
    this.cameAt = now;
  }

  // A picture came.
  came(layers: readonly DepthLayers[] | undefined, now: number): void {
    if (!this.taken) return;
    if (layers?.some(({ count, surface }) => count > 0 || surface.length > 0)) this.cameAt = now;
    if (now - this.cameAt <= MISSING_MS) return;
    this.begin();
    this.useless = true;
  }
}
