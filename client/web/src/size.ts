// The size of the picture to ask for: the canvas's own, or as many pixels as the viewer allows, in the canvas's shape.
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

// What to ask for while the viewer has not chosen: less of a device that draws in software.
export const defaultCap = (device: string): number => (/llvmpipe|lavapipe|swiftshader/i.test(device) ? 1 : 2);

const SMALLEST = 64;
const LARGEST = 4096;

// Even numbers: chroma planes are half as wide and high. The cap bounds the area, so that an upright phone gets as many
// pixels as a lying one.
export function requestedSize(cssWidth: number, cssHeight: number, pixelRatio: number, cap: Size): Size {
  const width = Math.max(1, cssWidth * pixelRatio);
  const height = Math.max(1, cssHeight * pixelRatio);
  const shrink = Math.min(1, Math.sqrt((cap.width * cap.height) / (width * height)));
  const even = (x: number): number => Math.min(LARGEST, Math.max(SMALLEST, 2 * Math.round((x * shrink) / 2)));
  return { width: even(width), height: even(height) };
}
