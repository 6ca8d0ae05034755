#include "server/medium/extent.h"

#include <algorithm>
#include <cmath>

#include "shaders/shared/support.h"

namespace brume {

MediumExtent mediumExtent(std::span<const gpu::Particle> particles, float falloff, float cut, bool corners) {
    MediumExtent extent;
    if (particles.empty()) return extent;
    extent.albedo = particles.front().albedo;
    extent.lo = glm::vec3(1e30f);
    extent.hi = glm::vec3(-1e30f);
    double mass = 0, fineness = 0; // sums of m and of m / s^4
    float largest_scale = 0, largest_sigma_t = 0;
    for (const gpu::Particle& p : particles) {
        largest_scale = std::max(largest_scale, p.scale);
        largest_sigma_t = std::max(largest_sigma_t, p.sigma_t);
    }
    const float most = physics::supportRadius(largest_sigma_t, largest_scale * falloff, cut);
    for (const gpu::Particle& p : particles) {
        extent.one_albedo = extent.one_albedo && p.albedo == extent.albedo;
        const float u = p.scale * falloff;
        if (!(p.sigma_t * u * 0.25066282746310005f > cut)) continue;
        // Most lie so far inside that no radius can matter.
        const bool inside = glm::all(glm::greaterThan(p.centre - most, extent.lo)) &&
                            glm::all(glm::lessThan(p.centre + most, extent.hi));
        if (!inside) {
            const float radius = physics::supportRadius(p.sigma_t, u, cut);
            extent.lo = glm::min(extent.lo, p.centre - radius);
            extent.hi = glm::max(extent.hi, p.centre + radius);
        }
        const double s = std::max(0.1 * double(u), 1e-6);
        mass += double(p.sigma_t) * s * s * s;
        fineness += double(p.sigma_t) / s;
    }
    if (!(mass > 0)) {
        extent.lo = extent.hi = glm::vec3(0);
        return extent;
    }
    if (corners)
        for (const gpu::Particle& p : particles) {
            extent.lo = glm::min(extent.lo, p.centre);
            extent.hi = glm::max(extent.hi, p.centre);
        }
    extent.deviation = float(std::pow(fineness / mass, -0.25));
    return extent;
}

DepthRange depthRange(const MediumExtent& extent, glm::vec3 eye, glm::vec3 forward) {
    const float middle = glm::dot(0.5f * (extent.lo + extent.hi) - eye, forward);
    const float reach = glm::dot(0.5f * (extent.hi - extent.lo), glm::abs(forward));
    return {middle - reach, middle + reach};
}

} // namespace brume
