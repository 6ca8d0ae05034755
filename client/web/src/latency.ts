// Where the time between a viewer's input and its picture goes, and rates over a sliding second. No page, no sockets.
import type { Frame } from './protocol';

export const STAGES = ['wait', 'render', 'encode', 'queue', 'network', 'decode', 'present'] as const;
export type Stage = (typeof STAGES)[number];
export type Latency = Record<Stage, number> & { total: number }; // ms

// Instants on the viewer's own clock, ms.
export interface Presented {
  received: number;
  decoded: number;
  presented: number;
}

// Input to present on the viewer's clock alone. The server reports durations, the viewer knows its own; the network, both
// ways, is what remains. Frames carry the time at which the pose was sent.
export function splitLatency(frame: Pick<Frame, 'clientTimeUs' | 'stages'>, at: Presented): Latency {
  const total = at.presented - Number(frame.clientTimeUs) / 1000;
  const { wait, render, encode, queue } = frame.stages;
  const decode = at.decoded - at.received;
  const present = at.presented - at.decoded;
  const network = Math.max(0, total - wait - render - encode - queue - decode - present);
  return { wait, render, encode, queue, network, decode, present, total };
}

// Exponential average of latencies, so that numbers can be read while they change.
export class LatencyAverage {
  private value: Latency | undefined;

  constructor(private readonly weight = 0.15) {}

  add(sample: Latency): void {
    const old = this.value;
    if (!old) {
      this.value = { ...sample };
      return;
    }
    for (const key of [...STAGES, 'total'] as const) old[key] += (sample[key] - old[key]) * this.weight;
  }

  get(): Readonly<Latency> | undefined {
    return this.value;
  }

  reset(): void {
    this.value = undefined;
  }
}

// Events and their amounts over the last `span` ms.
export class Rate {
  private events: { at: number; amount: number }[] = [];

  constructor(private readonly span = 1000) {}

  add(at: number, amount = 1): void {
    this.events.push({ at, amount });
    this.forget(at);
  }

  // Per second.
  perSecond(now: number): number {
    this.forget(now);
    let sum = 0;
    for (const event of this.events) sum += event.amount;
    return (sum * 1000) / this.span;
  }

  private forget(now: number): void {
    let old = 0;
    while (old < this.events.length && (this.events[old]?.at ?? now) <= now - this.span) old += 1;
    if (old > 0) this.events.splice(0, old);
  }
}
