// Converts the server's linear Rec. 709 colours to a colour field's text and back, and directions to two angles and
// back.
import { clamp } from './camera';
import type { Vec3 } from './protocol';

export function toSrgb(linear: number): number {
  const x = clamp(linear, 0, 1);
  return x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055;
}

export function toLinear(srgb: number): number {
  const x = clamp(srgb, 0, 1);
  return x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4;
}

// The "#rrggbb" of a linear colour in [0, 1].
export function toHex(colour: Vec3): string {
  const byte = (x: number): string =>
    Math.round(toSrgb(x) * 255)
      .toString(16)
      .padStart(2, '0');
  return `#${byte(colour[0])}${byte(colour[1])}${byte(colour[2])}`;
}

export function fromHex(hex: string): Vec3 {
  const value = /^#[0-9a-f]{6}$/i.test(hex) ? parseInt(hex.slice(1), 16) : 0xffffff;
  return [toLinear((value >> 16) / 255), toLinear(((value >> 8) & 255) / 255), toLinear((value & 255) / 255)];
}

// Splits a light's irradiance into an intensity and a colour whose largest channel is 1.
export function splitIrradiance(irradiance: Vec3): { colour: Vec3; intensity: number } {
  const intensity = Math.max(...irradiance);
  if (!(intensity > 0)) return { colour: [1, 1, 1], intensity: 0 };
  return { colour: [irradiance[0] / intensity, irradiance[1] / intensity, irradiance[2] / intensity], intensity };
}

export function joinIrradiance(colour: Vec3, intensity: number): Vec3 {
  const most = Math.max(...colour);
  const scale = most > 0 ? intensity / most : 0;
  return most > 0 ? [colour[0] * scale, colour[1] * scale, colour[2] * scale] : [0, 0, 0];
}

// The angles of a direction: azimuth about +Y from +Z toward +X in [0, 360), elevation above the horizon in [-90,
// 90], degrees.
export function toAngles(toLight: Vec3): { azimuth: number; elevation: number } {
  const size = Math.hypot(...toLight) || 1;
  const degrees = 180 / Math.PI;
  const azimuth = Math.atan2(toLight[0], toLight[2]) * degrees;
  return { azimuth: (azimuth + 360) % 360, elevation: Math.asin(clamp(toLight[1] / size, -1, 1)) * degrees };
}

export function fromAngles(azimuth: number, elevation: number): Vec3 {
  const a = (azimuth * Math.PI) / 180;
  const e = (elevation * Math.PI) / 180;
  return [Math.sin(a) * Math.cos(e), Math.sin(e), Math.cos(a) * Math.cos(e)];
}
