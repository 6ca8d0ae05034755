// Fade: how much of a new picture covers the one before it. So its arrival is not seen. It has no clock.
const LONGEST_MS = 120; // that what is new waits
const SHORTEST_MS = 50; // between pictures, below which they look like movement by themselves

export class Fade {
  private begun = -Infinity; // ms
  private lasts = 0; // ms
  private arrived = -Infinity; // ms

  // A picture came. `withBefore`: true if there is one that it can cover.
  begin(withBefore: boolean, now: number): void {
    const apart = now - this.arrived;
    this.arrived = this.begun = now;
    this.lasts = withBefore && apart > SHORTEST_MS ? Math.min(apart, LONGEST_MS) : 0;
  }

  // 0 ... 1.
  part(now: number): number {
    return this.lasts > 0 ? Math.min(Math.max((now - this.begun) / this.lasts, 0), 1) : 1;
  }
}
