#include "server/inputs/local_light_block.h"

#include <cmath>

namespace brume {
namespace {

constexpr float kEndless = 1e15f; // m, a range

// The ball that holds what a spot lights: that around its cone's tip and rim.
void boundSpot(gpu::LocalLight& out, float outer) {
    const bool wide = outer > 0.785398f; // rad: the rim's circle is the ball's largest
    const float half = wide ? out.range * std::cos(outer) : out.range / (2 * std::cos(outer));
    out.bound = out.position + half * out.axis;
    out.reach = wide ? out.range * std::sin(outer) : half;
}

} // namespace

gpu::LocalLight localLightBlock(const Light& light) {
    const bool spot = light.type == kSpot;
    gpu::LocalLight out{.position = light.position,
                        .range = light.range > 0 ? light.range : kEndless,
                        .intensity = light.intensity,
                        .radius = light.radius,
                        .axis = light.axis,
                        .cos_outer = spot ? std::cos(light.outer) : -2,
                        .cone_width = spot ? std::cos(light.inner) - std::cos(light.outer) : 1,
                        .shadows = light.shadows,
                        .bound = light.position,
                        .reach = light.range > 0 ? light.range : kEndless,
                        .volume = gpu::kNoVolume,
                        .volume_step = 1};
    if (spot && light.range > 0) boundSpot(out, light.outer);
    return out;
}

void setVolume(gpu::LocalLight& light, const MediumExtent& extent, uint32_t volume) {
    const glm::vec3 from_lo = light.position - extent.lo, from_hi = light.position - extent.hi;
    const glm::vec3 outside = glm::max(glm::max(-from_lo, from_hi), 0.0f);
    const glm::vec3 farthest = glm::max(glm::abs(from_lo), glm::abs(from_hi));
    light.volume = volume;
    light.volume_near = glm::length(outside);
    light.volume_step = std::max(glm::length(farthest) - light.volume_near, 1e-3f) / float(gpu::kLightShells - 1);
}

} // namespace brume
