#include "server/inputs/own_light.h"

#include <algorithm>
#include <numbers>

#include "shaders/shared/sky.h"

namespace brume {
namespace {

constexpr double kBegin = -0.15, kEnd = 0.85; // heights between which the zenith's part goes from 0 to 1

// Integrals of the zenith's part, and of it times the height, from a height up to 1.
struct ZenithSums {
    double part, times_height;
};
ZenithSums zenithSums(double from) {
    const double x = std::clamp(from - kBegin, 0.0, 1.0), x3 = x * x * x, top = std::max(from, kEnd);
    const double part = 0.5 - x3 * (1 - 0.5 * x), times_x = 0.35 - x3 * x * (0.75 - 0.4 * x);
    return {part + 1 - top, times_x + kBegin * part + 0.5 * (1 - top * top)};
}

} // namespace

OuterLight outerLight(const Sky& sky, std::optional<glm::dvec3> ground) {
    const glm::dvec3 horizon = sky.horizon, more = glm::dvec3(sky.zenith) - horizon;
    const double from = ground ? 0 : -1;
    const ZenithSums zenith = zenithSums(from);
    OuterLight light;
    light.mean = 0.5 * ((1 - from) * horizon + zenith.part * more);
    light.up = 1.5 * (0.5 * (1 - from * from) * horizon + zenith.times_height * more);
    if (ground) light.mean += 0.5 * *ground, light.up -= 0.75 * *ground;
    light.up = glm::clamp(light.up, -light.mean, light.mean);
    return light;
}

glm::dvec3 skyLitGround(const Sky& sky, glm::dvec3 albedo) {
    const glm::dvec3 horizon = sky.horizon, more = glm::dvec3(sky.zenith) - horizon;
    return albedo * (horizon * physics::skySeen(1.0) + more * physics::skyZenithSeen(1.0));
}

EnteringFluxes enteringFluxes(const OuterLight& light, const std::array<glm::vec3, 3>& axes) {
    constexpr double kEach = 4 * std::numbers::pi / 6; // sr
    EnteringFluxes entering{.mean = kEach * light.mean};
    // What goes up an axis comes from the other side.
    for (size_t i = 0; i < 3; ++i) entering.up[i] = -kEach * double(axes[i].y) * light.up;
    return entering;
}

} // namespace brume
