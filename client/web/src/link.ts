// A link to what this page shows now.
import type { Camera } from './camera';
import { placeText } from './place';

// The page's address with this camera; `more` are further parameters. It has no token.
export function linkTo(page: string, camera: Camera, fov: number, more: readonly [string, string][]): string {
  const address = new URL(page);
  address.hash = '';
  // Commas are legal in a query, and the address is for people.
  address.search = [...placeText(camera, fov), ...more].map(([name, value]) => `${name}=${value}`).join('&');
  return address.href;
}

// Puts the link into the address bar and, where the browser allows that, into the clipboard. Returns what it did, for
// people. Browsers give a clipboard to pages over HTTPS and on localhost alone.
export async function copyLink(camera: Camera, fov: number, more: readonly [string, string][]): Promise<string> {
  const link = linkTo(location.href, camera, fov, more);
  history.replaceState(history.state, '', link);
  try {
    await navigator.clipboard.writeText(link);
    return 'A link with this camera was copied. It is in the address bar, too.';
  } catch {
    return 'A link with this camera is in the address bar: copy it from there.';
  }
}
