// AutoSize: how large the pictures should be that nobody chose a size for. It begins with what suits the server's
// device, and grows while the server has time left. It never gets smaller than it began: methods that trace few rays
// take hardly less time for a smaller picture.
import { LINK_QUALITY } from './live';
import { SIZE_CAPS, type Size } from './size';

export interface Answer {
  serverMs: number; // that the server took for a picture
  relaxed: number; // steps of accuracy given up under overload
  quality: number; // of the JPEG, 100 at rest; at most LINK_QUALITY on a slow link
  smaller: boolean; // true: the server has sent a smaller picture than the one asked for
  limit: number; // pixels that the server draws at most
}

const FRAME_MS = 1000 / 30; // that a picture may take
const ROOM = 0.7; // part of FRAME_MS that a larger one is expected to fill at most
const LOOK_MS = 2000; // between two changes
const FIRST_WAIT_MS = 10_000; // after a size was too large; doubled each time
const LONGEST_WAIT_MS = 320_000;
const NEWEST = 0.1; // weight of the newest picture in the mean
const UNKNOWN: Size = { width: 640, height: 360 };

const area = ({ width, height }: Size): number => width * height;

export class AutoSize {
  private first = 1;
  private step = 1; // index of SIZE_CAPS
  private mean: number | undefined; // ms
  private looked: number | undefined; // ms
  private tooLarge = -Infinity; // ms, when a size was given up
  private wait = FIRST_WAIT_MS;

  get cap(): Size {
    return SIZE_CAPS[this.step] ?? UNKNOWN;
  }

  // A connection, to a server whose device suits this index of SIZE_CAPS.
  begin(first: number): void {
    [this.first, this.step, this.mean, this.looked] = [first, first, undefined, undefined];
  }

  // Hears of a picture that came at `now`, ms, asked for in the present size. `more`: true if the view would show more pixels.
  // Returns true if the size has changed.
  saw(answer: Answer, more: boolean, now: number): boolean {
    this.mean = this.mean === undefined ? answer.serverMs : this.mean + NEWEST * (answer.serverMs - this.mean);
    this.looked ??= now;
    if (now - this.looked < LOOK_MS) return false;
    this.looked = now;
    const lacking = answer.relaxed > 0 || answer.smaller || answer.quality <= LINK_QUALITY;
    const slow = lacking || this.mean > FRAME_MS;
    if (slow && this.step > this.first) {
      this.tooLarge = now;
      this.wait = Math.min(2 * this.wait, LONGEST_WAIT_MS);
      return this.change(-1);
    }
    const next = SIZE_CAPS[this.step + 1];
    if (slow || !more || !next || area(next) > answer.limit || now - this.tooLarge < this.wait) return false;
    const expected = (this.mean * area(next)) / area(this.cap);
    return expected <= ROOM * FRAME_MS && this.change(1);
  }

  private change(steps: number): true {
    this.step += steps;
    this.mean = undefined;
    return true;
  }
}
