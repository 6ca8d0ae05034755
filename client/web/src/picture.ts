// From JPEG bytes to the canvas. The newest frame wins: at most one is being decoded and one waits, an older one is dropped.
import type { Frame } from './protocol';
import type { Presented } from './latency';

export interface PictureEvents {
  presented(frame: Frame, at: Presented): void;
  dropped(frame: Frame): void;
  failed(frame: Frame): void;
}

interface Arrived {
  frame: Frame;
  received: number; // ms, performance.now()
  generation: number;
}

interface Decoded extends Arrived {
  bitmap: ImageBitmap;
  decoded: number;
}

export class Picture {
  private waiting: Arrived | undefined;
  private ready: Decoded | undefined;
  private decoding = false;
  private generation = 0;
  private readonly context: ImageBitmapRenderingContext;

  constructor(
    canvas: HTMLCanvasElement,
    private readonly events: PictureEvents,
  ) {
    const context = canvas.getContext('bitmaprenderer', { alpha: false });
    if (!context) throw new Error('This browser cannot draw pictures on a canvas.');
    this.context = context;
  }

  show(frame: Frame): void {
    if (this.waiting) this.events.dropped(this.waiting.frame);
    this.waiting = { frame, received: performance.now(), generation: this.generation };
    if (!this.decoding) void this.decode();
  }

  // For a new connection: forgets what has not been drawn and tells no more about what has, since frames are numbered anew.
  clear(): void {
    this.generation += 1;
    this.waiting = undefined;
    this.ready?.bitmap.close();
    this.ready = undefined;
  }

  private async decode(): Promise<void> {
    this.decoding = true;
    while (this.waiting) {
      const arrived: Arrived = this.waiting;
      this.waiting = undefined;
      try {
        const bytes = arrived.frame.jpeg[0] ?? new Uint8Array();
        // The server tone-maps to sRGB: nothing is left to convert or to premultiply.
        const bitmap = await createImageBitmap(new Blob([bytes], { type: 'image/jpeg' }), {
          colorSpaceConversion: 'none',
          premultiplyAlpha: 'none',
        });
        this.keep({ ...arrived, bitmap, decoded: performance.now() });
      } catch (error) {
        console.error(`brume: frame ${arrived.frame.id} is not a picture:`, error);
        if (arrived.generation === this.generation) this.events.failed(arrived.frame);
      }
    }
    this.decoding = false;
  }

  private keep(decoded: Decoded): void {
    if (decoded.generation !== this.generation) {
      decoded.bitmap.close();
      return;
    }
    if (this.ready) {
      this.ready.bitmap.close();
      this.events.dropped(this.ready.frame);
    } else {
      requestAnimationFrame(() => this.draw());
    }
    this.ready = decoded;
  }

  private draw(): void {
    const drawn = this.ready;
    if (!drawn) return;
    this.ready = undefined;
    // The bitmap does not change the canvas's own size, which is what its layout goes by.
    const { canvas } = this.context;
    const { width, height } = drawn.bitmap;
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    this.context.transferFromImageBitmap(drawn.bitmap);
    // The next callback runs once the browser has taken this one's drawing: only then was the frame presented.
    requestAnimationFrame(() => {
      if (drawn.generation !== this.generation) return;
      const { frame, received, decoded } = drawn;
      this.events.presented(frame, { received, decoded, presented: performance.now() });
    });
  }
}
