// Resolution of the volumetric shadow map: texels and planes, from the particles' standard deviations, optical depths
// and number, not from the scene's size.
#pragma once

#include <span>
#include <vector>

#include "common/scene.h"
#include "shaders/shared/types.h"

namespace brume {

// Sums over the particles as the light sees them. Below, a is the optical depth through a particle's centre, s its
// standard deviation.
class ShadowedMedium {
public:
    // `basis`: light_x, light_y, to_light. Uses at most 4,096 particles, evenly chosen.
    ShadowedMedium(std::span<const gpu::Particle> particles, float falloff, const glm::mat3& basis);

    // Relative RMS error of the light in the medium by linear interpolation between texels (planes) `spacing` (m)
    // apart. It estimates two causes:
    // - each particle: interpolation errs by its curvature, independently of other particles;
    // - the body that they fill, if it were smooth: its outline is as soft as one particle.
    // For texels, only particles within one optical depth of the lit side count. The part of the error that a line of
    // sight averages away is subtracted (measured on the shipped scenes).
    double texelError(double spacing) const;
    double planeError(double spacing) const;

private:
    struct Size {
        double deviation = 0; // m, mean of the particles of this size
        double squares = 0;   // sum of (a s)^2
    };
    std::vector<Size> sizes_;
    double depth_ = 0;     // mean optical depth of the medium along the light
    double deviation_ = 1; // mean s, by depth
    glm::dvec3 size_{1};   // m, of a box with the second moments of the particles' centres
};

struct ShadowResolution {
    glm::uvec2 texels{16};
    uint32_t slices = 2; // planes
    double error = 0;    // estimated: relative RMS error of the light in the medium
};

// Chooses the resolution. Numbers that `settings` give (not 0) are kept. The others are the smallest, in steps of a
// fifth, for which the error is at most settings.shadow_error. Limits: 32 ... 1024 texels, 19 ... 127 planes, 2^24
// cells; at a limit the error may be larger. `extent`: m, of the map.
ShadowResolution shadowResolution(const RenderSettings& settings, const ShadowedMedium& medium, glm::vec3 extent);

} // namespace brume
