// How many texels and planes the volumetric shadow map needs: from the particles' standard deviations, their depths and how many
// share the medium, not from the scene's size.
#pragma once

#include <span>
#include <vector>

#include "common/scene.h"
#include "shaders/shared/types.h"

namespace brume {

// The particles as the light sees them, as sums over them. a: optical depth through a particle's centre; s: its standard
// deviation.
class ShadowedMedium {
public:
    // `basis`: light_x, light_y, to_light. Looks at 4,096 particles at most, evenly chosen.
    ShadowedMedium(std::span<const gpu::Particle> particles, float falloff, const glm::mat3& basis);

    // RMS error of the light that reaches the medium, relative, that linear interpolation leaves between texels (planes) that are
    // `spacing` (m) apart. Two causes, both estimates:
    // - particles at random places: each errs by its own curvature, independently of the others;
    // - the body that they fill, if it were full of infinitely many: its outline is as soft as they are.
    // Only particles within one optical depth of the light's side count for texels, and what a line of sight averages is taken
    // off (measured on the shipped scenes).
    double texelError(double spacing) const;
    double planeError(double spacing) const;

private:
    struct Size {
        double deviation = 0; // m, of the particles of about this size
        double squares = 0;   // sum of (a s)^2
    };
    std::vector<Size> sizes_;
    double depth_ = 0;     // mean optical depth of the medium along the light
    double deviation_ = 1; // mean s, by depth
    glm::dvec3 size_{1};   // of a box with the particles' second moments, m
};

struct ShadowResolution {
    glm::uvec2 texels{16};
    uint32_t slices = 2; // planes
    double error = 0;    // estimated: relative RMS error of the light in the medium
};

// What `settings` ask for where they are not 0; the rest such that the error is at most settings.shadow_error, in steps of a
// fifth, 16 ... 1024 texels and 7 ... 127 planes, and not more than 2^22 cells: then the error may be larger. `extent`: m, of the
// map.
ShadowResolution shadowResolution(const RenderSettings& settings, const ShadowedMedium& medium, glm::vec3 extent);

} // namespace brume
