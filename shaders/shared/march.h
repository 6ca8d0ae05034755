// What the passes of method `march` share: the pixels that are marched, patterns by formula, and the weights of the
// blur. One text, compiled as C++ and as GLSL (scalar layout).
#ifndef BRUME_SHARED_MARCH_H
#define BRUME_SHARED_MARCH_H

#include "real.h"
#include "types.h"

#ifdef __cplusplus
namespace brume::gpu {
#endif

// A band of rows of marched pixels. Marched pixel (x, y) of the band stands for rate x rate pixels, and is marched at
// the one in their middle: (rate x + rate / 2, rate (y + first_row) + rate / 2).
struct MarchBand {
    uvec2 size;     // marched pixels: columns, and rows of the band
    uint first_row; // of the band, in marched rows of the picture
    uint rate;      // pixels between marched ones: 1, 2 or 4
    float near;     // m of view depth, where rays begin
    float far;      // m of view depth, where they end at the latest; depths of surfaces are cut there
    float falloff;  // m of view depth, at which a weight of the blur is 0
    uint particles; // 1: the nodes hold particles; 0: there are none
};

// What a pattern moves (MarchSettings::jitter).
const uint kJitterOffset = 0u;
const uint kJitterStratified = 1u;
const uint kJitterOpacity = 2u;

// Filters (MarchSettings::blur).
const uint kBlurRow14 = 0u;
const uint kBlurPrinted = 1u;
const uint kBlurBox8 = 2u;
const uint kBlurTaps = 15u;
const uint kBlurReach = 7u; // taps to either side of the middle one
// Row 14 of Pascal's triangle has a variance of 14 / 4. What the thesis prints is half of row 15, mirrored: 3.02. Eight
// even taps meet each of the 8x8 numbers of a pattern once.
const float kBlurWeights[3][15] = {{1, 14, 91, 364, 1001, 2002, 3003, 3432, 3003, 2002, 1001, 364, 91, 14, 1},
                                   {1, 15, 105, 455, 1365, 3003, 5005, 6435, 5005, 3003, 1365, 455, 105, 15, 1},
                                   {0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0}};

const uint kPatternSide = 64u; // pixels along a side of a pattern, which is repeated

#ifdef __cplusplus
static_assert(sizeof(MarchBand) == 32);
} // namespace brume::gpu
#endif

BRUME_PHYSICS_BEGIN

// A number in [0, 1) for a pixel: Jimenez, Next Generation Post Processing in Call of Duty: Advanced Warfare, 2014.
BRUME_FN real interleavedNoise(real x, real y) {
    const real along = x * real(0.06711056) + y * real(0.00583715);
    const real part = real(52.9829189) * (along - floor(along));
    return part - floor(part);
}

BRUME_PHYSICS_END

#endif
