// Struct that shaders/lit_particles.comp writes for each particle and C++ reads; layout as in types.h.
#ifndef BRUME_SHARED_PARTICLE_FIT_H
#define BRUME_SHARED_PARTICLE_FIT_H

#ifdef __cplusplus
#include <glm/glm.hpp>
namespace brume::gpu {
using glm::vec3;
using glm::vec4;
#endif

// Light on a particle: of the sun the numbers of LitFit (lit_particles.h); and for an irradiance of 1, in each channel,
// the net flux (world axes) and the fluence of light that scattered more than once.
struct ParticleFit {
    float middle;
    vec3 slope, bend, twist;
    vec4 fluence[3];
};

// Units of 1/k: distance from the centre of the points that the fit takes. Near the best for media of much and of
// little overlap (docs/results/drawing-clients.md).
const float kFitReach = 1.2;

#ifdef __cplusplus
static_assert(sizeof(ParticleFit) == 88);
} // namespace brume::gpu
#endif

#endif
