// <brume-view>: a viewer as an element. README.md lists its attributes, properties and events.
import type { Camera } from './camera';
import { socketAddress } from './address';
import type { LinkState } from './connection';
import { el, setText } from './dom';
import { DRAW_WISHES, drawWishOf } from './draw-choice';
import { idleNames, idleOf } from './idle';
import { watchIdle } from './idle-view';
import type { Latency } from './latency';
import { placeOf } from './place';
import type { Place } from './place';
import type { Frame, SceneState, Welcome } from './protocol';
import { renewal } from './renewal';
import type { Report } from './report';
import { sentence, standstillText } from './sentence';
import { sizeOf } from './size';
import { Viewer } from './viewer';
import { CONTROLS, controlOf } from './viewer-host';
import type { Wishes } from './viewer-host';
import { EYES, REPROJECTIONS, eyesOf, reprojectionOf } from './viewing';
import { VIEWS, viewOf } from './views';

export interface BrumeViewEvents {
  statechange: LinkState;
  welcome: Welcome;
  scenechange: SceneState;
  picture: { frame: Frame; latency: Latency | undefined };
  drawn: { tick: bigint; stateHash: bigint };
  note: { text: string; kind: 'info' | 'error' };
  modechange: undefined;
  touched: undefined;
  people: undefined;
  token: { token: string }; // another one, which the server takes
  moved: { page: string };
}

const HOW = 'Arrow keys turn, W A S D Q E fly. Drag to turn, scroll to zoom, hold Ctrl or Alt and drag to push.';
const STYLE = `
  :host { display: block; position: relative; overflow: hidden; min-width: 64px; min-height: 64px; outline: none;
    background: #0b0f14; touch-action: none; user-select: none; cursor: grab; }
  :host([hidden]) { display: none; }
  :host(:active) { cursor: grabbing; }
  :host([controls='none']) { touch-action: auto; cursor: default; }
  :host(:focus-visible) .ring { outline: 2px solid rgb(156 196 238 / 55%); outline-offset: -2px; }
  :host(:focus-visible) .quiet { outline: none; }
  canvas, .ring { position: absolute; inset: 0; width: 100%; height: 100%; pointer-events: none; }
  .view { object-fit: cover; }
  .view.whole { object-fit: contain; }
  [hidden] { display: none; }
  .cursor { position: absolute; left: -32px; top: -32px; width: 64px; height: 64px; border-radius: 50%; opacity: 0;
    box-sizing: border-box; border: 1.5px solid rgb(255 255 255 / 75%); pointer-events: none;
    background: radial-gradient(rgb(255 255 255 / 22%), transparent 70%); transition: opacity 0.2s; }
  .cursor.active { opacity: 1; }
  @media (prefers-reduced-motion: reduce) { .cursor { transition: none; } }
  .message { position: absolute; inset: auto 0 0; margin: 0; padding: 8px 12px; color: #e9eef4; pointer-events: none;
    background: rgb(13 18 25 / 84%); font: 13px/1.4 system-ui, sans-serif; text-align: center; }
`;
// Attributes but those of the place; any text is right for the others.
const oneOf = (...names: readonly string[]) => ({
  holds: (text: string): boolean => names.includes(text),
  text: `one of ${names.join(', ')}`,
});
const ALLOWED = {
  eyes: oneOf(...EYES),
  reproject: oneOf(...REPROJECTIONS),
  draw: oneOf(...DRAW_WISHES),
  controls: oneOf(...CONTROLS),
  view: oneOf(...VIEWS),
  size: { holds: (text: string): boolean => sizeOf(text) !== undefined, text: 'width and height in pixels: 640x360' },
  quality: {
    holds: (text: string): boolean => /^\d{1,3}$/.test(text) && Number(text) <= 100,
    text: 'a whole number from 1 to 100; 0 is the server’s choice',
  },
};

const sheet = new CSSStyleSheet();
sheet.replaceSync(STYLE);

export class BrumeView extends HTMLElement {
  static readonly observedAttributes = [
    ...[
      'src',
      'token',
      'position',
      'target',
      'fov',
      'eyes',
      'reproject',
      'draw',
      'predict',
      'quality',
      'size',
      'controls',
      'box',
      'view',
      'name',
      ...idleNames,
    ],
  ];
  // The camera to begin with, in place of the attributes: of a viewer that was here before.
  arrived: { camera: Camera; scene?: string | undefined } | undefined;
  readonly canvas = el('canvas', { class: 'view', width: '2', height: '2', 'aria-hidden': 'true' });
  readonly warped = el('canvas', { width: '2', height: '2', 'aria-hidden': 'true' });
  private readonly drawing = el('canvas', { class: 'drawing', width: '2', height: '2', 'aria-hidden': 'true' });
  private readonly cursor = el('div', { class: 'cursor' });
  private readonly ring = el('div', { class: 'ring' });
  private readonly message = el('p', { class: 'message', part: 'message', role: 'status' });
  private running: Viewer | undefined;
  private watching = new AbortController(); // of who has not touched it
  private due = false; // true: attributes that need another connection have changed
  private line = ''; // that tells of the connection or the scene
  private faults = ''; // sentences on attributes that cannot be used

  constructor() {
    super();
    this.warped.hidden = this.drawing.hidden = this.message.hidden = true;
    const root = this.attachShadow({ mode: 'open' });
    root.adoptedStyleSheets = [sheet];
    root.append(this.canvas, this.warped, this.drawing, this.ring, this.cursor, this.message);
    // The keyboard's focus ring is for who came by keyboard.
    this.addEventListener('pointerdown', () => this.ring.classList.add('quiet'));
    this.addEventListener('blur', () => this.ring.classList.remove('quiet'));
  }

  // The viewer behind it; undefined while the element has no src, or is in no document.
  get viewer(): Viewer | undefined {
    return this.running;
  }

  get report(): Report | undefined {
    return this.running?.report;
  }

  connectedCallback(): void {
    if (!this.hasAttribute('tabindex')) this.tabIndex = 0;
    // With keys of its own it is more than a picture to a screen reader, which leaves them to it then.
    const still = this.getAttribute('controls') === 'none';
    if (!this.hasAttribute('role')) this.setAttribute('role', still ? 'img' : 'application');
    if (!this.hasAttribute('aria-label')) this.setAttribute('aria-label', still ? 'A cloud.' : `A cloud. ${HOW}`);
    this.restart();
  }

  disconnectedCallback(): void {
    this.watching.abort();
    this.running?.stop();
    this.running = undefined;
  }

  attributeChangedCallback(name: string, before: string | null, now: string | null): void {
    if (before === now || !this.isConnected) return;
    const viewer = this.running;
    const place = this.place();
    switch (name) {
      case 'src':
      case 'token':
        if (this.due) return;
        this.due = true; // both may change in one step
        queueMicrotask(() => {
          this.due = false;
          if (this.isConnected) this.restart();
        });
        break;
      case 'position':
      case 'target':
      case 'fov':
        viewer?.moveTo(place);
        break;
      case 'eyes':
      case 'reproject':
        viewer?.choose(eyesOf(this.getAttribute('eyes')), reprojectionOf(this.getAttribute('reproject')));
        break;
      case 'draw':
        viewer?.chooseDraw(drawWishOf(now));
        break;
      case 'name':
        viewer?.people.rename(now ?? '');
        break;
      case 'quality':
        viewer?.setQuality(this.wishes().quality);
        break;
      case 'idle':
      case 'turn':
      case 'home':
        this.watch();
        break;
      default:
        if (viewer) Object.assign(viewer.wishes, this.wishes(), { place: viewer.wishes.place });
        viewer?.resize();
    }
  }

  override addEventListener<K extends keyof BrumeViewEvents>(
    name: K,
    listener: (event: CustomEvent<BrumeViewEvents[K]>) => void,
    options?: AddEventListenerOptions | boolean,
  ): void;
  override addEventListener<K extends keyof HTMLElementEventMap>(
    name: K,
    listener: (event: HTMLElementEventMap[K]) => void,
    options?: AddEventListenerOptions | boolean,
  ): void;
  override addEventListener(name: string, listener: never, options?: AddEventListenerOptions | boolean): void {
    super.addEventListener(name, listener, options);
  }

  private tell<K extends keyof BrumeViewEvents>(name: K, detail: BrumeViewEvents[K]): boolean {
    return this.dispatchEvent(new CustomEvent(name, { detail, cancelable: true }));
  }

  // What cannot be used of the attributes is told as one note, and stands in the view until it is mended.
  private place(): Place {
    const { place, faults } = placeOf((name) => this.getAttribute(name));
    for (const [name, allowed] of Object.entries(ALLOWED)) {
      const text = this.getAttribute(name);
      if (text !== null && !allowed.holds(text)) faults.push(`${name} takes ${allowed.text}.`);
    }
    faults.push(...idleOf((name) => this.getAttribute(name)).faults);
    const before = this.faults;
    this.faults = faults.join(' ');
    if (this.faults !== '' && this.faults !== before) this.tell('note', { text: this.faults, kind: 'error' });
    this.showLine(this.line);
    return place;
  }

  private wishes(): Wishes {
    const quality = this.getAttribute('quality') ?? '';
    return {
      cap: sizeOf(this.getAttribute('size')),
      quality: ALLOWED.quality.holds(quality) ? Number(quality) : 0,
      predict: this.hasAttribute('predict'),
      control: controlOf(this.getAttribute('controls')),
      place: {},
      box: this.hasAttribute('box'),
      view: viewOf(this.getAttribute('view')),
    };
  }

  private restart(): void {
    this.watching.abort();
    const was = this.running;
    was?.stop();
    this.running = undefined;
    const src = this.getAttribute('src');
    if (src === null) return;
    const keys = this.getAttribute('keys') === 'window' ? window : this;
    const { canvas, warped, drawing } = this;
    const wishes = { ...this.wishes(), place: this.place() };
    const address = socketAddress(src, this.getAttribute('token') ?? undefined);
    const viewer = new Viewer({ surface: this, canvas, warped, drawing, keys }, wishes, address, {
      link: (state) => {
        this.say(state);
        this.tell('statechange', state);
      },
      welcome: (welcome) => void this.tell('welcome', welcome),
      scene: (scene) => {
        this.showLine(scene.standstill === undefined ? '' : standstillText(scene.standstill));
        this.tell('scenechange', scene);
      },
      picture: (frame, latency) => void this.tell('picture', { frame, latency }),
      drawn: ({ tick, stateHash }) => void this.tell('drawn', { tick, stateHash }),
      people: () => void this.tell('people', undefined),
      renew: async () => {
        const another = await renewal(this.getAttribute('token-url'));
        if (another && 'token' in another) this.tell('token', another);
        return another;
      },
      note: (text, kind) => void this.tell('note', { text: sentence(text), kind }),
      changed: () => void this.tell('modechange', undefined),
      touched: () => void this.tell('touched', undefined),
      pushed: (active, x, y) => {
        const box = this.getBoundingClientRect();
        this.cursor.classList.toggle('active', active);
        this.cursor.style.transform = `translate(${x - box.left}px, ${y - box.top}px)`;
      },
      // Unless a listener prevents it, the view goes on at the other server, with its camera.
      moved: (page) => {
        if (!this.tell('moved', { page })) return;
        this.arrived = { camera: viewer.camera };
        this.setAttribute('src', page);
      },
    });
    viewer.people.rename(this.getAttribute('name') ?? '');
    viewer.arrived = this.arrived;
    this.arrived = undefined;
    this.running = viewer;
    viewer.choose(eyesOf(this.getAttribute('eyes')), reprojectionOf(this.getAttribute('reproject')));
    viewer.chooseDraw(drawWishOf(this.getAttribute('draw')));
    viewer.start();
    this.watch();
  }

  // With the attribute `idle` the camera turns by itself when nobody has touched it.
  private watch(): void {
    this.watching.abort();
    this.watching = new AbortController();
    if (!this.hasAttribute('idle') || !this.running) return;
    const { wish } = idleOf((name) => this.getAttribute(name));
    watchIdle(this, this.running, wish, this.watching.signal);
  }

  // One line about a connection that is not there, for pages that say nothing about it themselves. The same line tells
  // of a scene that stands still.
  private say(state: LinkState): void {
    const text = {
      connecting: () => 'Connecting…',
      connected: () => '',
      reconnecting: () => 'Reconnecting…',
      refused: () => (state.name === 'refused' && state.text ? sentence(state.text) : 'The server turned this away.'),
    }[state.name]();
    this.showLine(text);
  }

  private showLine(text: string): void {
    this.line = text;
    setText(this.message, text || this.faults);
    this.message.hidden = this.message.textContent === '' || this.hasAttribute('quiet');
  }
}

export function defineBrumeView(): void {
  if (!customElements.get('brume-view')) customElements.define('brume-view', BrumeView);
}

declare global {
  interface HTMLElementTagNameMap {
    'brume-view': BrumeView;
  }
}
