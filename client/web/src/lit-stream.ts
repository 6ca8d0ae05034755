// LitStream makes moments of the scene from messages of lit particles. It unpacks them in their order, and holds what
// later ones refer to. It gives what is to be drawn at a time.
import { LitClock } from './lit-clock';
import { inflated, plainBytes, rowsOf } from './lit-columns';
import type { Rows } from './lit-columns';
import { between, momentOf, strideOf } from './lit-moment';
import type { Moment } from './lit-moment';
import { ProtocolError } from './protocol';
import type { LitParticles } from './protocol';

const LAYERS = 4; // of message numbers
const MOST_WAITING = 32; // messages that are not unpacked yet; the server sends a few before it waits for Acks
const MOST_HELD = 6; // moments: two to draw between, and what comes before its time

// The layer of a message number: how often two divides it. Later messages refer to the last one of a layer.
export const layerOf = (number: number): number => Math.min(31 - Math.clz32(number & -number), LAYERS - 1);

export interface LitEvents {
  taken(message: LitParticles): void; // it is a moment that will be drawn, or one that came too late for that
  unreadable(error: unknown): void;
}

// What is to be drawn. `message` has all numbers but the particles'. `version`: another number for other particles.
export interface Drawable extends Moment {
  version: number;
}

export class LitStream {
  private readonly rows: ({ number: number; rows: Rows } | undefined)[] = Array.from({ length: LAYERS });
  private moments: { tick: number; moment: Moment }[] = []; // in order
  private clock = new LitClock();
  private chain: Promise<void> = Promise.resolve();
  private waiting = 0;
  private generation = 0;
  private version = 0;
  private drawn: { from: Moment; next: Moment; part: number; drawable: Drawable } | undefined;
  private mixed = new Float32Array(0);
  private spare: Float32Array | undefined;

  constructor(private readonly events: LitEvents) {}

  receive(message: LitParticles): void {
    if (this.waiting >= MOST_WAITING)
      return this.events.unreadable(new ProtocolError('particles come faster than they can be unpacked'));
    this.waiting += 1;
    const [generation, now] = [this.generation, performance.now()];
    this.chain = this.chain.then(async () => {
      try {
        if (generation !== this.generation) return;
        const plain = await inflated(message.bytes, plainBytes(message.present, message.count));
        if (generation === this.generation) this.take(message, plain, now);
      } catch (error) {
        if (generation === this.generation) this.events.unreadable(error);
      } finally {
        this.waiting -= 1;
      }
    });
  }

  // To be called for a new connection: messages of the old one are not drawn any more.
  clear(): void {
    this.generation += 1;
    this.rows.fill(undefined);
    this.moments = [];
    this.clock = new LitClock();
    this.drawn = undefined;
  }

  // The newest moment, as it came.
  get newest(): Moment | undefined {
    return this.moments[this.moments.length - 1]?.moment;
  }

  // The same, to be drawn in between.
  whole(): Drawable | undefined {
    return this.newest && { ...this.newest, version: ++this.version };
  }

  // The scene at this time, ms. Undefined: nothing came yet. It holds until the next call.
  at(now: number): Drawable | undefined {
    const tick = this.clock.at(now);
    while (this.moments.length > 1 && (this.moments[1]?.tick ?? Infinity) <= tick) this.forget();
    const [from, next = from] = this.moments;
    if (!from || !next) return undefined;
    const alike =
      from.moment.layout.hues === next.moment.layout.hues &&
      from.moment.layout.fluences === next.moment.layout.fluences;
    const part = from === next || !alike ? 0 : Math.min(Math.max((tick - from.tick) / (next.tick - from.tick), 0), 1);
    return this.show(from.moment, part > 0 ? next.moment : from.moment, part);
  }

  private show(from: Moment, next: Moment, part: number): Drawable {
    const { drawn } = this;
    if (drawn?.from === from && drawn.next === next && drawn.part === part) return drawn.drawable;
    this.version += 1;
    let drawable: Drawable = { ...from, version: this.version };
    if (part > 0) {
      const length = from.count * strideOf(from.layout);
      if (this.mixed.length < length) this.mixed = new Float32Array(length);
      between(from, next, part, this.mixed);
      drawable = { ...from, message: next.message, values: this.mixed, version: this.version };
    }
    this.drawn = { from, next, part, drawable };
    return drawable;
  }

  private take(message: LitParticles, plain: Uint8Array, now: number): void {
    const layer = layerOf(message.number);
    const reference = this.rows.find((one) => one?.number === message.reference)?.rows;
    if (message.reference !== 0 && !reference) throw new ProtocolError('particles refer to a message that is not held');
    const rows = rowsOf(message, plain, message.reference === 0 ? undefined : reference);
    this.rows[layer] = { number: message.number, rows };
    this.hold(momentOf(message, rows, this.spare), now);
    this.spare = undefined;
    this.events.taken(message);
  }

  private hold(moment: Moment, now: number): void {
    const tick = Number(moment.message.tick);
    this.clock.came(tick, now);
    const last = this.moments[this.moments.length - 1];
    if (last && tick <= last.tick)
      this.moments = []; // the scene has begun anew
    // What stood still until just before goes on from there.
    else if (last && tick - last.tick > this.clock.longest) last.tick = tick - this.clock.interval;
    this.moments.push({ tick, moment });
    if (this.moments.length > MOST_HELD) this.forget();
  }

  // The oldest moment.
  private forget(): void {
    this.spare = this.moments.shift()?.moment.values;
  }
}
