// The size of the pictures to ask for: the canvas's own or, if that is too large, the viewer's limit in the canvas's
// shape.
export interface Size {
  width: number;
  height: number;
}

export const SIZE_CAPS: readonly (Size & { name: string })[] = [
  { name: 'Small', width: 480, height: 270 },
  { name: 'Medium', width: 640, height: 360 },
  { name: 'Large', width: 960, height: 540 },
  { name: 'HD', width: 1280, height: 720 },
  { name: 'Full HD', width: 1920, height: 1080 },
];

// The size that a text such as '640x360' names; undefined for any other.
export function sizeOf(text: string | null): Size | undefined {
  const [, width, height] = /^(\d{2,4})x(\d{2,4})$/.exec(text ?? '') ?? [];
  return width && height ? { width: Number(width), height: Number(height) } : undefined;
}

// The limit while the viewer has not chosen one: smaller if the server's device renders in software.
export const defaultCap = (device: string): number => (/llvmpipe|lavapipe|swiftshader/i.test(device) ? 1 : 2);

const SMALLEST = 64;
const LARGEST = 4096;

// Width and height are even, since chroma planes have half of them. The cap bounds the area, so that a phone gets as
// many pixels upright as lying.
export function requestedSize(cssWidth: number, cssHeight: number, pixelRatio: number, cap: Size): Size {
  const width = Math.max(1, cssWidth * pixelRatio);
  const height = Math.max(1, cssHeight * pixelRatio);
  const shrink = Math.min(1, Math.sqrt((cap.width * cap.height) / (width * height)));
  const even = (x: number): number => Math.min(LARGEST, Math.max(SMALLEST, 2 * Math.round((x * shrink) / 2)));
  return { width: even(width), height: even(height) };
}
