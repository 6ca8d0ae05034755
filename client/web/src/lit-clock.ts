// LitClock says which moment of the scene to draw now: between the two newest messages, one interval of theirs late.
// Where they come unevenly, it is later still. It has no clock: callers pass the time, ms.
const TICK_MS = 1000 / 60;
const NEWEST = 0.1; // weight of the newest message in means
const LOST_MS = 500; // by which arrivals leave what is expected, after which nothing is known

export class LitClock {
  interval = 2; // ticks between messages, a mean
  private begin: number | undefined; // when tick 0 would have arrived, a mean
  private uneven = 0; // ms between arrivals and when they were expected, a mean
  private newest = -Infinity; // tick
  private shown = -Infinity; // tick, with a fraction

  // A message of this tick came.
  came(tick: number, now: number): void {
    const begin = now - tick * TICK_MS;
    const off = this.begin === undefined ? Infinity : begin - this.begin;
    if (tick < this.newest || this.begin === undefined || Math.abs(off) > LOST_MS) {
      if (tick < this.newest) this.shown = -Infinity; // the scene has begun anew
      [this.begin, this.uneven] = [begin, 0];
    } else {
      this.begin += NEWEST * off;
      this.uneven += NEWEST * (Math.abs(off) - this.uneven);
      this.interval += NEWEST * (Math.min(tick - this.newest, this.longest) - this.interval);
    }
    this.newest = tick;
  }

  // Ticks between messages, above which the scene stood still between them, or was not told of.
  get longest(): number {
    return 4 * this.interval + 8;
  }

  // The tick to draw, with a fraction: at most the newest message's.
  at(now: number): number {
    if (this.begin === undefined) return this.newest;
    const late = this.interval + Math.min((2 * this.uneven) / TICK_MS, this.interval);
    const wanted = Math.min((now - this.begin) / TICK_MS - late, this.newest);
    // It waits rather than go back, unless that would take long.
    if (wanted > this.shown || wanted < this.shown - 2 * this.interval - 4) this.shown = wanted;
    return this.shown;
  }
}
