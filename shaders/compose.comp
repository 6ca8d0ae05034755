#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Per viewer: background and medium where they are not drawn yet, exposure, tone map, sRGB, then full-range BT.601 Y, Cb, Cr planes
// with 4:2:0 chroma, as JPEG (JFIF) has them. A lane makes 8x2 pixels: whole words of every plane.
#include "shaders/shared/types.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const bool kHasOpaque = true;
layout(constant_id = 1) const bool kHasCasters = true;
layout(constant_id = 2) const bool kHasLobe = true;
layout(constant_id = 3) const bool kHasAmbient = true;
layout(constant_id = 23) const uint kRate = 1;     // of the field
layout(constant_id = 24) const uint kSources = 1;  // of the field
layout(constant_id = 25) const bool kDrawn = true; // the medium is in `radiance` already
layout(constant_id = 26) const bool kKeep = false; // `radiance` is wanted afterwards

layout(scalar, binding = 0) uniform TickBlock { Tick tick; };
layout(scalar, binding = 1) uniform EyeBlock { Eye eye; };
layout(rgba32f, binding = 2) uniform image2D radiance;
layout(scalar, binding = 3) writeonly buffer Planes { uint planes[]; }; // bytes: Y, then Cb, then Cr
layout(scalar, binding = 4) readonly buffer Field { float field[]; };  // lib/slab_field.glsl
layout(scalar, binding = 5) uniform Objects { Opaque objects[kMostObjects]; };
layout(binding = 8) uniform sampler2D view_depth;

layout(push_constant, scalar) uniform Push {
    uint luma_words; // of one row of Y: 8-pixel blocks * 2; a row of Cb or Cr has half
    uint first_word; // of this picture in the buffer
    uint first, end; // rows of pixels
    SlabGrid grid;   // of the field
} push;

#include "shaders/lib/eye.glsl"
#include "shaders/lib/sky.glsl"
#include "shaders/lib/display.glsl"
#include "shaders/lib/medium_run.glsl"

// What the display shows of a pixel; beyond the right edge `before`, what it shows of the one before.
vec3 pixelOf(inout MediumRun run, uvec2 at, vec3 before) {
    const vec3 dir = rayDirection(vec2(at) + 0.5);
    vec4 here;
    if (kHasOpaque) here = imageLoad(radiance, ivec2(at));
    else here = vec4(skyRadiance(normalize(dir)), 1);
    here = throughMedium(run, at, dir, here);
    if (at.x >= eye.size.x) return before;
    if (kKeep) imageStore(radiance, ivec2(at), here);
    return displayed(here.rgb);
}

uint lumaByte(vec3 rgb) { return uint(dot(rgb, vec3(0.299, 0.587, 0.114)) + 0.5); }

void main() {
    const uint block_x = gl_GlobalInvocationID.x, top = push.first + gl_GlobalInvocationID.y * 2;
    if (block_x * 8 >= eye.size.x || top >= push.end) return;
    const bool odd = top + 1 == eye.size.y; // the last row counts twice
    uvec2 luma[2];
    vec3 chroma[4]; // sums of two pixels side by side, of both rows
    [[unroll]] for (uint pair = 0; pair < 4; ++pair) chroma[pair] = vec3(0);
    if (!kDrawn && !kHasOpaque && kRate % 2 == 0) { // both rows at once: they share what they look up
        MediumRun run, next;
        vec3 above = vec3(0), below = vec3(0);
        luma[0] = luma[1] = uvec2(0);
        [[unroll]] for (uint i = 0; i < 8; ++i) {
            const uvec2 at = uvec2(block_x * 8 + i, top);
            if (i % kRun == 0) mediumRuns(at, run, next);
            above = pixelOf(run, at, above);
            below = pixelOf(next, at + uvec2(0, 1), below);
            luma[0][i / 4] |= lumaByte(above) << (8 * (i % 4));
            luma[1][i / 4] |= lumaByte(below) << (8 * (i % 4));
            chroma[i / 2] += above + (odd ? above : below);
        }
    } else if (kDrawn) {
        [[unroll]] for (uint row = 0; row < 2; ++row) {
            luma[row] = uvec2(0);
            [[unroll]] for (uint i = 0; i < 8; ++i) {
                const uvec2 at = min(uvec2(block_x * 8 + i, top + row), eye.size - 1);
                const vec3 rgb = displayed(imageLoad(radiance, ivec2(at)).rgb);
                luma[row][i / 4] |= lumaByte(rgb) << (8 * (i % 4));
                chroma[i / 2] += rgb;
            }
        }
    } else { // so much code that it is there only once
        for (uint row = 0; row < 2; ++row) {
            if (row == 1 && odd) {
                [[unroll]] for (uint pair = 0; pair < 4; ++pair) chroma[pair] *= 2;
                break;
            }
            MediumRun run;
            uvec2 now = uvec2(0);
            vec3 rgb = vec3(0);
            for (uint i = 0; i < 8; ++i) {
                const uvec2 at = uvec2(block_x * 8 + i, top + row);
                if (i % kRun == 0) run = mediumRun(at);
                rgb = pixelOf(run, at, rgb);
                const uint byte = lumaByte(rgb) << (8 * (i % 4));
                if (i < 4) now.x |= byte;
                else now.y |= byte;
                chroma[i / 2] += rgb;
            }
            if (row == 0) luma[0] = now;
            luma[1] = now;
        }
    }
    const uint y_at = push.first_word + top * push.luma_words + block_x * 2;
    planes[y_at] = luma[0].x;
    planes[y_at + 1] = luma[0].y;
    if (!odd) {
        planes[y_at + push.luma_words] = luma[1].x;
        planes[y_at + push.luma_words + 1] = luma[1].y;
    }
    uint cb = 0, cr = 0;
    [[unroll]] for (uint pair = 0; pair < 4; ++pair) {
        const vec3 mean = 0.25 * chroma[pair];
        cb |= uint(clamp(dot(mean, vec3(-0.168735892, -0.331264108, 0.5)) + 128.5, 0, 255)) << (8 * pair);
        cr |= uint(clamp(dot(mean, vec3(0.5, -0.418687589, -0.081312411)) + 128.5, 0, 255)) << (8 * pair);
    }
    const uint chroma_words = push.luma_words / 2, chroma_rows = (eye.size.y + 1) / 2;
    const uint at = push.first_word + eye.size.y * push.luma_words + top / 2 * chroma_words + block_x;
    planes[at] = cb;
    planes[at + chroma_rows * chroma_words] = cr;
}
