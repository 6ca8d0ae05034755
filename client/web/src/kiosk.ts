// A page that stands alone on a screen, in a museum for example: ?kiosk=1. It shows the picture and nothing else, goes
// on for ever, and looks after itself. The camera that turns by itself is the view's own (idle.ts).
import type { LinkState } from './connection';
import { el, setText } from './dom';
import { idleNames, idleOf } from './idle';
import { loadIfOther } from './kiosk-version';
import { sentence } from './sentence';
import { CONTROLS } from './viewer-host';

const AWAY_MS = 3000; // a shorter interruption is not told
const STILL_MS = 3000; // after which the cursor goes
const TRY_MS = 60_000; // between tries where the connection itself makes none

// Attributes of the view that the page's address asks for; undefined: no kiosk is asked for. What cannot be used is a
// sentence of `faults`.
export function kioskOf(query: URLSearchParams): { attributes: Record<string, string>; faults: string[] } | undefined {
  const asked = query.get('kiosk');
  if (asked === null || asked === '0') return undefined;
  const { wish, faults } = idleOf((name) => query.get(name));
  if (asked !== '1') faults.push('kiosk in the address is one of 0, 1.');
  const controls = query.get('controls') ?? 'touch';
  const known = CONTROLS.some((name) => name === controls);
  if (!known) faults.push(`controls in the address is one of ${CONTROLS.join(', ')}.`);
  return {
    attributes: {
      controls: known ? controls : 'touch',
      ...Object.fromEntries(idleNames.map((name) => [name, String(wish[name])])),
    },
    faults,
  };
}

// The line of a screen that shows no new pictures; '' for one that does.
export function awayText(state: LinkState): string {
  switch (state.name) {
    case 'connected':
      return '';
    case 'refused':
      return state.text ? sentence(state.text) : 'The server has no place for this screen now.';
    default:
      return 'The server is away. The picture comes back by itself.';
  }
}

interface Link {
  retryNow(): void;
}

export class Kiosk {
  private readonly line = el('p', { id: 'away', role: 'status' });
  private readonly own = [...document.querySelectorAll('script[src], link[rel=stylesheet], link[rel=modulepreload]')]
    .map((one) => one.getAttribute('src') ?? one.getAttribute('href') ?? '')
    .filter((file) => /\.(js|css)$/.test(file));
  private state: LinkState = { name: 'connecting' };
  private wasThere = false; // true: it has been connected
  private telling: number | undefined;
  private stillness: number | undefined;
  private lock: WakeLockSentinel | undefined;

  // `faults`: sentences on the address, which stand on the screen until it is mended.
  constructor(
    private readonly link: () => Link | undefined,
    private readonly faults: readonly string[],
  ) {
    document.body.classList.add('kiosk');
    document.body.append(this.line);
    setText(this.line, faults.join(' '));
    this.line.hidden = faults.length === 0;
    for (const name of ['pointerup', 'keydown']) window.addEventListener(name, this.fill);
    window.addEventListener('pointermove', () => this.moved());
    this.moved();
    document.addEventListener('visibilitychange', () => void this.keepAwake());
    void this.keepAwake();
    window.setInterval(() => this.tryAgain(), TRY_MS);
  }

  follow(state: LinkState): void {
    const before = this.state.name;
    this.state = state;
    if (state.name === 'connected' || this.line.textContent) this.tell();
    else this.telling ??= window.setTimeout(() => this.tell(), AWAY_MS);
    const back = state.name === 'connected' && before !== 'connected' && this.wasThere;
    if (back || (state.name === 'refused' && state.refusal === 'version')) void loadIfOther(this.own);
    this.wasThere ||= state.name === 'connected';
  }

  private tell(): void {
    window.clearTimeout(this.telling);
    this.telling = undefined;
    setText(this.line, awayText(this.state) || this.faults.join(' '));
    this.line.hidden = this.line.textContent === '';
  }

  // Browsers give the whole screen to who is touched, and to nobody else. Once: who leaves it wants to.
  private readonly fill = async (): Promise<void> => {
    try {
      if (!document.fullscreenElement) await document.documentElement.requestFullscreen?.();
      for (const name of ['pointerup', 'keydown']) window.removeEventListener(name, this.fill);
    } catch {
      // The next touch tries again.
    }
  };

  private moved(): void {
    document.body.classList.remove('still');
    window.clearTimeout(this.stillness);
    this.stillness = window.setTimeout(() => document.body.classList.add('still'), STILL_MS);
  }

  // Browsers take it away when the page is hidden, and have it over HTTPS and on localhost alone.
  private async keepAwake(): Promise<void> {
    if (document.hidden || (this.lock && !this.lock.released)) return;
    this.lock = await navigator.wakeLock?.request('screen').catch(() => undefined);
  }

  private tryAgain(): void {
    const { state } = this;
    if ((state.name === 'refused' || state.name === 'reconnecting') && state.retryAt === Infinity)
      this.link()?.retryNow();
    void this.keepAwake();
  }
}
