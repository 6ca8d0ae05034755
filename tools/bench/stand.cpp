#include "tools/bench/stand.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "server/sim/solids.h"

namespace brume::bench {
namespace {

constexpr uint32_t kMostTries = 100000;
constexpr uint32_t kWays = 32; // directions that are compared

// Of the Halton sequence, in [0, 1).
double radicalInverse(uint32_t i, uint32_t base) {
    double sum = 0, part = 1;
    for (; i > 0; i /= base) part /= base, sum += part * (i % base);
    return sum;
}

// What stands in a scene.
class Solids {
public:
    explicit Solids(const Scene& scene) : triangles_(scene.triangles) {
        for (const Box& box : scene.boxes) boxes_.push_back(solidOf(box));
        for (const Sphere& sphere : scene.spheres) balls_.push_back(solidOf(sphere));
    }
    template <class Look>
    void each(const Look& look) const {
        for (const SolidBox& box : boxes_) look(box);
        for (const SolidBall& ball : balls_) look(ball);
        for (const Triangle& triangle : triangles_) look(triangle);
    }
    // m; 0: in one.
    double distanceFrom(glm::dvec3 place) const {
        double least = 1e300;
        each([&](const auto& solid) { least = std::min(least, glm::length(offFrom(solid, place))); });
        return least;
    }
    // m that are free along a way.
    double freeAlong(glm::dvec3 from, glm::dvec3 way) const {
        double part = 1;
        each([&](const auto& solid) {
            if (const std::optional<Met> met = meet(solid, from, way)) part = std::min(part, met->part);
        });
        return part * glm::length(way);
    }

private:
    std::vector<SolidBox> boxes_;
    std::vector<SolidBall> balls_;
    const std::vector<Triangle>& triangles_;
};

// Where a level way of unit direction leaves the bounds, m.
double leavesAfter(const Bounds3& bounds, glm::dvec3 from, glm::dvec3 dir) {
    double end = 1e300;
    for (const int axis : {0, 2})
        if (dir[axis] != 0)
            end = std::min(end, ((dir[axis] > 0 ? bounds.hi : bounds.lo)[axis] - from[axis]) / dir[axis]);
    return end;
}

} // namespace

Bounds3 placeBounds(const Scene& scene, const Bounds& particles) {
    Bounds3 bounds;
    Solids(scene).each([&](const auto& solid) { bounds.add(boundsOf(solid)); });
    if (!(bounds.lo.x <= bounds.hi.x)) bounds = {glm::dvec3(particles.lo), glm::dvec3(particles.hi)};
    return bounds;
}

std::vector<Pose> standInside(const Scene& scene, const Bounds& particles, uint32_t count) {
    const Bounds3 bounds = placeBounds(scene, particles);
    const Solids solids(scene);
    std::optional<double> ground;
    for (const Plane& plane : scene.planes)
        if (double(plane.height) + kEyeHeight < bounds.hi.y)
            ground = std::max(ground.value_or(-1e300), double(plane.height));
    std::vector<Pose> poses;
    for (uint32_t i = 1; poses.size() < count; ++i) {
        if (i > kMostTries || !(bounds.lo.x <= bounds.hi.x))
            throw SceneError(scene.name + ": stand = \"inside\": no room for " + std::to_string(count) + " viewers");
        const glm::dvec3 part(radicalInverse(i, 2), radicalInverse(i, 5), radicalInverse(i, 3));
        glm::dvec3 eye = bounds.lo + part * (bounds.hi - bounds.lo);
        eye.y = ground ? std::max(*ground + kEyeHeight, bounds.lo.y)
                       : bounds.lo.y + (1 + part.y) / 3 * (bounds.hi.y - bounds.lo.y);
        if (solids.distanceFrom(eye) < kStandingRoom) continue;
        double longest = -1;
        glm::dvec3 target;
        for (uint32_t w = 0; w < kWays; ++w) {
            const double angle = 2 * std::numbers::pi * w / kWays;
            const glm::dvec3 dir(std::cos(angle), 0, std::sin(angle));
            const double free = solids.freeAlong(eye, leavesAfter(bounds, eye, dir) * dir);
            if (free > longest + 1e-9) longest = free, target = eye + dir;
        }
        poses.push_back(lookAt(glm::vec3(eye), glm::vec3(target), scene.camera.fov_y));
    }
    return poses;
}

} // namespace brume::bench
