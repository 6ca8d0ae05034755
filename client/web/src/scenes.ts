// Another scene for everyone: by its name, or a file that this viewer has (PLY, NRRD); and what is shown now
// as a file. Over HTTP, with the token of the page.
import { beside } from './address';
import type { Camera } from './camera';
import { pathText } from './camera-keys';
import type { CameraKey } from './camera-keys';
import { placeText } from './place';

const LONGEST_NAME = 40;

// The name under which the server keeps a file's points: what it allows of the file's own name.
export function cloudName(file: string): string {
  const stem = file.replace(/\.[^./]*$/, '');
  const name = stem.replace(/[^A-Za-z0-9_-]+/g, '-').replace(/^-+|-+$/g, '');
  return name.slice(0, LONGEST_NAME) || 'uploaded';
}

// What a viewer says of a file: the server's names, `auto` for a unit that it finds out by itself.
export interface FileFrame {
  unit: string;
  up: string;
}
export const UNITS = ['auto', 'm', 'cm', 'mm', 'um', 'km', 'in', 'ft'];
export const UPS = ['y', 'z', 'x', '-y'];

// The server's answer as a note: what is shown, and what was guessed or left out. Its second line is the log's.
export function noteOf(answer: string): string {
  const [shown = '', , ...notes] = answer.split('\n');
  return [shown, ...notes].join('\n');
}

export class Scenes {
  constructor(
    private readonly page: string, // address of the server's page
    private readonly token: () => string | undefined,
  ) {}

  // Each resolves with the server's line, and rejects with one that says why not.
  show(name: string): Promise<string> {
    return this.post('scene', encodeURIComponent(name));
  }

  showCloud(file: File, { unit, up }: FileFrame): Promise<string> {
    const query = `&up=${up}${unit === 'auto' ? '' : `&unit=${unit}`}`;
    return this.post('cloud', cloudName(file.name) + query, file);
  }

  // The scene as it was tuned, seen from this camera and with these key views, as text.
  async toml(camera: Camera, fov: number, keys: readonly CameraKey[] = []): Promise<string> {
    const query = [...placeText(camera, fov), ['path', pathText(keys)]];
    return this.ask(`scene.toml?${query.map((one) => one.join('=')).join('&')}`, {});
  }

  private post(route: string, name: string, body?: File): Promise<string> {
    return this.ask(`${route}?name=${name}`, { method: 'POST', ...(body && { body }) });
  }

  private async ask(address: string, request: RequestInit): Promise<string> {
    const token = this.token();
    const headers = token === undefined ? {} : { Authorization: `Bearer ${token}` };
    let answer: Response;
    try {
      answer = await fetch(beside(this.page, address), { cache: 'no-store', headers, ...request });
    } catch {
      throw new Error('The server did not answer: is the connection there, and the file not too large for it?');
    }
    const text = (await answer.text()).trim();
    if (answer.ok) return text;
    // The server's own refusals are plain text; a page of HTML is a proxy's.
    const own = answer.headers.get('content-type')?.startsWith('text/plain') ?? false;
    if (!own && answer.status === 413)
      throw new Error('The proxy in front of this server takes no file so large: see docs/deploy.md.');
    throw new Error((own && text.split('\n')[0]) || `The server answered ${answer.status}.`);
  }
}

// Hands a text or bytes to the browser as a file to save.
export function saveFile(name: string, content: string | Blob): void {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(
    content instanceof Blob ? content : new Blob([content], { type: 'application/toml' }),
  );
  link.download = name;
  link.click();
  window.setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

// Calls `opened` with a file that the viewer chooses. To be called in the handler of a click.
export function chooseFile(opened: (file: File) => void): void {
  const input = document.createElement('input');
  Object.assign(input, { type: 'file', accept: '.ply,.nrrd' });
  input.addEventListener('change', () => input.files?.[0] && opened(input.files[0]));
  input.click();
}

// Calls `dropped` with a file that is dropped anywhere on the page, while `allowed`. `over`: one is held above it.
export function onDrop(allowed: () => boolean, over: (on: boolean) => void, dropped: (file: File) => void): void {
  const has = (event: DragEvent): boolean => event.dataTransfer?.types.includes('Files') ?? false;
  window.addEventListener('dragover', (event) => {
    if (!has(event)) return;
    event.preventDefault(); // else the browser would leave the page for the file
    if (event.dataTransfer) event.dataTransfer.dropEffect = allowed() ? 'copy' : 'none';
    over(allowed());
  });
  window.addEventListener('dragleave', (event) => event.relatedTarget ?? over(false));
  window.addEventListener('drop', (event) => {
    if (!has(event)) return;
    event.preventDefault();
    over(false);
    const file = event.dataTransfer?.files[0];
    if (file && allowed()) dropped(file);
  });
}
