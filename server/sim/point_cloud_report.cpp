#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/gtc/quaternion.hpp>
#include <spdlog/spdlog.h>

#include "common/camera.h"
#include "common/ellipsoid.h"
#include "common/scene_limits.h"
#include "common/tetrahedra.h"
#include "common/text.h"
#include "server/sim/point_cloud.h"
#include "server/sim/sequence_files.h"
#include "server/sim/simulation.h"

namespace brume {

namespace {

constexpr size_t kLongestList = 300;    // bytes of names from the file
constexpr double kNearlyNothing = 0.05; // optical depth: so much of the light is taken away that one hardly sees it
constexpr float kSmallestSide = 0.02f;  // m, of a cloud that a viewer can be near to
constexpr float kVisibleDeviations = 3; // a particle reaches as far
constexpr uint32_t kWidth = 16, kHeight = 9; // shape of the picture in which the camera looks for particles

std::string vectorText(glm::dvec3 v) { return fmt::format("[{:.7g}, {:.7g}, {:.7g}]", v.x, v.y, v.z); }

std::string rangeText(float lo, float hi) {
    return lo < hi ? fmt::format("{:.4g} to {:.4g}", lo, hi) : fmt::format("{:.4g}", lo);
}

// The keys that give the extinction which was chosen.
std::string asKeys(float sigma_t) {
    return fmt::format("; as medium.multiplier = 1 with medium.extinction = {:.4g}", double(sigma_t) * 1e4);
}

// What the lines are about: particles of a cloud as loaded.
struct Cloud {
    Cloud(const Scene& of, const Simulation& simulation)
        : scene(of), facts(*simulation.pointCloud()), bounds(simulation.bounds()), particles(simulation.liveCount()),
          axes(simulation.axes()) {
        simulation.write(particles);
    }
    glm::dvec3 world(glm::vec3 place) const { return scene.origin + glm::dvec3(place); }
    std::string boxText() const { return vectorText(world(bounds.lo)) + " to " + vectorText(world(bounds.hi)) + " m"; }
    float deviation(const gpu::Particle& p) const { return 0.1f * p.scale * scene.medium.falloff; }
    float reach() const { return kVisibleDeviations * 0.1f * bounds.max_scale * scene.medium.falloff; }

    const Scene& scene;
    const PointCloudFacts& facts;
    const Bounds& bounds;
    std::vector<gpu::Particle> particles;
    std::span<const gpu::EllipsoidAxes> axes; // of ellipsoids
};

template <class Member>
std::string rangeOf(const Cloud& cloud, Member member) {
    const auto [lo, hi] = std::minmax_element(cloud.particles.begin(), cloud.particles.end(),
                                              [&](const auto& a, const auto& b) { return a.*member < b.*member; });
    return rangeText((*lo).*member, (*hi).*member);
}

// The integral of the extinction over a tetrahedron.
double massOf(const glm::uvec4& cell, const std::vector<gpu::Particle>& corners) {
    const auto &a = corners[cell.x], &b = corners[cell.y], &c = corners[cell.z], &d = corners[cell.w];
    const glm::dvec3 from(a.centre), across = glm::cross(glm::dvec3(b.centre) - from, glm::dvec3(c.centre) - from);
    const double volume = std::abs(glm::dot(across, glm::dvec3(d.centre) - from)) / 6;
    return volume * (double(a.sigma_t) + double(b.sigma_t) + double(c.sigma_t) + double(d.sigma_t)) / 4;
}

// Mean optical depth of the cloud's box, seen along the axes.
double depthOf(const Cloud& cloud) {
    double mass = 0; // integral of the extinction over the volume
    if (cloud.scene.tetrahedra) {
        for (const glm::uvec4& cell : cloud.scene.tetrahedra->corners) mass += massOf(cell, cloud.particles);
        return mass > 0 ? opticalDepth(mass, cloud.bounds.lo, cloud.bounds.hi, 0) : 0;
    }
    for (size_t i = 0; i < cloud.particles.size(); ++i) {
        const gpu::Particle& p = cloud.particles[i];
        const double part = cloud.axes.empty() ? 1 : partOfBall(cloud.axes[i]);
        mass += part * double(p.sigma_t) * std::pow(double(cloud.deviation(p)) * 2.50662827, 3);
    }
    return opticalDepth(mass, cloud.bounds.lo, cloud.bounds.hi, double(cloud.reach()));
}

// True: the particle's visible part may reach into the field of view.
bool sees(const Frustum& frustum, glm::vec3 in_view, float reach) {
    const auto inside = [&](float across, float tangent) { // of one side's plane
        return across + in_view.z * tangent <= reach * std::sqrt(1 + tangent * tangent);
    };
    return -in_view.z > -reach && inside(in_view.x, frustum.right) && inside(-in_view.x, frustum.left) &&
           inside(in_view.y, frustum.up) && inside(-in_view.y, frustum.down);
}

bool seesAny(const Cloud& cloud) {
    const SceneCamera& camera = cloud.scene.camera;
    const Pose pose = lookAt(camera.position, camera.target, camera.fov_y);
    const Frustum frustum = frustumOf(pose, kWidth, kHeight);
    const glm::mat3 view_from_world = glm::mat3_cast(glm::conjugate(pose.orientation));
    if (cloud.scene.tetrahedra)
        return std::ranges::any_of(cloud.scene.tetrahedra->corners, [&](const glm::uvec4& cell) {
            glm::vec3 middle(0);
            for (int m = 0; m < 4; ++m) middle += 0.25f * cloud.particles[cell[m]].centre;
            float reach = 0;
            for (int m = 0; m < 4; ++m) reach = std::max(reach, glm::distance(middle, cloud.particles[cell[m]].centre));
            return sees(frustum, view_from_world * (middle - pose.position), reach);
        });
    return std::any_of(cloud.particles.begin(), cloud.particles.end(), [&](const gpu::Particle& p) {
        return sees(frustum, view_from_world * (p.centre - pose.position), kVisibleDeviations * cloud.deviation(p));
    });
}

// The cloud fills the picture: from the middle of its box in the direction of the scene's camera, as close as every
// particle's visible part is within nine tenths of the sides of a picture of 4:3.
SceneCamera cameraOn(const Cloud& cloud) {
    SceneCamera camera = cloud.scene.camera;
    const glm::vec3 direction = glm::normalize(camera.position - camera.target);
    camera.target = 0.5f * (cloud.bounds.lo + cloud.bounds.hi);
    const Pose pose = lookAt(camera.target + direction, camera.target, std::min(camera.fov_y, 2.0f));
    const Frustum frustum = frustumOf(pose, 4, 3);
    const glm::mat3 view_from_world = glm::mat3_cast(glm::conjugate(pose.orientation));
    const float right = 0.9f * frustum.right, up = 0.9f * frustum.up;
    float distance = 0;
    for (const gpu::Particle& p : cloud.particles) {
        const glm::vec3 at = view_from_world * (p.centre - camera.target); // z towards the camera
        const float reach = kVisibleDeviations * cloud.deviation(p);
        const auto fits = [&](float across, float tangent) { // from so far its side is within that plane
            return at.z + (std::abs(across) + reach * std::sqrt(1 + tangent * tangent)) / tangent;
        };
        distance = std::max({distance, fits(at.x, right), fits(at.y, up)});
    }
    camera.position = camera.target + distance * direction;
    for (int i = 0; i < 3; ++i) camera.position[i] = limits::kPlace.clamp(camera.position[i]);
    return camera;
}

// The camera cannot see the cloud: where it could stand instead.
std::string unseenText(const Cloud& cloud) {
    const SceneCamera &camera = cloud.scene.camera, on_all = cameraOn(cloud);
    return fmt::format(
        "the scene's camera sees none of the {} points: they are in {}, the camera is at {} and looks at "
        "{}; set camera.position = {} and camera.target = {}, move the points with medium.centre, or write "
        "the file in metres if it is in another unit",
        cloud.particles.size(), cloud.boxText(), vectorText(cloud.world(camera.position)),
        vectorText(cloud.world(camera.target)), vectorText(cloud.world(on_all.position)),
        vectorText(cloud.world(on_all.target)));
}

std::string tetrahedraText(size_t count) { return fmt::format("{} tetrahedr{}", count, count == 1 ? "on" : "a"); }
std::string pointsText(size_t count) { return fmt::format("{} point{}", count, count == 1 ? "" : "s"); }

const char* kind(const PointCloudFacts& facts) { return facts.sequence.empty() ? "point cloud" : "sequence"; }

std::string ignoredText(const PointCloudFacts& facts) {
    if (facts.ignored.empty()) return "every property is read";
    std::string names = fmt::format("{}", fmt::join(facts.ignored, ", "));
    if (names.size() > kLongestList) names = names.substr(0, kLongestList) + "...";
    return "ignored properties: " + names;
}

} // namespace

std::string pointCloudLine(const Scene& scene, const Simulation& simulation) {
    const Cloud cloud(scene, simulation);
    if (cloud.particles.empty())
        return oneLine(fmt::format("{} '{}': {}; the first file has no points", kind(cloud.facts),
                                   scene.medium.file.string(), cloud.facts.sequence));
    const double depth = depthOf(cloud);
    if (!cloud.facts.volume.empty())
        return oneLine(fmt::format("volume '{}': {}, in {}; optical depth about {:.2g}", scene.medium.file.string(),
                                   cloud.facts.volume, cloud.boxText(), depth));
    const std::string before = scene.tetrahedra ? tetrahedraText(scene.tetrahedra->corners.size()) + " of "
                               : cloud.facts.sequence.empty() ? ""
                                                              : cloud.facts.sequence + "; the first file: ";
    const std::string sizes = scene.tetrahedra ? ""
                                               : fmt::format("scale {} m ({}); ", rangeOf(cloud, &gpu::Particle::scale),
                                                             cloud.facts.sizes_from);
    return oneLine(fmt::format("{} '{}': {}{} in {}; {}extinction {} 1/m ({}{}); {}; {}; "
                               "optical depth about {:.2g}",
                               kind(cloud.facts), scene.medium.file.string(), before,
                               pointsText(cloud.particles.size()), cloud.boxText(), sizes,
                               rangeOf(cloud, &gpu::Particle::sigma_t), cloud.facts.extinctions_from,
                               cloud.facts.by_depth ? asKeys(cloud.particles.front().sigma_t) : "",
                               cloud.facts.coloured ? "with colours" : "no colours", ignoredText(cloud.facts), depth));
}

std::vector<std::string> pointCloudWarnings(const Scene& scene, const Simulation& simulation) {
    const Cloud cloud(scene, simulation);
    std::vector<std::string> warnings;
    if (cloud.facts.dropped > 0)
        warnings.push_back(oneLine(fmt::format("{} '{}': dropped {} of {} points; the first, {}", kind(cloud.facts),
                                               scene.medium.file.string(), cloud.facts.dropped,
                                               cloud.facts.dropped + cloud.facts.kept, cloud.facts.first_dropped)));
    for (const std::string& note : cloud.facts.notes)
        warnings.push_back(oneLine(fmt::format("'{}': {}", scene.medium.file.string(), note)));
    if (!cloud.facts.gaps.empty()) warnings.push_back(oneLine(cloud.facts.gaps));
    if (cloud.particles.empty()) return warnings;
    if (const double depth = depthOf(cloud); depth < kNearlyNothing)
        warnings.push_back(
            fmt::format("an optical depth of {:.2g} is nearly transparent: medium.extinction changes it; "
                        "without that and medium.multiplier it is chosen",
                        depth));
    const glm::vec3 sides = cloud.bounds.hi - cloud.bounds.lo;
    if (const float side = std::max({sides.x, sides.y, sides.z}); side > 0 && side < kSmallestSide)
        warnings.push_back(fmt::format("the points lie within {:.2g} m, smaller than a viewer can be near to: "
                                       "medium.unit = {:.0e} shows them a metre wide",
                                       side, scene.medium.unit / side));
    if (!seesAny(cloud)) warnings.push_back(unseenText(cloud));
    return warnings;
}

void placeCamera(Scene& scene) {
    if (!scene.camera_by_points) return;
    const Simulation simulation(scene);
    if (simulation.liveCount() > 0)
        scene.camera = cameraOn(Cloud(scene, simulation));
    else if (scene.medium.layout == Layout::sequence)
        scene.camera = cameraOn(Cloud(scene, Simulation(standIn(scene))));
}

std::vector<std::string> tellOfPointCloud(const Scene& scene, const Simulation& simulation) {
    if (!simulation.pointCloud()) return {};
    std::vector<std::string> lines{pointCloudLine(scene, simulation)};
    spdlog::info("{}", lines.front());
    for (std::string& warning : pointCloudWarnings(scene, simulation)) {
        spdlog::warn("{}", warning);
        lines.push_back(std::move(warning));
    }
    return lines;
}

} // namespace brume
