// The status line while the page is connected: what pictures lack, and why.
import { touchOnly } from './hint';
import { Steady, lack, liveText } from './live';
import { PAUSED } from './shared-settings';
import type { Viewer } from './viewer';

const SETTLED_MS = 3000; // after which the rate of pictures is known

export class LiveLine {
  private readonly steady = new Steady();
  private countedFrom = 0; // ms; pictures come without a break since then

  // `say`: as Notices.lack().
  constructor(private readonly say: (lacking: string | undefined, live: string) => void) {}

  // To be called several times a second. `asksToDraw`: this page was told to draw by itself.
  tell(viewer: Viewer, asksToDraw: boolean): void {
    const { scene, size, limit, statistics, headset, mayControl, linkState, drawing, viewing } = viewer;
    const { last } = statistics;
    const [now, frame] = [performance.now(), last?.kind === 'frame' ? last : undefined];
    const [standing, paused] = [scene?.standstill !== undefined, viewer.values.get(PAUSED) === 1];
    if (standing || paused || document.hidden || linkState !== 'connected') this.countedFrom = now;
    const seen = {
      ...{ standing, paused, mayControl, touch: touchOnly(), frame, limit },
      asked: frame && frame.follows !== 0 ? frame : size, // who follows has the size of another's pictures
      ...(scene?.preparing !== undefined ? { preparing: scene.preparing } : {}),
      relaxed: scene?.plan?.relaxed ?? 0,
      rate: now - this.countedFrom > SETTLED_MS ? statistics.shownRate.perSecond(now) : undefined,
      serverMs: frame ? frame.stages.render + frame.stages.encode : 0,
      redrawn: viewing.redrawn,
      drawnHere: drawing.shown,
      ...(scene?.notDrawable !== undefined && drawing.asked
        ? { notDrawable: { why: scene.notDrawable, asked: asksToDraw } }
        : {}),
    };
    const atOnce = standing || paused || scene?.preparing !== undefined;
    this.say(this.steady.next(headset ? undefined : lack(seen), atOnce), liveText(seen));
  }
}
