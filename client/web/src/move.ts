// How a viewer moves to the page of another server, when its own stops: with its settings, its token and its camera.
import { look, move, zoom } from './camera';
import type { Camera } from './camera';

const ASK_MS = 3000;

// The address of the page that a goodbye's URL names: the URL itself, or the page beside the socket of a ws or wss
// URL. Undefined for any other text, and for a page without TLS if this one has TLS. `here`: the address of this
// page.
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
  }
  if (page.protocol !== 'https:' && (page.protocol !== 'http:' || here.startsWith('https:'))) return undefined;
  return page.href;
}

// True if a server answers at that page. Browsers do not let this page read the answer itself.
export const answers = (page: string): Promise<boolean> =>
  fetch(new URL('healthz', page), { mode: 'no-cors', cache: 'no-store', signal: AbortSignal.timeout(ASK_MS) }).then(
    () => true,
    () => false,
  );

const numbersOf = (camera: Camera): number[] => [...camera.position, camera.yaw, camera.pitch, camera.distance];

// The address of that page with this viewer's query, token and camera.
export function addressAt(page: string, search: string, token: string | undefined, camera: Camera): string {
  const address = new URL(page);
  for (const [name, value] of new URLSearchParams(search)) address.searchParams.set(name, value);
  const own = new URLSearchParams({ at: numbersOf(camera).join() });
  if (token !== undefined) own.set('token', token);
  address.hash = own.toString();
  return address.href;
}

// The camera in the fragment of such an address, or undefined.
export function cameraIn(fragment: string): Camera | undefined {
  const at = new URLSearchParams(fragment.replace(/^#/, '')).get('at');
  const [x, y, z, yaw, pitch, distance, ...more] = at?.split(',').map(Number) ?? [];
  if (x === undefined || y === undefined || z === undefined || yaw === undefined || pitch === undefined)
    return undefined;
  if (distance === undefined || more.length > 0 || ![x, y, z, yaw, pitch, distance].every(Number.isFinite))
    return undefined;
  // Clamped to the bounds of moves, turns and zooms.
  return zoom(look(move({ position: [x, y, z], yaw, pitch, distance }, 0, 0, 0), 0, 0), 1);
}
