// Planes of the finished picture, in words of four bytes; server/render/picture.h has the layout. Full-range BT.601
// Y, Cb, Cr with 4:2:0 chroma, 128 added to Cb and Cr, the input of JPEG (JFIF). With kFull: sRGB R, G, B of all
// pixels. Include after the eye is declared.
#include "shaders/shared/constants.h"
#include "shaders/lib/whole.glsl"

layout(constant_id = kIdFull) const bool kFull = false;

const vec3 kLuma = vec3(0.299, 0.587, 0.114);
const vec3 kCb = vec3(-0.168735892, -0.331264108, 0.5), kCr = vec3(0.5, -0.418687589, -0.081312411);

// A value, clamped to [0, 255], as the n-th byte of a word.
uint byteOf(float value, uint n) { return nearestWhole(clamp(value, 0, 255)) << (8 * (n % 4)); }

uint lumaWords() { return (eye.size.x + 7) / 8 * 2; } // words of a row of Y; a row of Cb or Cr has half as many
uint crWords() { return lumaWords() / 2 * ((eye.size.y + 1) / 2); } // words from a position in Cb to the same in Cr
// Word index of 8 neighbouring pixels of Y, and of the 4 values of Cb of 8 x 2 pixels. `from`: index of the picture.
uint lumaWord(uint from, uint row, uint block) { return from + row * lumaWords() + block * 2; }
uint chromaWord(uint from, uint row, uint block) {
    return from + eye.size.y * lumaWords() + row * (lumaWords() / 2) + block;
}
// With kFull: word index of 8 neighbouring pixels in the plane of R, G or B (0, 1, 2).
uint fullWord(uint from, uint plane, uint row, uint block) { return lumaWord(from, plane * eye.size.y + row, block); }
// sRGB from Y, Cb, Cr (JFIF, 128 added to Cb and Cr).
vec3 rgbOf(float luma, float cb, float cr) {
    return luma + vec3(1.402 * (cr - 128), -0.344136286 * (cb - 128) - 0.714136286 * (cr - 128), 1.772 * (cb - 128));
}
