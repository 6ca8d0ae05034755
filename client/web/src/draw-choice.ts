// Decides who draws: this page, from lit particles, or the server, whose pictures are shown. It has no clock: callers
// pass the time, ms.
export type DrawWish = 'auto' | 'client' | 'server';
// auto: here, where a graphics card draws fast enough.
export const DRAW_WISHES: readonly DrawWish[] = ['auto', 'client', 'server'];
export const drawWishOf = (text: string | null): DrawWish => DRAW_WISHES.find((wish) => wish === text) ?? 'auto';

export const DRAW_HZ = 30; // messages a second: between them the page draws what lies between

const MOST_MS = 8; // that the graphics card may take for a picture
const MOST_BETWEEN_MS = 28; // between two pictures of the display, where the card's own time is not known
const STEADY_MS = 2000; // for which that has to last
const GAP_MS = 1000; // without pictures, after which those before say nothing: the page was hidden
const NEWEST = 0.05; // weight of the newest picture in means

export class DrawChoice {
  wished: DrawWish = 'auto';
  private unable = false; // this browser cannot
  private slow = false; // it was given up
  private mean: number | undefined; // ms
  private slowSince: number | undefined; // ms
  private lookedAt = -Infinity; // ms

  // Another choice: nothing is known.
  choose(wished: DrawWish): void {
    if (wished === this.wished) return;
    this.wished = wished;
    this.unable = this.slow = false;
    this.forget();
  }

  // True: the page should draw, if it can. `hardware`: whether a graphics card draws, which is asked where that counts.
  wants(hardware: () => boolean): boolean {
    if (this.unable || this.wished === 'server') return false;
    return this.wished === 'client' || (!this.slow && hardware());
  }

  // This browser cannot draw, whatever is wished.
  fail(): void {
    this.unable = true;
  }

  // A picture was drawn. `gpuMs`: how long the card took for the newest that is known. Returns the mean, ms, if that is
  // given up now.
  drew(now: number, gpuMs: number | undefined): number | undefined {
    const between = now - this.lookedAt;
    this.lookedAt = now;
    if (between > GAP_MS) this.forget();
    if (this.wished !== 'auto' || this.slow || between > GAP_MS) return undefined;
    const ms = gpuMs ?? between;
    this.mean = this.mean === undefined ? ms : this.mean + NEWEST * (ms - this.mean);
    const late = this.mean > (gpuMs === undefined ? MOST_BETWEEN_MS : MOST_MS);
    this.slowSince = late ? (this.slowSince ?? now) : undefined;
    if (this.slowSince === undefined || now - this.slowSince < STEADY_MS) return undefined;
    this.slow = true;
    return this.mean;
  }

  private forget(): void {
    this.mean = this.slowSince = undefined;
  }
}
