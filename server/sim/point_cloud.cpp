#include "server/sim/point_cloud.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include <fmt/format.h>

#include "common/elementary.h"
#include "common/ellipsoid.h"
#include "common/ply/ply.h"
#include "common/random.h"
#include "common/scene_limits.h"
#include "server/medium/lasting_groups.h"
#include "server/sim/spacing.h"

namespace brume {

namespace {

constexpr float kSqrt5 = 2.23606798f, kSqrt2Pi = 2.50662827f;
// An opacity of 1 would need an infinite extinction. This one is within half a level of a picture of 8 bits.
constexpr float kMostOpacity = 1 - 1 / 512.0f;

// A particle's extinction is peak * exp(-50 r^2 / u^2), u = scale * falloff: its standard deviation is u / 10.
float deviationOf(float scale, const Medium& medium) { return 0.1f * scale * medium.falloff; }
float scaleOf(float deviation, const Medium& medium) { return limits::kScale.clamp(10 * deviation / medium.falloff); }

// Each corner as large as a particle that has the optical mass which tetrahedra owe to it: a quarter of the volume of
// each, times its extinction. Maps and laws of errors go by it; pictures do not.
std::vector<float> cornerScales(const PointCloud& cloud, std::span<const glm::vec3> places, const Medium& medium) {
    std::vector<double> volumes(places.size(), 0);
    for (const glm::uvec4& cell : cloud.tetrahedra) {
        const glm::dvec3 a(places[cell.x]), b = glm::dvec3(places[cell.y]) - a, c = glm::dvec3(places[cell.z]) - a,
                                            d = glm::dvec3(places[cell.w]) - a;
        const double volume = std::abs(glm::dot(glm::cross(b, c), d)) / 6;
        for (int m = 0; m < 4; ++m) volumes[cell[m]] += volume / 4;
    }
    std::vector<float> scales;
    scales.reserve(places.size());
    for (const double volume : volumes) scales.push_back(scaleOf(float(cubeRoot(volume)) / kSqrt2Pi, medium));
    return scales;
}

// Every list as long as the positions, for what takes particles.
std::vector<gpu::Particle> particlesOf(const Placement& placed) {
    std::vector<gpu::Particle> particles(placed.position.size());
    for (size_t i = 0; i < particles.size(); ++i) {
        gpu::Particle& p = particles[i];
        p.centre = placed.position[i];
        p.scale = placed.scale[i];
        p.sigma_t = placed.sigma_t[i];
        if (!placed.albedo.empty()) p.albedo = placed.albedo[i];
    }
    return particles;
}

// Merges the points of a file that has more than a scene may have. Each group keeps its extinction over space.
void mergeMany(const Medium& medium, Placement& out, PointCloudFacts& facts) {
    constexpr auto kMost = uint32_t(limits::kCount.hi);
    if (out.position.size() <= kMost) return;
    if (out.sigma_t.empty()) {
        const float multiplier = 0.5f * (medium.multiplier.lo + medium.multiplier.hi);
        out.sigma_t.assign(out.position.size(), limits::kSigmaT.clamp(1e-4f * medium.extinction * multiplier));
    }
    const std::vector<gpu::Particle> particles = particlesOf(out);
    std::vector<gpu::Particle> merged;
    LastingGroups groups;
    groups.build(particles, kMost);
    groups.merge(particles, medium.falloff, merged);
    facts.notes.push_back(
        fmt::format("{} points are merged to {}: a scene has at most {}", particles.size(), merged.size(), kMost));
    facts.by_depth = false; // they differ now
    const bool coloured = !out.albedo.empty();
    out.position.clear(), out.scale.clear(), out.sigma_t.clear(), out.albedo.clear();
    for (const gpu::Particle& p : merged) {
        out.position.push_back(p.centre);
        out.scale.push_back(limits::kScale.clamp(p.scale));
        out.sigma_t.push_back(limits::kSigmaT.clamp(p.sigma_t));
        if (coloured) out.albedo.push_back(p.albedo);
    }
}

// Fills out.scale and says where the sizes came from.
std::string placeSizes(const PointCloud& cloud, const Medium& medium, Placement& out) {
    if (medium.model == kTetrahedraMedium) {
        out.scale = cornerScales(cloud, out.position, medium);
        return {};
    }
    out.own_scale = !cloud.scale.empty() || !cloud.radius.empty() || !cloud.deviation.empty();
    if (!cloud.scale.empty()) {
        out.scale = cloud.scale;
        return "the file's scale";
    }
    if (!cloud.radius.empty()) { // along an axis, a ball's mean square distance from its centre is radius^2 / 5
        for (const float radius : cloud.radius) out.scale.push_back(scaleOf(radius / kSqrt5, medium));
        return "from the file's radius";
    }
    if (!cloud.deviation.empty()) {
        for (const float deviation : cloud.deviation) out.scale.push_back(scaleOf(deviation, medium));
        return "from the splats' scale_0 to scale_2";
    }
    if (const float distance = medium.scale_by_spacing ? spacing(out.position) : 0; distance > 0) {
        out.scale.assign(out.position.size(), scaleOf(0.5f * distance, medium));
        return "from the spacing of the points, as no size came; medium.scale replaces it";
    }
    Random random(medium.seed);
    while (out.scale.size() < out.position.size())
        out.scale.push_back(random.uniform(medium.scale.lo, medium.scale.hi));
    return "medium.scale";
}

// The extinction of every particle with which the cloud's mean optical depth is kDepth.
float extinctionByDepth(const Medium& medium, const Placement& placed) {
    constexpr double kDepth = 3; // light is seen to come in, and hardly anything is seen through
    double mass = 0;             // per unit of extinction
    float largest = 0;
    glm::dvec3 lo(std::numeric_limits<double>::max()), hi = -lo;
    for (size_t i = 0; i < placed.position.size(); ++i) {
        const double deviation = double(deviationOf(placed.scale[i], medium)) * double(kSqrt2Pi);
        mass += deviation * deviation * deviation * (placed.axes.empty() ? 1 : partOfBall(placed.axes[i]));
        largest = std::max(largest, deviationOf(placed.scale[i], medium));
        lo = glm::min(lo, glm::dvec3(placed.position[i]));
        hi = glm::max(hi, glm::dvec3(placed.position[i]));
    }
    return limits::kSigmaT.clamp(float(kDepth / opticalDepth(mass, lo, hi, 3.0 * double(largest))));
}

// Fills out.sigma_t if the file has extinctions, or the scene leaves them open, and says where they come from.
std::string placeExtinctions(const PointCloud& cloud, const Medium& medium, Placement& out) {
    out.sigma_t = cloud.sigma_t;
    if (cloud.sigma_t.empty() && cloud.opacity.empty() && medium.extinction_by_depth && !out.position.empty()) {
        out.sigma_t.assign(out.position.size(), extinctionByDepth(medium, out));
        return "for an optical depth of 3, as none came; medium.extinction replaces it";
    }
    if (cloud.opacity.empty())
        return cloud.sigma_t.empty() ? "medium.extinction, medium.multiplier"
               : cloud.of_cells      ? "from the file's tetrahedra"
                                     : "the file's sigma_t";
    // On a ray through the centre the optical depth is peak * deviation * sqrt(2 pi), and 1 - opacity is left. Of an
    // ellipsoid it is the ray along the shortest axis.
    for (size_t i = 0; i < cloud.opacity.size(); ++i) {
        const auto depth = float(depthOf(double(std::min(cloud.opacity[i], kMostOpacity))));
        const float deviation = deviationOf(out.scale[i], medium) * (out.axes.empty() ? 1 : shortestAxis(out.axes[i]));
        out.sigma_t.push_back(limits::kSigmaT.clamp(depth / (deviation * kSqrt2Pi)));
    }
    return "from the file's opacity";
}

} // namespace

double opticalDepth(double mass, glm::dvec3 lo, glm::dvec3 hi, double reach) {
    const glm::dvec3 side = hi - lo + 4.0 / 3 * reach;
    return mass * 3 / (side.x * side.y + side.y * side.z + side.z * side.x);
}

Placement placePointCloud(const Medium& medium, glm::dvec3 origin) {
    const bool sequence = medium.layout == Layout::sequence, tetrahedra = medium.model == kTetrahedraMedium;
    const bool ellipsoids = medium.model == kEllipsoidMedium, may_be_many = !sequence && !tetrahedra && !ellipsoids;
    PointCloud cloud = loadPly(medium.file, frameOf(medium, origin),
                               {.ids = sequence,
                                .tetrahedra = tetrahedra,
                                .axes = ellipsoids,
                                .velocities = sequence,
                                .may_be_empty = sequence,
                                .drop_far = medium.far_points == "drop" && !tetrahedra,
                                .most = may_be_many ? kMostPlyPoints : uint64_t(limits::kCount.hi)});
    Placement out;
    out.id = std::move(cloud.id);
    out.velocity = std::move(cloud.velocity);
    out.position = std::move(cloud.position);
    out.axes = std::move(cloud.axes);
    PointCloudFacts facts;
    facts.sizes_from = placeSizes(cloud, medium, out);
    facts.extinctions_from = placeExtinctions(cloud, medium, out);
    facts.by_depth = cloud.sigma_t.empty() && cloud.opacity.empty() && !out.sigma_t.empty();
    out.albedo = std::move(cloud.albedo);
    facts.notes = std::move(cloud.notes);
    mergeMany(medium, out, facts);
    facts.coloured = !out.albedo.empty();
    facts.ignored = std::move(cloud.ignored);
    facts.kept = out.position.size();
    facts.dropped = cloud.dropped;
    facts.first_dropped = std::move(cloud.first_dropped);
    out.cloud = std::move(facts);
    return out;
}

} // namespace brume
