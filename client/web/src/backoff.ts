// How long to wait before the next try to connect: 0.25 s doubling to 1 s, with jitter so that viewers of a server that
// restarts do not all come back in the same instant.
const FIRST_S = 0.25;
const LONGEST_S = 1;
// The longest wait that a server's goodbye may ask for.
const LONGEST_ASKED_S = 300;

export class Backoff {
  private tries = 0;

  constructor(private readonly random: () => number = Math.random) {}

  // Seconds to wait now; `asked` is what the server's goodbye asked for, 0 when it asked for nothing.
  next(asked = 0): number {
    const base = Math.min(LONGEST_S, FIRST_S * 2 ** Math.min(this.tries, 10));
    this.tries += 1;
    // Half to all of the step; what the server asked for is never cut short.
    const step = base * (0.5 + 0.5 * this.random());
    return asked > 0 ? Math.min(asked, LONGEST_ASKED_S) + step * 0.2 : step;
  }

  reset(): void {
    this.tries = 0;
  }
}
