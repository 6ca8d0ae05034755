// How a viewer moves to the page of another server, when its own stops: with its settings, its token and its camera.
import { beside, withSlash } from './address';
import { look, move, zoom } from './camera';
import type { Camera } from './camera';

const ASK_MS = 3000;

// The address of the page that a goodbye's URL names: the URL itself, or the page beside the socket of a ws or wss
// URL. Undefined for any other text, and for a page without TLS if this one has TLS. `here`: the address of this
// page, or of its socket.
export function pageOf(goTo: string, here: string): string | undefined {
  let page: URL;
  try {
    page = new URL(goTo);
  } catch {
    return undefined;
  }
  if (/^wss?:$/.test(page.protocol)) {
    page = new URL(page.href.replace(/^ws/, 'http'));
    page.pathname = page.pathname.replace(/[^/]*$/, '');
  } else if (page.protocol.startsWith('http')) page = withSlash(page);
  const secure = /^(https|wss):/.test(here);
  if (page.protocol !== 'https:' && (page.protocol !== 'http:' || secure)) return undefined;
  return page.href;
}

// True if a server answers at that page. Browsers do not let this page read the answer itself.
export const answers = (page: string): Promise<boolean> =>
  fetch(beside(page, 'healthz'), { mode: 'no-cors', cache: 'no-store', signal: AbortSignal.timeout(ASK_MS) }).then(
    () => true,
    () => false,
  );

// A camera as text, to the last bit.
export const cameraText = (camera: Camera): string =>
  [...camera.position, camera.yaw, camera.pitch, camera.distance].join();

// The address of that page with this viewer's query, token and camera.
export function addressAt(page: string, search: string, token: string | undefined, camera: Camera): string {
  const address = new URL(page);
  for (const [name, value] of new URLSearchParams(search)) address.searchParams.set(name, value);
  const own = new URLSearchParams({ at: cameraText(camera) });
  if (token !== undefined) own.set('token', token);
  address.hash = own.toString();
  return address.href;
}

// The camera in the fragment of such an address, or undefined.
export function cameraIn(fragment: string): Camera | undefined {
  return cameraFrom(new URLSearchParams(fragment.replace(/^#/, '')).get('at') ?? '');
}

// The camera that such a text names, within the bounds of moves, turns and zooms; or undefined.
export function cameraFrom(text: string): Camera | undefined {
  const [x, y, z, yaw, pitch, distance, ...more] = text.split(',').map(Number);
  if (x === undefined || y === undefined || z === undefined || yaw === undefined || pitch === undefined)
    return undefined;
  if (distance === undefined || more.length > 0 || ![x, y, z, yaw, pitch, distance].every(Number.isFinite))
    return undefined;
  return zoom(look(move({ position: [x, y, z], yaw, pitch, distance }, 0, 0, 0), 0, 0), 1);
}
