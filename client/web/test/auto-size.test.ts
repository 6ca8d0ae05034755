import { describe, expect, it } from 'vitest';
import { AutoSize } from '../src/auto-size';
import { SIZE_CAPS } from '../src/size';

const MEDIUM = 1;
const SECOND = 1000;

// A server that takes `base` ms and so many more for each 100,000 pixels, asked 30 times a second.
class Session {
  readonly size = new AutoSize();
  now = 0;
  changes = 0;
  relaxed = 0;
  quality = 80;
  limit = Infinity;
  smaller = false;
  more = true;

  constructor(
    private readonly base: number,
    public each: number,
  ) {
    this.size.begin(MEDIUM);
  }

  run(seconds: number): Session {
    for (const end = this.now + seconds * SECOND; this.now < end; this.now += SECOND / 30) {
      const { width, height } = this.size.cap;
      const serverMs = this.base + (this.each * width * height) / 1e5;
      const answer = {
        serverMs,
        relaxed: this.relaxed,
        quality: this.quality,
        smaller: this.smaller,
        limit: this.limit,
      };
      if (this.size.saw(answer, this.more, this.now)) this.changes += 1;
    }
    return this;
  }
}

describe('the size that nobody chose', () => {
  it('grows within seconds while the server has time', () => {
    expect(new Session(1, 0.5).run(20).size.cap).toBe(SIZE_CAPS[4]);
    expect(new Session(1, 0.5).run(1).size.cap).toBe(SIZE_CAPS[MEDIUM]);
  });

  it('stays where a larger one would be slower than 30 pictures a second', () => {
    expect(new Session(20, 4).run(60).size.cap).toBe(SIZE_CAPS[MEDIUM]);
  });

  it('never gets smaller than it began', () => {
    expect(new Session(300, 50).run(60).size.cap).toBe(SIZE_CAPS[MEDIUM]);
  });

  it('goes back when the server gets slow, is overloaded, or the link is', () => {
    for (const harm of [
      (s: Session) => (s.each = 20),
      (s: Session) => (s.relaxed = 1),
      (s: Session) => (s.quality = 40),
      (s: Session) => (s.smaller = true),
    ]) {
      const session = new Session(1, 0.5).run(20);
      harm(session);
      expect(session.run(20).size.cap).toBe(SIZE_CAPS[MEDIUM]);
    }
  });

  it('stays after a rest, whose pictures have a higher quality', () => {
    const session = new Session(1, 0.5).run(20);
    session.quality = 100;
    session.run(5);
    session.quality = 80;
    expect(session.run(20).size.cap).toBe(SIZE_CAPS[4]);
  });

  it('does not swing where a larger size turns out too slow', () => {
    const session = new Session(1, 2);
    for (let minute = 0; minute < 60; ++minute) {
      for (let second = 0; second < 60; ++second) {
        session.each = session.size.cap === SIZE_CAPS[MEDIUM] ? 2 : 40;
        session.run(1);
      }
    }
    expect(session.changes).toBeGreaterThan(1);
    expect(session.changes).toBeLessThan(2 * 16); // twice for each wait of at most 320 s in an hour, and the first ones
  });

  it('asks for no more than the view shows and the server draws', () => {
    const small = new Session(1, 0.5);
    small.more = false;
    expect(small.run(20).size.cap).toBe(SIZE_CAPS[MEDIUM]);
    const limited = new Session(1, 0.5);
    limited.limit = 960 * 540;
    expect(limited.run(20).size.cap).toBe(SIZE_CAPS[2]);
  });
});
