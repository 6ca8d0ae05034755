#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Per viewer: exposure, tone map, sRGB, then full-range BT.601 Y, Cb, Cr planes with 4:2:0 chroma, as JPEG (JFIF) has them.
// A lane makes 8x2 pixels: whole words of every plane.
#include "shaders/shared/types.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(scalar, binding = 1) uniform EyeBlock { Eye eye; };
layout(rgba32f, binding = 2) readonly uniform image2D radiance;
layout(scalar, binding = 3) writeonly buffer Planes { uint planes[]; }; // bytes: Y, then Cb, then Cr

layout(push_constant, scalar) uniform Push {
    uint luma_words;   // of one row of Y: 8-pixel blocks * 2; a row of Cb or Cr has half
    uint first_word;   // of this picture in the buffer
} push;

#include "shaders/lib/display.glsl"

vec3 pixel(uvec2 at) { return displayed(imageLoad(radiance, ivec2(min(at, eye.size - 1))).rgb); }

void main() {
    const uvec2 block = gl_GlobalInvocationID.xy;
    if (block.x * 8 >= eye.size.x || block.y * 2 >= eye.size.y) return;
    const uint chroma_words = push.luma_words / 2, chroma_rows = (eye.size.y + 1) / 2;
    uint luma[2][2] = uint[2][2](uint[2](0, 0), uint[2](0, 0));
    uint cb = 0, cr = 0;
    for (uint pair = 0; pair < 4; ++pair) {
        vec3 sum = vec3(0);
        for (uint row = 0; row < 2; ++row)
            for (uint column = 0; column < 2; ++column) {
                const uint x = pair * 2 + column;
                const vec3 rgb = pixel(block * uvec2(8, 2) + uvec2(x, row));
                luma[row][x / 4] |= uint(dot(rgb, vec3(0.299, 0.587, 0.114)) + 0.5) << (8 * (x % 4));
                sum += rgb;
            }
        sum *= 0.25;
        cb |= uint(clamp(dot(sum, vec3(-0.168735892, -0.331264108, 0.5)) + 128.5, 0, 255)) << (8 * pair);
        cr |= uint(clamp(dot(sum, vec3(0.5, -0.418687589, -0.081312411)) + 128.5, 0, 255)) << (8 * pair);
    }
    for (uint row = 0; row < 2; ++row) {
        const uint y = block.y * 2 + row;
        if (y >= eye.size.y) break;
        const uint at = push.first_word + y * push.luma_words + block.x * 2;
        planes[at] = luma[row][0];
        planes[at + 1] = luma[row][1];
    }
    const uint chroma = push.first_word + eye.size.y * push.luma_words + block.y * chroma_words + block.x;
    planes[chroma] = cb;
    planes[chroma + chroma_rows * chroma_words] = cr;
}
