// What this page measures: frame rates, latencies, and which ticks its frames showed.
import { LatencyAverage, LatencyWindow, Rate, splitLatency } from './latency';
import type { Latency, Presented } from './latency';
import type { Frame, LitParticles } from './protocol';

const RECENT_TICKS = 240;
const REMEMBERED_POSES = 256; // more than can be waiting for a frame

export const PERCENTILES = [50, 95, 99] as const;
export type Percentiles = Record<(typeof PERCENTILES)[number], Latency>;

export const hash = (value: bigint): string => value.toString(16).padStart(16, '0');

export class Statistics {
  frames = 0;
  lastFrame: Frame | undefined;
  lastDrawn: LitParticles | undefined; // of what was drawn here since the last frame
  lastLatency: Latency | undefined;
  roundTripMs: number | undefined;
  answeredPose = 0; // number of the newest pose that a frame has shown
  readonly recent: { tick: number; hash: string }[] = [];
  readonly shownRate = new Rate(2000);
  readonly byteRate = new Rate();
  readonly average = new LatencyAverage();
  readonly window = new LatencyWindow();
  private readonly inputs = new Map<number, number>(); // ms from input to sending, by number of the pose

  // To be called for a new connection.
  reset(): void {
    this.answeredPose = 0;
    this.roundTripMs = undefined;
    this.inputs.clear();
    this.average.reset();
    this.window.reset();
  }

  roundTrip(ms: number): void {
    this.roundTripMs = this.roundTripMs === undefined ? ms : this.roundTripMs + (ms - this.roundTripMs) * 0.3;
  }

  // `waited`: ms since the input that moved the camera there.
  sent(pose: number, waited: number): void {
    this.inputs.set(pose, waited);
    this.inputs.delete(pose - REMEMBERED_POSES);
  }

  // The latency of a frame that is the first to show its pose; undefined for later frames, whose pose is older than
  // they are.
  presented(frame: Frame, at: Presented): Latency | undefined {
    this.frames += 1;
    this.lastFrame = frame;
    this.lastDrawn = undefined;
    this.shownRate.add(at.presented);
    this.remember(frame);
    if (frame.poseSeq <= this.answeredPose) return undefined;
    this.answeredPose = frame.poseSeq;
    this.lastLatency = splitLatency(frame, at, this.inputs.get(frame.poseSeq));
    this.average.add(this.lastLatency);
    this.window.add(this.lastLatency);
    return this.lastLatency;
  }

  // Particles came, from which the page draws.
  drawn(message: LitParticles, now: number): void {
    if (!this.lastDrawn) this.average.reset(); // no picture is waited for
    this.frames += 1;
    this.lastDrawn = message;
    this.shownRate.add(now);
    this.remember(message);
  }

  // What is shown: a frame, or particles.
  get last(): Frame | LitParticles | undefined {
    return this.lastDrawn ?? this.lastFrame;
  }

  private remember({ tick, stateHash }: Frame | LitParticles): void {
    this.recent.push({ tick: Number(tick), hash: hash(stateHash) });
    if (this.recent.length > RECENT_TICKS) this.recent.shift();
  }

  percentiles(): Percentiles | undefined {
    const found = PERCENTILES.map((percent) => [percent, this.window.percentile(percent)] as const);
    return found.every(([, latency]) => latency) ? (Object.fromEntries(found) as Percentiles) : undefined;
  }
}
