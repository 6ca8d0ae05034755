// Light that enters the medium from outside: the sky's, to first order in the direction (spherical harmonics of order 0
// and 1).
#pragma once

#include <array>
#include <optional>

#include <glm/glm.hpp>

#include "common/scene.h"

namespace brume {

// Radiance that comes from the unit direction w: mean + up * w.y, W/(m^2 sr). Of a radiance of all directions it has
// the fluence and the net flux.
struct OuterLight {
    glm::dvec3 mean{0}, up{0};
};
// Of the sky (shaders/shared/sky.h). `ground`: the radiance from all directions below the horizon; without it the sky
// goes on there. Exact, but for `up`, which is at most `mean`, so that nothing is negative.
OuterLight outerLight(const Sky& sky, std::optional<glm::dvec3> ground);
// Radiance of a ground of this albedo that the whole sky above the horizon lights.
glm::dvec3 skyLitGround(const Sky& sky, glm::dvec3 albedo);

// Power per area that comes along each axis of six fluxes (shaders/shared/multiple.h), of which each stands for
// 4 pi / 6 sr: the mean of up and down the axis, and half of their difference. `axes`: unit.
struct EnteringFluxes {
    glm::dvec3 mean{0};
    std::array<glm::dvec3, 3> up{};
};
EnteringFluxes enteringFluxes(const OuterLight& light, const std::array<glm::vec3, 3>& axes);

} // namespace brume
