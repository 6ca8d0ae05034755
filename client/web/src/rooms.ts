// The server's rooms: where they are, and the panel's group that lists, opens and closes them.
import { beside, withSlash } from './address';
import { el, setText } from './dom';
import { button, group } from './fields';

const MOST_ROOMS = 65;
const LOOK_MS = 5000; // how often an open list is asked for
const NAME = /^[A-Za-z0-9_-]{1,32}$/;

export interface Room {
  name: string; // empty: the one at the server's own page
  page: string; // its address
  scene: string;
  viewers: number;
}

// The server's own page, of the page of one of its rooms.
export function serverOf(page: string | URL): URL {
  const address = withSlash(page);
  address.pathname = address.pathname.replace(/\/r\/[A-Za-z0-9_-]{1,32}\/$/, '/');
  address.search = address.hash = '';
  return address;
}

// The name of the room whose page this is; empty: the server's own.
export const roomOf = (page: string | URL): string =>
  /\/r\/([A-Za-z0-9_-]{1,32})\/$/.exec(withSlash(page).pathname)?.[1] ?? '';

// What GET /rooms answers. Entries that are none are left out.
export function roomsOf(answer: unknown, server: URL): Room[] {
  const list = (answer as { rooms?: unknown } | null)?.rooms;
  if (!Array.isArray(list)) return [];
  return list.slice(0, MOST_ROOMS).flatMap((one: unknown) => {
    const { name, scene, viewers } = (one ?? {}) as Record<string, unknown>;
    if (typeof name !== 'string' || typeof scene !== 'string' || typeof viewers !== 'number') return [];
    if (name !== '' && !NAME.test(name)) return [];
    return [{ name, page: beside(server, name === '' ? './' : `r/${name}/`).href, scene, viewers }];
  });
}

export interface RoomsHost {
  token(): string | undefined;
  mayOpen(): boolean; // true: an operator's
  scenes(): readonly string[]; // that a room can begin with
  note(text: string, kind?: 'info' | 'error'): void;
}

export class RoomsPanel {
  readonly element: HTMLDetailsElement;
  private readonly server = serverOf(location.href);
  private readonly list = el('ul', { class: 'rooms', 'aria-label': 'Rooms of this server' });
  private readonly name = el('input', { type: 'text', maxlength: '32', 'aria-label': 'Name of a new room' });
  private readonly scene = el('select', { 'aria-label': 'Scene of a new room' });
  private readonly open = button('Open room', 'Another scene beside this one, with people of its own', () => {
    void this.change('open', this.name.value, this.scene.value);
  });
  private readonly form = el('div', { class: 'actions' }, this.name, this.scene, this.open);
  private shown = '';

  constructor(private readonly host: RoomsHost) {
    this.name.placeholder = 'name';
    this.element = group('Rooms', false, this.list, this.form);
    this.element.addEventListener('toggle', () => this.element.open && void this.look());
    window.setInterval(() => this.element.open && this.element.offsetParent && void this.look(), LOOK_MS);
  }

  // The scenes and the role are known, or others.
  update(): void {
    this.form.hidden = !this.host.mayOpen();
    const scenes = this.host.scenes();
    if (scenes.join() === [...this.scene.options].map(({ value }) => value).join()) return;
    this.scene.replaceChildren(...scenes.map((scene) => el('option', { value: scene }, scene)));
  }

  private request(path: string, method: string): Promise<Response> {
    const token = this.host.token();
    const headers = token === undefined ? {} : { Authorization: `Bearer ${token}` };
    return fetch(beside(this.server, path), { cache: 'no-store', headers, method });
  }

  private async look(): Promise<void> {
    try {
      const answer = await this.request('rooms', 'GET');
      if (answer.ok) this.show(roomsOf(await answer.json(), this.server));
    } catch {
      // The server is away: the list stays as it is.
    }
  }

  private show(rooms: readonly Room[]): void {
    const text = JSON.stringify([rooms, this.host.mayOpen()]);
    if (text === this.shown) return; // a focus in the list stays
    this.shown = text;
    const here = roomOf(location.href);
    this.list.replaceChildren(
      ...rooms.map(({ name, page, scene, viewers }) => {
        const title = name === '' ? 'Main room' : name;
        const says = el('small');
        setText(says, `${scene}, ${viewers} watching`);
        const link = name === here ? el('strong', { 'aria-current': 'page' }, title) : el('a', { href: page }, title);
        const close = button('Close', `Close the room ${name} for everyone`, () => void this.change('close', name));
        close.setAttribute('aria-label', `Close room ${name}`);
        close.hidden = name === '' || !this.host.mayOpen();
        return el('li', {}, link, says, close);
      }),
    );
  }

  private async change(what: 'open' | 'close', name: string, scene?: string): Promise<void> {
    const query = new URLSearchParams({ name, ...(scene === undefined ? {} : { scene }) });
    this.open.disabled = true;
    try {
      const answer = await this.request(`rooms/${what}?${query.toString()}`, 'POST');
      const line = (await answer.text()).split('\n')[0] ?? '';
      this.host.note(line.slice(0, 300), answer.ok ? 'info' : 'error');
      if (answer.ok && what === 'open') this.name.value = '';
    } catch {
      this.host.note('The server did not answer.', 'error');
    }
    this.open.disabled = false;
    await this.look();
  }
}
