// Decodes the pictures of frames and draws them on a surface. At most one frame is being decoded and one waits; a
// newer frame replaces the one that waits, which is dropped.
import type { Presented } from './latency';
import type { DepthLayers, Frame } from './protocol';

export interface PictureEvents {
  presented(frame: Frame, at: Presented): void;
  dropped(frame: Frame): void;
  failed(frame: Frame): void;
}

// What pictures are drawn on. show() takes the ownership of the bitmaps, one for each eye. `layers`: of each, where the
// frame has them; they stay the caller's.
export interface Surface {
  show(bitmaps: ImageBitmap[], frame: Frame, layers?: LayerBitmaps[]): void;
}

// Pictures of Frame.layers.
export interface LayerBitmaps {
  colours?: ImageBitmap;
  data?: ImageBitmap;
  surface?: ImageBitmap;
}

interface Arrived {
  frame: Frame;
  received: number; // ms, performance.now()
  generation: number;
}

interface Decoded extends Arrived {
  bitmaps: ImageBitmap[];
  layers: LayerBitmaps[];
  decoded: number;
}

export class Picture {
  private waiting: Arrived | undefined;
  private ready: Decoded | undefined;
  private drawn: Decoded | undefined;
  private last: Frame | undefined; // that was drawn
  private decoding = false;
  private generation = 0;

  constructor(
    private surface: Surface,
    private readonly events: PictureEvents,
  ) {}

  drawOn(surface: Surface): void {
    this.surface = surface;
  }

  show(frame: Frame): void {
    if (this.waiting) this.events.dropped(this.waiting.frame);
    this.waiting = { frame, received: performance.now(), generation: this.generation };
    if (!this.decoding) void this.decode();
  }

  // Draws the last frame once more, if no newer one is on its way: what it was drawn on has lost it.
  again(): void {
    if (this.last && !this.ready && !this.decoding) this.show(this.last);
  }

  // To be called for a new connection, which numbers its frames from 1. Frames of the old one that were not drawn are
  // forgotten, and no event tells of the others any more.
  clear(): void {
    this.generation += 1;
    this.waiting = this.drawn = this.last = undefined;
    close(this.ready);
    this.ready = undefined;
  }

  // To be called once per animation frame, before anything else draws. By then the browser has presented what the
  // animation frame before has drawn.
  draw(): void {
    const { drawn, ready } = this;
    this.drawn = this.ready = undefined;
    if (drawn) {
      const { frame, received, decoded } = drawn;
      this.events.presented(frame, { received, decoded, presented: performance.now() });
    }
    if (!ready) return;
    this.surface.show(ready.bitmaps, ready.frame, ready.layers);
    ready.layers.forEach(closeLayers);
    this.drawn = ready;
    this.last = ready.frame;
  }

  private async decode(): Promise<void> {
    this.decoding = true;
    while (this.waiting) {
      const arrived: Arrived = this.waiting;
      this.waiting = undefined;
      try {
        const { jpeg, layers = [] } = arrived.frame;
        const bitmaps = await toBitmaps(jpeg);
        this.keep({ ...arrived, bitmaps, layers: await Promise.all(layers.map(toLayers)), decoded: performance.now() });
      } catch (error) {
        console.error(`brume: frame ${arrived.frame.id} is not a picture:`, error);
        if (arrived.generation === this.generation) this.events.failed(arrived.frame);
      }
    }
    this.decoding = false;
  }

  private keep(decoded: Decoded): void {
    if (decoded.generation !== this.generation) {
      close(decoded);
      return;
    }
    if (this.ready) {
      close(this.ready);
      this.events.dropped(this.ready.frame);
    }
    this.ready = decoded;
  }
}

// The server's pictures are sRGB without alpha: the browser has nothing to convert.
const toBitmap = (bytes: Uint8Array<ArrayBuffer>): Promise<ImageBitmap> =>
  createImageBitmap(new Blob([bytes], { type: bytes[0] === 0x89 ? 'image/png' : 'image/jpeg' }), {
    colorSpaceConversion: 'none',
    premultiplyAlpha: 'none',
  });

// All or none: the browser itself frees a bitmap late.
async function toBitmaps(jpeg: readonly Uint8Array<ArrayBuffer>[]): Promise<ImageBitmap[]> {
  const tried = await Promise.allSettled(jpeg.map(toBitmap));
  const bitmaps = tried.flatMap((one) => (one.status === 'fulfilled' ? [one.value] : []));
  const failed = tried.find((one) => one.status === 'rejected');
  if (!failed) return bitmaps;
  for (const bitmap of bitmaps) bitmap.close();
  throw failed.reason;
}

// A picture whose layers cannot be read is drawn as it is.
async function toLayers({ colours, data, surface }: DepthLayers): Promise<LayerBitmaps> {
  const parts = Object.entries({ colours, data, surface }).filter(([, bytes]) => bytes.length > 0);
  try {
    const bitmaps = await toBitmaps(parts.map(([, bytes]) => bytes));
    return Object.fromEntries(parts.map(([name], i) => [name, bitmaps[i]])) as LayerBitmaps;
  } catch (error) {
    console.error('brume: layers that are no pictures:', error);
    return {};
  }
}

const closeLayers = (layers: LayerBitmaps): void =>
  Object.values(layers).forEach((bitmap: ImageBitmap) => bitmap.close());

const close = (decoded: Decoded | undefined): void => {
  decoded?.bitmaps.forEach((bitmap) => bitmap.close());
  decoded?.layers.forEach(closeLayers);
};

// A canvas that shows the first eye's picture unchanged.
export function flatSurface(canvas: HTMLCanvasElement): Surface {
  const context = canvas.getContext('bitmaprenderer', { alpha: false });
  if (!context) throw new Error('This browser cannot draw pictures on a canvas.');
  return {
    show: ([bitmap, ...rest]) => {
      for (const other of rest) other.close();
      if (!bitmap) return;
      // The bitmap does not change the canvas's width and height, which its layout uses.
      const { width, height } = bitmap;
      if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
      context.transferFromImageBitmap(bitmap);
    },
  };
}
