import { afterEach, beforeEach, describe, expect, test, vi } from 'vitest';
import { Picture } from '../src/picture';
import type { Frame } from '../src/protocol';

interface Bitmap {
  byte: number;
  closed: boolean;
}

describe('pictures', () => {
  let bitmaps: Bitmap[] = [];
  let shown: number[][] = [];
  let told: string[] = [];
  let picture: Picture;

  // Its pictures are of one byte each; 0 is none that can be read.
  const frame = (id: number, ...bytes: number[]): Frame =>
    ({ id, jpeg: bytes.map((byte) => Uint8Array.of(byte)) }) as unknown as Frame;
  const settle = (): Promise<void> => new Promise((done) => setTimeout(done));

  beforeEach(() => {
    [bitmaps, shown, told] = [[], [], []];
    vi.stubGlobal('createImageBitmap', async (blob: Blob) => {
      const [byte = 0] = new Uint8Array(await blob.arrayBuffer());
      if (byte === 0) throw new Error('no picture');
      const bitmap = { byte, closed: false, close: () => (bitmap.closed = true) };
      bitmaps.push(bitmap);
      return bitmap;
    });
    vi.spyOn(console, 'error').mockImplementation(() => undefined);
    const surface = {
      show: (drawn: ImageBitmap[]) => {
        shown.push(drawn.map((bitmap) => (bitmap as unknown as Bitmap).byte));
        for (const bitmap of drawn) bitmap.close();
      },
    };
    picture = new Picture(surface, {
      presented: ({ id }) => told.push(`presented ${id}`),
      dropped: ({ id }) => told.push(`dropped ${id}`),
      failed: ({ id }) => told.push(`failed ${id}`),
    });
  });
  afterEach(() => {
    vi.unstubAllGlobals();
    vi.restoreAllMocks();
  });

  test('of which one eye cannot be read leave no bitmap behind', async () => {
    picture.show(frame(1, 5, 0));
    await settle();
    picture.draw();
    expect(told).toEqual(['failed 1']);
    expect(bitmaps).toMatchObject([{ byte: 5, closed: true }]);
  });

  test('that come faster than they are drawn are dropped, and none stays', async () => {
    for (let id = 1; id <= 200; ++id) {
      picture.show(frame(id, id));
      if (id % 3 === 0) await settle();
      if (id % 7 === 0) picture.draw();
    }
    await settle();
    picture.draw();
    picture.draw();
    expect(told.length).toBe(200); // each is told of once: the server waits for that
    expect(bitmaps.every(({ closed }) => closed)).toBe(true);
  });

  test('are drawn again on demand, the last one, unless a newer one is on its way', async () => {
    picture.again(); // there is none
    picture.show(frame(1, 1));
    await settle();
    picture.draw();
    picture.again();
    await settle();
    picture.draw();
    expect(shown).toEqual([[1], [1]]);
    picture.show(frame(2, 2));
    picture.again();
    await settle();
    picture.again();
    await settle();
    picture.draw();
    expect(shown).toEqual([[1], [1], [2]]);
    picture.clear(); // a new connection
    picture.again();
    await settle();
    picture.draw();
    expect(shown.length).toBe(3);
  });
});
