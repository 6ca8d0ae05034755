#include "server/inputs/local_light_block.h"

#include <algorithm>
#include <cmath>

#include "common/scene_limits.h"
#include "shaders/shared/lamps.h"

namespace brume {
namespace {

static_assert(limits::kLocalLights.hi == physics::kMostLocalLights);

constexpr float kEndless = 1e15f;   // m, a range
constexpr float kWidest = 0.2f;     // cosine of the half angle of cones; wider ones are all directions
constexpr float kOctahedron = 3.5f; // rad, along a side of the octahedron's square
// Directions and distances of a volume in standard deviations of the medium, halfway through it.
constexpr float kApart = 0.3f, kShellsApart = 0.5f;
// As many directions and distances has every volume of all directions, to the farthest particle. Others have at least
// as many on the same angle and length.
constexpr float kSide = 64, kShells = 48;
constexpr float kCoarser = 4.0f / 3; // distance of directions, if they are coarse, over what it is else
constexpr float kConeShare = 16;     // how much more work a direction of a cone may take than one of all
constexpr double kMostWork = 1e9;    // numbers times pairs of a particle and a light; more only if they must
// Most numbers of all volumes: those beyond the least directions and distances, and the least ones. Both together fit a
// buffer of 128 MiB. Where there are more than 128 lights, each has fewer than the least.
constexpr double kMostNumbers = 7 << 20, kMostOfLeast = 24 << 20;
constexpr float kFewShells = 24; // distances of a volume then

constexpr size_t kMostPairs = 2'000'000;  // lights times particles whose distances are looked at
constexpr float kDeviationOfWidth = 0.1f; // of exp(-50 r^2 / u^2), in u

// The ball that holds what a spot lights: that around its cone's tip and rim.
void boundSpot(gpu::LocalLight& out, float outer) {
    const bool wide = outer > 0.785398f; // rad: the rim's circle is the ball's largest
    const float half = wide ? out.range * std::cos(outer) : out.range / (2 * std::cos(outer));
    out.bound = out.position + half * out.axis;
    out.reach = wide ? out.range * std::sin(outer) : half;
}

// The cone of the volume's directions: the narrower one of a spot's own and of that around the particles.
void setCone(gpu::LocalLight& light, const MediumExtent& extent) {
    light.volume_axis = light.axis;
    light.volume_cosine = light.cos_outer;
    const glm::vec3 to = 0.5f * (extent.lo + extent.hi) - light.position, axis = to / std::max(glm::length(to), 1e-6f);
    float cosine = 1;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 at(corner & 1 ? extent.hi.x : extent.lo.x, corner & 2 ? extent.hi.y : extent.lo.y,
                           corner & 4 ? extent.hi.z : extent.lo.z);
        const glm::vec3 away = at - light.position;
        cosine = std::min(cosine, glm::dot(away, axis) / std::max(glm::length(away), 1e-6f));
    }
    cosine -= 1e-4f; // rounding
    if (cosine > std::max(light.volume_cosine, kWidest)) light.volume_axis = axis, light.volume_cosine = cosine;
    if (light.volume_cosine < kWidest) light.volume_cosine = -2;
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
                        .volume_step = 1,
                        .volume_axis = light.axis,
                        .volume_cosine = -2};
    if (spot && light.range > 0) boundSpot(out, light.outer);
    return out;
}

uint32_t setVolume(gpu::LocalLight& light, const MediumExtent& extent, uint32_t particles, uint32_t lights,
                   uint32_t before, bool coarse) {
    const glm::vec3 from_lo = light.position - extent.lo, from_hi = light.position - extent.hi;
    const glm::vec3 outside = glm::max(glm::max(-from_lo, from_hi), 0.0f);
    const glm::vec3 farthest = glm::max(glm::abs(from_lo), glm::abs(from_hi));
    const float near = glm::length(outside), whole = std::max(glm::length(farthest) - near, 1e-3f);
    const float length = std::clamp(light.range - near, 1e-3f, whole);
    setCone(light, extent);
    const float all = light.volume_cosine < -1 ? kOctahedron : std::sqrt(8 * (1 - light.volume_cosine)); // rad
    const float coarser = coarse ? kCoarser : 1, apart = coarser * kApart * extent.deviation / (near + 0.5f * length);
    // Numbers that it may have. All directions of a narrow cone meet particles.
    const double share = std::min(kConeShare * (all / kOctahedron) * (all / kOctahedron), 1.0f);
    const double numbers =
        std::min(share * kMostWork / std::max(double(particles), 1.0), kMostNumbers) / std::max(lights, 1u);
    // A multiple of `step`, as wanted, between the least and what the numbers allow.
    const auto count = [](float wanted, float least, double allowed, uint32_t most, uint32_t step) {
        const double bounded = std::min({double(wanted), allowed, double(most)});
        const uint32_t steps = uint32_t(std::max(std::floor(bounded / step), std::ceil(double(least) / step)));
        return std::min(step * std::max(steps, 1u), most);
    };
    float side = kSide / coarser, shells = kShells;
    if (const double room = kMostOfLeast / std::max(lights, 1u); side * side * shells > room)
        shells = kFewShells, side = 16 * std::floor(float(std::sqrt(room / shells)) / 16);
    const float least_side = std::max(side * all / kOctahedron, 16.0f), least_shells = shells * length / whole;
    light.volume_shells = count(length / (kShellsApart * extent.deviation), least_shells,
                                numbers / (least_side * least_side), gpu::kMostLightShells, 8);
    light.volume_side =
        count(all / apart, least_side, std::sqrt(numbers / light.volume_shells), gpu::kMostLightSide, 16);
    light.volume = before;
    light.volume_near = near;
    light.volume_step = length / float(light.volume_shells - 1);
    return light.volume_side * light.volume_side * light.volume_shells;
}

bool isHeldByRays(const gpu::LocalLight& light, const gpu::Eye& eye, const gpu::SlabGrid& grid, float most) {
    const float depth = -glm::dot(light.position - eye.position, eye.back);
    return physics::raysHold(light.smooth_length, depth, float(grid.rate) * glm::length(eye.ray_down), grid.thickness,
                             most);
}

void setSmoothLengths(std::span<gpu::LocalLight> lights, std::span<const gpu::Particle> particles,
                      const MediumExtent& extent, float falloff, const SceneFeatures& features,
                      std::span<const Plane> planes) {
    const bool few = lights.size() * particles.size() <= kMostPairs;
    for (gpu::LocalLight& light : lights) {
        const auto hides = [&](const Plane& plane) { return plane.height > light.position.y; };
        const bool shadowed = features.bodies || features.meshes || std::ranges::any_of(planes, hides);
        light.smooth_length = 0;
        if (features.fog || particles.empty() || (light.shadows != 0 && shadowed)) continue;
        const glm::vec3 outside = glm::max(glm::max(extent.lo - light.position, light.position - extent.hi), 0.0f);
        float nearest = glm::length(outside);
        if (few) {
            float particle = kEndless;
            for (const gpu::Particle& p : particles) {
                const float deviation = kDeviationOfWidth * p.scale * falloff;
                particle = std::min(particle, glm::distance(p.centre, light.position) - deviation);
            }
            nearest = std::max(nearest, particle);
        }
        float fades = 1; // rad
        if (light.cos_outer >= -1)
            fades = std::acos(light.cos_outer) - std::acos(std::min(light.cos_outer + light.cone_width, 1.0f));
        light.smooth_length = std::max(nearest, 0.0f) * std::min(fades, 1.0f);
    }
}

} // namespace brume
