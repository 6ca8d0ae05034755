// Splits the time from a viewer's input to its picture into stages, and counts rates over a sliding second. Uses no
// page and no socket.
import type { Frame } from './protocol';

export const STAGES = ['input', 'wait', 'render', 'encode', 'queue', 'network', 'decode', 'present'] as const;
export type Stage = (typeof STAGES)[number];
export type Latency = Record<Stage, number> & { total: number }; // ms

// Times on the viewer's own clock, ms.
export interface Presented {
  received: number;
  decoded: number;
  presented: number;
}

// The latency from input to present, on the viewer's clock alone. The server reports its durations, and the viewer
// measures its own; the rest is the network, both ways. A frame carries the time at which its pose was sent. `input`:
// ms from the camera's move to that time.
export function splitLatency(frame: Pick<Frame, 'clientTimeUs' | 'stages'>, at: Presented, input = 0): Latency {
  const total = input + at.presented - Number(frame.clientTimeUs) / 1000;
  const { wait, render, encode, queue } = frame.stages;
  const decode = at.decoded - at.received;
  const present = at.presented - at.decoded;
  const network = Math.max(0, total - input - wait - render - encode - queue - decode - present);
  return { input, wait, render, encode, queue, network, decode, present, total };
}

// Exponential average of latencies: changes slowly enough to be read.
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

// The last latencies, for percentiles.
export class LatencyWindow {
  private readonly samples: Latency[] = [];
  private next = 0;

  constructor(private readonly most = 600) {}

  add(sample: Latency): void {
    this.samples[this.next] = { ...sample };
    this.next = (this.next + 1) % this.most;
  }

  get count(): number {
    return this.samples.length;
  }

  // The percentile of each stage, by nearest rank: the least sample that `percent` % do not exceed. Undefined without
  // samples.
  percentile(percent: number): Latency | undefined {
    const count = this.samples.length;
    if (count === 0) return undefined;
    const rank = Math.min(count, Math.max(1, Math.ceil((percent / 100) * count))) - 1;
    const of = (key: Stage | 'total'): number =>
      this.samples.map((sample) => sample[key]).sort((a, b) => a - b)[rank] ?? 0;
    return Object.fromEntries([...STAGES, 'total' as const].map((key) => [key, of(key)])) as Latency;
  }

  reset(): void {
    this.samples.length = this.next = 0;
  }
}

// Sums amounts over the last `span` ms.
export class Rate {
  private events: { at: number; amount: number }[] = [];

  constructor(private readonly span = 1000) {}

  add(at: number, amount = 1): void {
    this.events.push({ at, amount });
    this.forget(at);
  }

  // Sum of the amounts per second.
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
