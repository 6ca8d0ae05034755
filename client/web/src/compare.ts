// Shows what the page draws beside the server's picture of the same camera, and their difference, in a dialog.
import { beside } from './address';
import { orientation, pivot } from './camera';
import type { Camera } from './camera';
import { el } from './dom';
import type { Drawing } from './drawing';
import type { Area } from './program';
import { symmetric } from './projection';
import type { LitParticles } from './protocol';
import type { Size } from './size';
import { requestedSize } from './size';
import { hash } from './statistics';
import type { Viewing } from './viewing';

const TIMES = 8; // what differences are multiplied by
const LARGEST: Size = { width: 1920, height: 1080 }; // the server makes no larger ones, unless it is told to

interface Compared {
  readonly camera: Camera;
  readonly fovY: number;
  readonly viewing: Viewing;
  readonly drawing: Drawing;
}

interface Snapshot {
  bitmap: ImageBitmap;
  tick: number;
  state: string; // hash
}

// Throws an Error that says in one line why there is nothing to compare.
export async function compare(viewer: Compared, token: string | undefined): Promise<void> {
  const { camera, fovY, viewing } = viewer;
  const { width, height } = viewing.drawnSize;
  const snapshot = await snapshotOf(camera, fovY, requestedSize(width, height, 1, LARGEST), token);
  const own = drawnHere(viewer, camera, fovY, snapshot.bitmap);
  if (!own) throw new Error('Nothing is drawn here now.');
  const theirs = pixelsOf(snapshot.bitmap);
  const { picture, mean, largest } = differenceOf(own.picture, theirs);
  const same = hash(own.message.stateHash) === snapshot.state;
  const ticks = snapshot.tick - Number(own.message.tick);
  const moved = same ? 'Both show the same state.' : `The medium moved by ${ticks} ticks between the two.`;
  show(`${moved} They differ by ${mean.toFixed(2)} of 255 on average, and by ${largest} at most.`, [
    [`Drawn here, tick ${own.message.tick}`, own.picture],
    [`The server’s picture, tick ${snapshot.tick}`, theirs],
    [`Difference × ${TIMES}`, picture],
  ]);
}

async function snapshotOf(
  camera: Camera,
  fov: number,
  { width, height }: Size,
  token: string | undefined,
): Promise<Snapshot> {
  const asked = new URLSearchParams({
    ...{ position: camera.position.join(), target: pivot(camera).join(), fov: String(fov) },
    ...{ w: String(width), h: String(height) },
  });
  const headers = token === undefined ? {} : { Authorization: `Bearer ${token}` };
  const answer = await fetch(beside(location.href, `snapshot.png?${asked}`), { cache: 'no-store', headers });
  if (!answer.ok) throw new Error((await answer.text()).split('\n')[0] || `The server answered ${answer.status}.`);
  const bitmap = await createImageBitmap(await answer.blob(), {
    colorSpaceConversion: 'none',
    premultiplyAlpha: 'none',
  });
  return { bitmap, tick: Number(answer.headers.get('Brume-Tick')), state: answer.headers.get('Brume-State') ?? '' };
}

// The newest particles that came, seen from that camera.
function drawnHere(
  { viewing, drawing }: Compared,
  camera: Camera,
  fovY: number,
  { width, height }: Size,
): { picture: ImageData; message: LitParticles } | undefined {
  const gl = viewing.context();
  if (!gl) return undefined;
  const [texture, framebuffer] = [gl.createTexture(), gl.createFramebuffer()];
  gl.activeTexture(gl.TEXTURE0);
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA8, width, height);
  gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
  const view = {
    position: camera.position,
    orientation: orientation(camera),
    frustum: symmetric(fovY, width / height),
  };
  const area: Area = { framebuffer, x: 0, y: 0, width, height };
  const message = drawing.drawNewest(view, area);
  const upward = new Uint8ClampedArray(4 * width * height);
  gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, upward);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.deleteFramebuffer(framebuffer);
  gl.deleteTexture(texture);
  const picture = new ImageData(width, height);
  for (let row = 0; row < height; ++row) {
    const from = 4 * width * (height - 1 - row);
    picture.data.set(upward.subarray(from, from + 4 * width), 4 * width * row);
  }
  return message && { picture, message };
}

function pixelsOf(bitmap: ImageBitmap): ImageData {
  const { width, height } = bitmap;
  const context = new OffscreenCanvas(width, height).getContext('2d');
  if (!context) throw new Error('This browser cannot read pictures.');
  context.drawImage(bitmap, 0, 0);
  bitmap.close();
  return context.getImageData(0, 0, width, height);
}

export function differenceOf(a: ImageData, b: ImageData): { picture: ImageData; mean: number; largest: number } {
  const picture = new ImageData(a.width, a.height);
  let [sum, largest] = [0, 0];
  for (let i = 0; i < picture.data.length; ++i) {
    const alpha = i % 4 === 3;
    const apart = alpha ? 0 : Math.abs((a.data[i] ?? 0) - (b.data[i] ?? 0));
    picture.data[i] = alpha ? 255 : TIMES * apart;
    sum += apart;
    largest = Math.max(largest, apart);
  }
  return { picture, mean: sum / (3 * a.width * a.height), largest };
}

function show(line: string, pictures: readonly (readonly [caption: string, picture: ImageData])[]): void {
  const dialog = el('dialog', { class: 'compare', 'aria-label': 'What is drawn here beside the server’s picture' });
  const figures = pictures.map(([caption, picture]) => {
    const canvas = el('canvas', { width: String(picture.width), height: String(picture.height) });
    canvas.getContext('2d')?.putImageData(picture, 0, 0);
    return el('figure', {}, canvas, el('figcaption', {}, caption));
  });
  const close = el('button', { type: 'button' }, 'Close');
  close.addEventListener('click', () => dialog.close());
  dialog.addEventListener('close', () => dialog.remove());
  dialog.append(el('div', { class: 'pictures' }, ...figures), el('p', {}, line), close);
  document.body.append(dialog);
  dialog.showModal();
}
