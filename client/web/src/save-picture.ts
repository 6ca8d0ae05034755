// The picture as a file: a still of the server from this camera, at the window's shape. A PNG may have the medium's
// box, a scale and axes drawn in, as they are over the picture.
import { drawFigure } from './box';
import { orientation } from './camera';
import type { Camera } from './camera';
import { placeText } from './place';
import type { Box } from './protocol';
import { saveFile } from './scenes';
import { requestedSize } from './size';
import type { Size } from './size';
import type { View } from './views';

export type Still = 'png' | 'cut' | 'exr'; // cut: a PNG without the sky

const LARGEST: Size = { width: 1920, height: 1080 }; // the server makes no larger ones, unless it is told to

export interface Shown {
  readonly camera: Camera;
  readonly fovY: number;
  readonly window: Size; // CSS pixels
  readonly scene: string;
  readonly view: View;
  readonly figure: Box | undefined; // the medium's box, where it is to be drawn in
}

// The address of the still, beside the page's.
export function stillAddress(kind: Still, shown: Shown, size: Size): string {
  const more: [string, string][] = [
    ['w', String(size.width)],
    ['h', String(size.height)],
  ];
  if (kind === 'cut') more.push(['alpha', '1']);
  else if (kind === 'png' && shown.view !== 'picture') more.push(['view', shown.view]);
  const query = [...placeText(shown.camera, shown.fovY), ...more].map((one) => one.join('=')).join('&');
  return `snapshot.${kind === 'exr' ? 'exr' : 'png'}?${query}`;
}

export const stillName = (kind: Still, scene: string): string =>
  `${scene}${kind === 'cut' ? '-cut-out' : ''}.${kind === 'exr' ? 'exr' : 'png'}`;

// Rejects with one line that says why there is none.
export async function savePicture(kind: Still, shown: Shown, page: string, token: string | undefined): Promise<void> {
  const size = requestedSize(shown.window.width, shown.window.height, window.devicePixelRatio, LARGEST);
  const headers = token === undefined ? {} : { Authorization: `Bearer ${token}` };
  const address = new URL(stillAddress(kind, shown, size), page);
  const answer = await fetch(address, { cache: 'no-store', headers });
  if (!answer.ok) throw new Error((await answer.text()).split('\n')[0] || `The server answered ${answer.status}.`);
  const still = await answer.blob();
  saveFile(stillName(kind, shown.scene), kind === 'png' && shown.figure ? await drawnOver(still, shown) : still);
}

async function drawnOver(still: Blob, { figure, camera, fovY, window: { height } }: Shown): Promise<Blob> {
  const picture = await createImageBitmap(still);
  const canvas = document.createElement('canvas');
  Object.assign(canvas, { width: picture.width, height: picture.height });
  const context = canvas.getContext('2d');
  if (!context || !figure) return still;
  context.drawImage(picture, 0, 0);
  const ratio = picture.height / Math.max(1, height); // lines and texts as thick and large as in the window
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  const eye = { position: camera.position, orientation: orientation(camera), fovY };
  drawFigure(context, { width: picture.width / ratio, height: picture.height / ratio }, figure, eye, 0);
  return new Promise((resolve, reject) =>
    canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error('The browser makes no PNG of it.'))), 'image/png'),
  );
}
