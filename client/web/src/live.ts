// What the status line says while pictures come: "Live", or in what they are less than that, why, and who can change
// it.
import type { Size } from './size';

export interface Seen {
  preparing?: string; // name of another scene that is being made ready
  standing: boolean; // true: the server says that no tick comes
  paused: boolean;
  mayControl: boolean; // true: this viewer may resume
  touch: boolean; // true: there is no keyboard
  frame: (Size & { quality: number; reduced?: 'link' | 'device' }) | undefined; // the newest, one eye, if it is shown
  asked: Size; // of one eye
  limit: number; // pixels of one eye that the server draws at most, whatever is asked for
  relaxed: number; // steps of accuracy given up under overload
  rate: number | undefined; // pictures a second; undefined while too few were seen to tell
  serverMs: number; // that the server took for the newest
  // yes: pictures are redrawn here from layers with depth. unasked: though nobody chose that. missing: they are to be,
  // and come without layers. no: neither.
  redrawn: 'yes' | 'unasked' | 'missing' | 'no';
  drawnHere: boolean; // true: what is shown is drawn here
  // Why the server cannot let this page draw, one line; absent: it can, or was not asked. `asked`: by hand.
  notDrawable?: { why: string; asked: boolean };
}

export const LINK_QUALITY = 45; // on a slow link the JPEG quality goes down to 40 before the size does
const RARE = 8; // pictures a second below which they no longer look like movement
// The same where they are redrawn: the server sends fewer when only the camera moves.
const RARE_REDRAWN = 2;
const SMALLER = 0.6; // part of the pixels asked for: the server halves both sides

// Undefined: nothing is missing.
export function lack(seen: Seen): string | undefined {
  const { standing, paused, mayControl, touch, frame, asked, limit, relaxed, rate, redrawn } = seen;
  if (standing) return 'Standing still';
  if (seen.preparing !== undefined) return `Preparing ${seen.preparing}…`;
  if (paused && !mayControl) return 'Paused: a controller can resume';
  if (paused) return touch ? 'Paused: tap Pause to resume' : 'Paused: resume with P';
  const wanted = asked.width * asked.height;
  // What the server says of it; older servers do not.
  const why = (busy: boolean): string =>
    (frame?.reduced ? frame.reduced === 'device' : busy) ? 'the server is busy' : 'the link is slow';
  if (frame && frame.width * frame.height < SMALLER * Math.min(wanted, limit)) {
    const busy = relaxed > 0 && frame.quality > LINK_QUALITY;
    return `${frame.width}×${frame.height}: ${why(busy)}`;
  }
  const rare = seen.drawnHere || redrawn === 'yes' || redrawn === 'unasked' ? RARE_REDRAWN : RARE;
  if (rate !== undefined && rate < rare) {
    const busy = seen.serverMs > 500 / rare; // most of the time between two pictures
    return `${rate.toFixed(rate < 1 ? 1 : 0)} ${seen.drawnHere ? 'updates' : 'pictures'}/s: ${why(busy)}`;
  }
  if (relaxed > 0) return 'Accuracy reduced: the server is busy';
  if (frame && frame.width * frame.height < SMALLER * wanted)
    return `${frame.width}×${frame.height}: the server’s limit`;
  if (seen.notDrawable?.asked) return `Not drawn here: ${seen.notDrawable.why}`;
  if (redrawn === 'missing') return 'No layers with depth: this way of rendering has none';
  return undefined;
}

// What is said while nothing is missing.
export function liveText({
  drawnHere,
  notDrawable,
  redrawn,
}: Pick<Seen, 'drawnHere' | 'notDrawable' | 'redrawn'>): string {
  if (drawnHere) return 'Live, drawn here';
  if (notDrawable) return `Live, not drawn here: ${notDrawable.why}`;
  return redrawn === 'unasked' ? 'Live, redrawn here between pictures' : 'Live';
}

// Says what was the same so many times in a row, so that a picture that is small for a moment makes no stir. What is
// said at once is also taken back at once.
export class Steady {
  private said: string | undefined;
  private last: string | undefined;
  private times = 0;
  private certain = false; // true: what was said last was said at once

  constructor(private readonly needed = 4) {}

  next(text: string | undefined, atOnce = false): string | undefined {
    this.times = text === this.last ? this.times + 1 : 1;
    this.last = text;
    if (atOnce || this.certain || this.times >= this.needed) this.said = text;
    this.certain = atOnce;
    return this.said;
  }
}
