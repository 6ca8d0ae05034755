// Tells the viewer about the connection: a curtain (a full-page message) before the first picture and after a
// refusal, a status line in the corner, a countdown to the next try, and short notes. And about a scene that stands
// still, for as long as it does.
import { Announcer } from './announce';
import type { LinkState, Refusal } from './connection';
import { el, find, setText } from './dom';
import { sentence, standstillText } from './sentence';

// A note stays for as long as it takes to see it and to read it.
const NOTE_MS = 3000;
const LETTER_MS = 60;
const MOST_NOTES = 3;
// A shorter interruption, such as for another picture quality, is not shown.
const PATIENCE_MS = 500;

const REFUSALS = {
  full: { title: 'All places are taken', text: 'Everyone who fits is already watching.', status: 'Full' },
  version: {
    title: 'The server turned this page away',
    text: 'They may be of different versions: loading the page again should help.',
    status: 'Other version',
  },
  blocked: {
    title: 'The server is there, but out of reach',
    text: 'The proxy in front of it does not pass WebSockets on.',
    status: 'Proxy',
  },
  origin: {
    title: 'The server does not know this page',
    text: 'Pages of this address may not look here.',
    status: 'Not allowed',
  },
  token: {
    title: 'This page may not look here',
    text: 'It needs a token: ask for an address with one.',
    status: 'No token',
  },
  login: {
    title: 'You are signed out',
    text: 'Load this page again to sign in.',
    status: 'Signed out',
  },
  room: {
    title: 'There is no such room',
    text: 'It was closed, or never open.',
    status: 'No room',
  },
  goodbye: { title: 'The server said goodbye', text: 'It asked to come back later.', status: 'Closed' },
} as const;
// What a page that is loaded again mends.
const loads = (refusal: Refusal): boolean => refusal === 'version' || refusal === 'login';

export class Notices {
  private readonly curtain = find('curtain');
  private readonly title = find('curtain-title');
  private readonly text = find('curtain-text');
  private readonly wait = find('curtain-wait');
  private readonly retry = find<HTMLButtonElement>('curtain-retry');
  private readonly status = find('status-text');
  private readonly statusWait = find('status-wait');
  private readonly announcer = new Announcer((text) => setText(find('status-told'), text));
  private readonly view = find('view');
  private readonly toasts = find('toasts');
  private readonly standing = find('standstill');
  private retryAt: number | undefined;
  private shown: LinkState = { name: 'connecting' };
  private pending: number | undefined;
  private seen = false; // true: a picture has been shown since the page was loaded
  private lacking: string | undefined;
  private liveText = 'Live';

  constructor(retry: () => void) {
    this.retry.addEventListener('click', () => {
      if (this.shown.name === 'refused' && loads(this.shown.refusal)) location.reload();
      else retry();
    });
    window.setInterval(() => this.count(), 250);
  }

  // To be called when a picture is on the screen.
  picture(): void {
    this.seen = true;
    if (this.shown.name === 'connected') this.live();
  }

  // In what the pictures that come are less than live; undefined: in nothing, which `live` then says.
  lack(text: string | undefined, live: string): void {
    if (text === this.lacking && live === this.liveText) return;
    [this.lacking, this.liveText] = [text, live];
    document.body.classList.toggle('lacking', text !== undefined);
    if (this.shown.name === 'connected' && this.seen) this.live();
  }

  link(state: LinkState): void {
    window.clearTimeout(this.pending);
    const brief = state.name === 'reconnecting' && this.shown.name === 'connected' && this.seen;
    this.shown = state;
    if (brief) this.pending = window.setTimeout(() => this.apply(), PATIENCE_MS);
    else this.apply();
  }

  // Why no tick comes; undefined: ticks come.
  standstill(why: string | undefined): void {
    const text = why === undefined ? '' : standstillText(why);
    if (text === this.standing.textContent) return;
    this.standing.replaceChildren(...(text === '' ? [] : [el('p', { class: 'note' }, text)]));
  }

  note(text: string, kind: 'info' | 'error' = 'info'): void {
    const same = [...this.toasts.children].find((child) => child.textContent === text);
    same?.remove();
    while (this.toasts.children.length >= MOST_NOTES) this.toasts.firstElementChild?.remove();
    const note = el('p', { class: `note ${kind}` }, text);
    this.toasts.append(note);
    window.setTimeout(() => note.remove(), NOTE_MS + LETTER_MS * text.length);
  }

  private apply(): void {
    const state = this.shown;
    this.retryAt = undefined;
    switch (state.name) {
      case 'connecting':
        this.show('connecting', 'Connecting');
        this.draw('Brume', 'Connecting…', undefined);
        break;
      case 'connected':
        // The curtain stays until the first picture.
        if (this.seen) this.live();
        else {
          this.show('connecting', 'Connected');
          this.draw('Brume', 'Waiting for the first picture…', undefined);
        }
        break;
      case 'reconnecting':
        this.retryAt = state.retryAt;
        this.show('reconnecting', 'Reconnecting');
        if (!this.seen) this.draw('Brume', state.text || 'The connection was lost.', 'Try now');
        break;
      case 'refused': {
        const refusal = REFUSALS[state.refusal];
        this.retryAt = state.retryAt;
        this.show('refused', refusal.status);
        const tells = ['goodbye', 'token', 'login', 'origin', 'blocked'].includes(state.refusal);
        const own = tells && state.text ? sentence(state.text) : refusal.text;
        this.draw(refusal.title, own, loads(state.refusal) ? 'Load again' : 'Try now');
        break;
      }
    }
    this.count();
  }

  private live(): void {
    this.show('live', this.lacking ?? this.liveText);
  }

  private show(state: string, status: string): void {
    const behind = (state === 'live' || state === 'reconnecting') && this.seen;
    document.body.dataset['state'] = state;
    document.body.classList.toggle('curtained', !behind);
    this.curtain.setAttribute('aria-hidden', String(behind));
    this.curtain.inert = behind;
    this.view.inert = !behind;
    setText(this.status, status);
    this.announcer.say(status);
    this.status.title = status; // where the window is too narrow for it
  }

  private draw(title: string, text: string, retry: string | undefined): void {
    setText(this.title, title);
    setText(this.text, text);
    this.retry.hidden = retry === undefined;
    if (retry) setText(this.retry, retry);
  }

  private count(): void {
    const left = this.retryAt === undefined ? undefined : Math.ceil((this.retryAt - performance.now()) / 1000);
    const trying = this.shown.name === 'reconnecting' || this.shown.name === 'refused';
    const counted = left !== undefined && left > 0 && left < Infinity;
    const line = counted ? `Trying again in ${left} s` : trying && left !== Infinity ? 'Trying again…' : '';
    setText(this.wait, line);
    this.wait.hidden = line === '';
    setText(this.statusWait, counted && left > 1 ? `in ${left} s` : '');
  }
}
