// The light that method `gradients` computes at few places: samples, and what passes are told. One text, compiled as
// C++ and as GLSL (scalar layout).
#ifndef BRUME_SHARED_RADIANCE_H
#define BRUME_SHARED_RADIANCE_H

#include "lit_grid.h"

#ifdef __cplusplus
namespace brume::gpu {
#endif

// What is kept of light at a place: of points and spots for red, green and blue the part of it that arrives (0 ... 1),
// or its fluence (W/m^2); of the sun the part that arrives. And its derivatives along x, y and z, per m.
struct LightSample {
    vec4 value;
    vec4 along[3];
};

// States of samples, 32 bits each.
const uint kNoSample = 0u;
const uint kWanted = 1u; // it is to be computed
const uint kKept = 2u;   // it is computed, and interpolates well enough

// Words of the counts.
const uint kPlacesLit = 0u;   // places for which light was computed
const uint kSamplesKept = 1u; // samples that are interpolated between
const uint kNodesLit = 2u;    // nodes in the medium that no sample reached, computed one by one
const uint kHoles = 3u;       // nodes in the medium that have no value
const uint kLightCounts = 4u;

// Bits of LightSampling::how.
const uint kRadiance = 1u;      // samples have fluence; otherwise the part of the light that arrives
const uint kPrinted = 2u;       // weights and splitting are as printed by Ren et al.
const uint kNoPlanes = 4u;      // samples have no derivatives
const uint kExactly = 8u;       // every node is computed
const uint kNested = 16u;       // nodes have values from nested grids
const uint kParticles = 32u;    // the first samples are the particles
const uint kShadingError = 64u; // samples are split by shadingError() (sphere_samples.h)

struct LightSampling {
    LitGridShape lit;
    MediumGrid medium;
    uvec3 cells; // of the first grid that samples are split into, along each axis
    float cell;  // m, their width
    uint firsts; // number of samples before those of the grids
    int level;   // the samples that are computed: -1: the first ones; else the grid. Nested nodes: their stride
    uint levels; // of grids
    float error; // beyond which a sample is split
    float step;  // m between samples on the way to a light; 0: its volume is read
    float scale; // W/m^2, fluence that errors are measured by
    uint how;
    uint viewers; // number of viewers whose places are known
};

#ifdef __cplusplus
static_assert(sizeof(LightSampling) == 128);
static_assert(sizeof(LightSample) == 64);
} // namespace brume::gpu
#endif
#endif
