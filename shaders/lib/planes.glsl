// The planes that JPEG (JFIF) takes, as server/render/picture.h lays them out, in words of four bytes: full-range BT.601 Y, Cb, Cr
// with 4:2:0 chroma, 128 added to Cb and Cr. Where kFull holds: sRGB R, G, B of all pixels instead. Include after the eye is declared.
#include "shaders/shared/constants.h"
#include "shaders/lib/whole.glsl"

layout(constant_id = kIdFull) const bool kFull = false;

const vec3 kLuma = vec3(0.299, 0.587, 0.114);
const vec3 kCb = vec3(-0.168735892, -0.331264108, 0.5), kCr = vec3(0.5, -0.418687589, -0.081312411);

// The byte of a value in [0, 255], or beyond, as the n-th of its word.
uint byteOf(float value, uint n) { return nearestWhole(clamp(value, 0, 255)) << (8 * (n % 4)); }

uint lumaWords() { return (eye.size.x + 7) / 8 * 2; } // of a row; a row of Cb or Cr has half
uint crWords() { return lumaWords() / 2 * ((eye.size.y + 1) / 2); } // from a place in Cb to the same in Cr
// Where 8 pixels side by side begin, and the 4 of Cb that 8 x 2 pixels have. `from`: where the picture does.
uint lumaWord(uint from, uint row, uint block) { return from + row * lumaWords() + block * 2; }
uint chromaWord(uint from, uint row, uint block) { return from + eye.size.y * lumaWords() + row * (lumaWords() / 2) + block; }
// With kFull: the same 8 pixels in the plane of R, G or B (0, 1, 2).
uint fullWord(uint from, uint plane, uint row, uint block) { return lumaWord(from, plane * eye.size.y + row, block); }
// From Y, Cb, Cr with 128 added: JFIF.
vec3 rgbOf(float luma, float cb, float cr) {
    return luma + vec3(1.402 * (cr - 128), -0.344136286 * (cb - 128) - 0.714136286 * (cr - 128), 1.772 * (cb - 128));
}
