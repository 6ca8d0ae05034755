// How long to wait before the next try to connect: 0.1 s, doubling to 1 s, with a random part, so that the viewers
// of a server that restarts do not all come back in the same instant. Behind a gateway the first tries find another
// server.
const FIRST_S = 0.1;
const LONGEST_S = 1;
// The longest wait that a server's goodbye may ask for.
const LONGEST_ASKED_S = 300;

export class Backoff {
  private tries = 0;

  constructor(private readonly random: () => number = Math.random) {}

  // Seconds to wait before the next try. `asked`: the wait that the server's goodbye asks for, or 0.
  next(asked = 0): number {
    const base = Math.min(LONGEST_S, FIRST_S * 2 ** Math.min(this.tries, 10));
    this.tries += 1;
    // Half of the step to all of it, and never less than the server asked for.
    const step = base * (0.5 + 0.5 * this.random());
    return asked > 0 ? Math.min(asked, LONGEST_ASKED_S) + step * 0.2 : step;
  }

  reset(): void {
    this.tries = 0;
  }
}
