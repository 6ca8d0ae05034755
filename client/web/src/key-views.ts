// The viewer's key views: their list in the panel, and playing the path through them. Playing moves the camera alone,
// so that poses go out as when a hand moves it.
import type { Camera } from './camera';
import { KEY_SECONDS, KeyPath, MOST_KEYS, cameraOf, keyOf, pathOf, viewOf } from './camera-keys';
import type { CameraKey, View } from './camera-keys';
import { el, setText } from './dom';
import { button, group } from './fields';
import type { Place } from './place';

const SECONDS = 3; // of a new key

// The key views in the page's address; undefined: there are none. What cannot be used adds a sentence to `faults`.
export function pathAsked(query: URLSearchParams, faults: string[]): CameraKey[] | undefined {
  const text = query.get('path');
  const path = text === null ? undefined : pathOf(text);
  if (typeof path !== 'string') return path;
  faults.push(path);
  return undefined;
}

// Looks with that field of view, rad; undefined: the scene's.
export function useLens(viewer: { readonly wishes: { place: Place } }, fov: number | undefined): void {
  const { position, target } = viewer.wishes.place;
  viewer.wishes.place = { ...(position && { position }), ...(target && { target }), ...(fov && { fov }) };
}

export interface KeyViewsHost {
  camera(): Camera;
  fovY(): number;
  look(camera: Camera, fovY: number): void;
  note(text: string, kind?: 'info' | 'error'): void;
  copyLink(): void;
  playing(on: boolean, possible: boolean): void; // to be shown
}

export class KeyViews {
  readonly element: HTMLDetailsElement;
  private own: CameraKey[] = [];
  private path: KeyPath | undefined; // while it is played
  private begunAt = 0; // ms
  private readonly list = el('ol', { class: 'key-views', 'aria-label': 'Key views' });
  private readonly told = el('small', { role: 'status' });
  private readonly play: HTMLButtonElement;
  private readonly link: HTMLButtonElement;
  private readonly clear: HTMLButtonElement;

  constructor(private readonly host: KeyViewsHost) {
    this.play = button('Play', 'Move along the key views', () => this.toggle());
    this.link = button('Copy link', 'A link with this camera and the key views (L)', () => host.copyLink());
    this.clear = button('Remove all', 'Forget the key views', () => this.use([]));
    const add = button('Add (K)', 'The camera as it is now becomes a key view', () => this.add());
    this.element = group(
      'Key views, yours alone',
      false,
      this.list,
      this.told,
      el('div', { class: 'actions' }, add, this.play, this.link, this.clear),
    );
    this.draw();
  }

  get keys(): readonly CameraKey[] {
    return this.own;
  }

  use(keys: readonly CameraKey[]): void {
    this.stop();
    const { lowest } = KEY_SECONDS; // the first key's may be less, until it moves down
    this.own = keys.map((key, i) => (i > 0 && key.seconds < lowest ? { ...key, seconds: SECONDS } : key));
    if (keys.length > 0) this.element.open = true;
    this.draw();
  }

  add(): void {
    if (this.own.length >= MOST_KEYS) return this.host.note(`There are ${MOST_KEYS} key views: remove one.`, 'error');
    this.use([...this.own, keyOf(this.host.camera(), this.host.fovY(), SECONDS)]);
    this.host.note(`Key view ${this.own.length} was added. The settings have the list.`);
  }

  toggle(): void {
    if (this.path) return this.stop();
    if (this.own.length < 2) return this.host.note('A path takes two key views: add them with K.', 'error');
    this.path = new KeyPath(this.own);
    this.begunAt = performance.now();
    this.tell();
  }

  stop(): void {
    if (!this.path) return;
    this.path = undefined;
    this.tell();
  }

  // To be called once per animation frame.
  animate(now: number): void {
    if (!this.path) return;
    const seconds = (now - this.begunAt) / 1000;
    this.show(this.path.at(seconds));
    if (seconds >= this.path.seconds) this.stop();
  }

  private show(view: View): void {
    this.host.look(cameraOf(view), view.fovY);
  }

  private tell(): void {
    const playing = this.path !== undefined;
    setText(this.play, playing ? 'Stop' : 'Play');
    this.play.disabled = this.own.length < 2;
    this.clear.disabled = this.link.disabled = this.own.length === 0;
    this.host.playing(playing, this.own.length > 1);
  }

  private draw(): void {
    this.list.replaceChildren(...this.own.map((key, i) => this.row(key, i)));
    const seconds = this.own.length > 0 ? new KeyPath(this.own).seconds : 0;
    const count = `${this.own.length} key view${this.own.length === 1 ? '' : 's'}`;
    setText(this.told, this.own.length > 0 ? `${count}, ${Number(seconds.toFixed(2))} s` : 'None yet.');
    this.tell();
  }

  private row(key: CameraKey, i: number): HTMLElement {
    const name = `key view ${i + 1}`;
    const go = button(String(i + 1), `Go to ${name}`, () => {
      this.stop();
      this.show(viewOf(key));
    });
    const up = button('↑', `Move ${name} up`, () => {
      this.own.splice(i - 1, 0, ...this.own.splice(i, 1));
      this.use(this.own);
    });
    up.disabled = i === 0;
    const away = button('×', `Remove ${name}`, () => this.use(this.own.filter((_, at) => at !== i)));
    for (const one of [go, up, away]) one.setAttribute('aria-label', one.title);
    return el('li', {}, go, i === 0 ? el('span', {}, 'begins') : this.seconds(key, i), up, away);
  }

  private seconds(key: CameraKey, i: number): HTMLElement {
    const { lowest, highest } = KEY_SECONDS;
    const input = el('input', { type: 'number', min: String(lowest), max: String(highest), step: 'any' });
    input.value = String(Number(key.seconds.toFixed(3)));
    input.addEventListener('change', () => {
      const seconds = input.value === '' ? NaN : Number(input.value);
      if (seconds >= lowest && seconds <= highest) this.own[i] = { ...key, seconds };
      else this.host.note(`A key view takes ${lowest} to ${highest} seconds.`, 'error');
      this.use(this.own);
    });
    return el('label', { title: `Seconds from key view ${i} to ${i + 1}` }, input, ' s');
  }
}
