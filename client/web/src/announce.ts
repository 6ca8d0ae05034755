// What a screen reader says of a line that changes often: not at each number, and not all the time.
const QUIET_MS = 5000; // between two announcements

const pattern = (text: string): string => text.replace(/[\d.,]+/g, '#');

export class Announcer {
  private saidAt = -Infinity;
  private said = '';
  private timer: number | undefined;

  // `tell` puts a text where screen readers hear of it.
  constructor(private readonly tell: (text: string) => void) {}

  // Of texts that come too fast the newest is told. One that differs from the last in numbers alone is not.
  say(text: string): void {
    window.clearTimeout(this.timer);
    if (pattern(text) === pattern(this.said)) return;
    const now = performance.now();
    const wait = this.saidAt + QUIET_MS - now;
    if (wait > 0) {
      this.timer = window.setTimeout(() => this.say(text), wait);
      return;
    }
    [this.said, this.saidAt] = [text, now];
    this.tell(text);
  }
}
