#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Compose, per eye: background and medium if they are not drawn yet, exposure, tone map, sRGB, then full-range BT.601
// Y, Cb, Cr planes with 4:2:0 chroma, the input of JPEG (JFIF). A lane makes 8x2 pixels, which are complete words of
// every plane, or 24x2 pixels, which are complete cells of the field, too.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/lib/view.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = kIdHasOpaque) const bool kHasOpaque = true;
layout(constant_id = kIdHasCasters) const bool kHasCasters = true;
layout(constant_id = kIdHasLobe) const bool kHasLobe = true;
layout(constant_id = kIdHasAmbient) const bool kHasAmbient = true;
layout(constant_id = kIdRate) const uint kRate = 1;
layout(constant_id = kIdSunColours) const uint kSunColours = 1;
layout(constant_id = kIdAmbientColours) const uint kAmbientColours = 0;
layout(constant_id = kIdMultipleColours) const uint kMultipleColours = 0;
layout(constant_id = kIdScattering) const uint kScatteringModel = 0;
layout(constant_id = kIdDrawn) const bool kDrawn = true;
layout(constant_id = kIdKeep) const bool kKeep = false;
layout(constant_id = kIdBlocks) const uint kBlocks = 1;

#include "shaders/blocks/tick.glsl"
#include "shaders/blocks/view_depth.glsl"
layout(rgba32f) uniform image2D radiance;
layout(scalar) writeonly buffer Planes { uint planes[]; }; // bytes: Y, then Cb, then Cr
layout(scalar) readonly buffer Field { float field[]; };  // shared/field.h
layout(scalar) readonly buffer Sunlit { vec3 sunlit[]; }; // written by shafts.comp
layout(scalar) readonly buffer LitByLocalLights { vec3 lit[]; }; // written by local_light.comp

#include "shaders/lib/eye.glsl"
#include "shaders/lib/sky.glsl"
#include "shaders/lib/display.glsl"
#include "shaders/lib/planes.glsl"
#include "shaders/lib/medium_run.glsl"
#include "shaders/lib/medium_cut.glsl"
#include "shaders/lib/spread.glsl"

// Displayed colour of a pixel, of a run that is `clear` of medium or not. Beyond the right edge it is `before`, the
// colour of the previous pixel.
vec3 pixelOf(bool clear, MediumRun run, inout MediumCut cut, uvec2 at, vec3 before) {
    const vec3 dir = rayDirection(vec2(at) + 0.5);
    vec4 here;
    if (kHasOpaque) here = imageLoad(radiance, ivec2(at));
    else here = vec4(skyRadiance(normalize(dir)), 1);
    if (!clear) {
        const vec4 across = fieldAcross(int(at.x));
        float ray[kMostFieldQuantities];
        const float end = kHasFog && kHasOpaque ? texelFetch(view_depth, ivec2(at), 0).r : kEndless;
        wholeRay(run, across, dir, end, ray);
        if (kHasOpaque) cutRay(cut, run, ivec2(at), dir, across, ray);
        vec3 part = vec3(1);
        if (kHasCasters) part = sunlit[at.y * eye.size.x + min(at.x, eye.size.x - 1)];
        here = mediumOver(here, dir, ray, part);
    }
    if (at.x >= eye.size.x) return before;
    if (kHasLocalLights) here.rgb += lit[at.y * eye.size.x + at.x];
    if (kKeep) imageStore(radiance, ivec2(at), here);
    if (kIsLayer) return vec3(0); // `radiance` is all that is made
    return displayed(here.rgb);
}

// Neighbouring pixels in one cell that are computed together: the largest power of two that divides the rate, at most
// 8.
const uint kRun = (kRate & 7u) == 0u ? 8u : kRate & (~kRate + 1u);

const uint kMostBlocks = 3;
const uint kRunOfBlocks = kBlocks == 1 ? kRun : kRate;
const uint kMostWords = 2 * kMostBlocks; // words of a lane's row in a plane

uint full[6 * kMostWords]; // with kFull: words of R, G, B of the upper row, then of the lower one
void keepFull(vec3 rgb, uint row, uint n) {
    [[unroll]] for (uint c = 0; c < 3; ++c) full[(3 * row + c) * kMostWords + n / 4] |= byteOf(rgb[c], n);
}

uint lumaByte(vec3 rgb, uint n) { return byteOf(dot(rgb, kLuma), n); }

void main() {
    enterView(0);
    const View view = views[0];
    const uvec2 own = spreadInvocation().xy;
    const uint block_x = own.x * kBlocks, top = view.first + own.y * 2;
    if (block_x * 8 >= eye.size.x || top >= view.end) return;
    const uint blocks = min(kBlocks, (eye.size.x + 7) / 8 - block_x);
    const bool odd = top + 1 == eye.size.y; // the last row counts twice
    uint luma[2 * kMostWords];              // words of the upper row, then of the lower one
    vec3 chroma[4 * kMostBlocks];           // sums of two pixels side by side, of both rows
    [[unroll]] for (uint i = 0; i < 4 * kMostBlocks; ++i) chroma[i] = vec3(0);
    [[unroll]] for (uint i = 0; i < 2 * kMostWords; ++i) luma[i] = 0;
    [[unroll]] for (uint i = 0; i < 6 * kMostWords; ++i) full[i] = 0;
    if (!kDrawn && !kHasOpaque && kRate % 2 == 0) { // both rows together: they share their look-ups
        MediumRun run, next;
        MediumCut none;
        int cell = kNoCell;
        vec3 above = vec3(0), below = vec3(0);
        [[unroll]] for (uint i = 0; i < 8; ++i) {
            const uvec2 at = uvec2(block_x * 8 + i, top);
            if (i % kRun == 0) moveRuns(ivec2(at), cell, run, next);
            above = pixelOf(false, run, none, at, above);
            below = pixelOf(false, next, none, at + uvec2(0, 1), below);
            luma[i / 4] |= lumaByte(above, i);
            luma[kMostWords + i / 4] |= lumaByte(below, i);
            if (kFull) keepFull(above, 0, i), keepFull(below, 1, i);
            chroma[i / 2] += above + (odd ? above : below);
        }
    } else if (kDrawn) {
        [[unroll]] for (uint row = 0; row < 2; ++row)
            [[unroll]] for (uint i = 0; i < 8; ++i) {
                const uvec2 at = min(uvec2(block_x * 8 + i, top + row), eye.size - 1);
                const vec3 rgb = displayed(imageLoad(radiance, ivec2(at)).rgb);
                luma[row * kMostWords + i / 4] |= lumaByte(rgb, i);
                if (kFull) keepFull(rgb, row, i);
                chroma[i / 2] += rgb;
            }
    } else { // a loop, since the code is too large to exist twice
        MediumRun run, next;
        int cell = kNoCell;
        vec3 above = vec3(0), below = vec3(0);
        for (uint first = 0; first < 8 * blocks; first += kRunOfBlocks) {
            const uvec2 left = uvec2(block_x * 8 + first, top);
            const bool clear = kHasOpaque && !kHasFog && areClear(ivec2(left)); // True: there is no medium in the runs
            if (clear) cell = kNoCell;
            else moveRuns(ivec2(left), cell, run, next);
            for (uint row = 0; row < (odd ? 1 : 2); ++row) {
                MediumRun own = next;
                if (row == 0) own = run;
                MediumCut cut = mediumCut();
                vec3 rgb = row == 0 ? above : below;
                for (uint i = first; i < min(first + kRunOfBlocks, 8 * blocks); ++i) {
                    rgb = pixelOf(clear, own, cut, uvec2(block_x * 8 + i, top + row), rgb);
                    luma[row * kMostWords + i / 4] |= lumaByte(rgb, i);
                    if (kFull) keepFull(rgb, row, i);
                    chroma[i / 2] += rgb;
                }
                if (row == 0) above = rgb;
                else below = rgb;
            }
        }
        if (odd)
            for (uint pair = 0; pair < 4 * kBlocks; ++pair) chroma[pair] *= 2;
    }
    if (kIsLayer) return;
    for (uint block = 0; block < blocks; ++block) {
        if (kFull) {
            for (uint row = 0; row < 2 && !(odd && row == 1); ++row)
                [[unroll]] for (uint c = 0; c < 3; ++c) {
                    if ((tick.channels >> c & 1) == 0) continue;
                    const uint at = fullWord(view.planes, c, top + row, block_x + block);
                    planes[at] = full[(3 * row + c) * kMostWords + 2 * block];
                    planes[at + 1] = full[(3 * row + c) * kMostWords + 2 * block + 1];
                }
            continue;
        }
        for (uint row = 0; row < 2 && !(odd && row == 1); ++row) {
            const uint at = lumaWord(view.planes, top + row, block_x + block);
            planes[at] = luma[row * kMostWords + 2 * block];
            planes[at + 1] = luma[row * kMostWords + 2 * block + 1];
        }
        uint cb = 0, cr = 0;
        [[unroll]] for (uint pair = 0; pair < 4; ++pair) {
            const vec3 mean = 0.25 * chroma[4 * block + pair];
            cb |= byteOf(dot(mean, kCb) + 128, pair);
            cr |= byteOf(dot(mean, kCr) + 128, pair);
        }
        const uint at = chromaWord(view.planes, top / 2, block_x + block);
        planes[at] = cb;
        planes[at + crWords()] = cr;
    }
}
