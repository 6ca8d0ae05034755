// Where a server that stops sends its viewers: to the page of another one, with what they have here.
import { look, move, zoom } from './camera';
import type { Camera } from './camera';

const ASK_MS = 3000;

// The page that a goodbye's URL names: itself, or the page beside the socket of a ws or wss URL. Nothing for any other text, and
// nothing that leads from TLS to none. `here`: the address of this page.
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

// Whether anybody is there. The answer itself is not for other pages' eyes.
export const answers = (page: string): Promise<boolean> =>
  fetch(new URL('healthz', page), { mode: 'no-cors', cache: 'no-store', signal: AbortSignal.timeout(ASK_MS) }).then(
    () => true,
    () => false,
  );

const numbersOf = (camera: Camera): number[] => [...camera.position, camera.yaw, camera.pitch, camera.distance];

// The address of that page for this viewer: same wishes, same token, same camera.
export function addressAt(page: string, search: string, token: string | undefined, camera: Camera): string {
  const address = new URL(page);
  for (const [name, value] of new URLSearchParams(search)) address.searchParams.set(name, value);
  const own = new URLSearchParams({ at: numbersOf(camera).join() });
  if (token !== undefined) own.set('token', token);
  address.hash = own.toString();
  return address.href;
}

// The camera that such an address brings along.
export function cameraIn(fragment: string): Camera | undefined {
  const at = new URLSearchParams(fragment.replace(/^#/, '')).get('at');
  const [x, y, z, yaw, pitch, distance, ...more] = at?.split(',').map(Number) ?? [];
  if (x === undefined || y === undefined || z === undefined || yaw === undefined || pitch === undefined)
    return undefined;
  if (distance === undefined || more.length > 0 || ![x, y, z, yaw, pitch, distance].every(Number.isFinite))
    return undefined;
  // Within the bounds that moves, turns and zooms keep to.
  return zoom(look(move({ position: [x, y, z], yaw, pitch, distance }, 0, 0, 0), 0, 0), 1);
}
