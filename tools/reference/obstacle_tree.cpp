#include "tools/reference/obstacle_tree.h"

#include <algorithm>
#include <cmath>

#include "tools/reference/bounds.h"

namespace brume::reference {
namespace {

// Of so few all edges are kept: those that are none make the quadrature's panels shorter.
constexpr size_t kFew = 32;

// Bounds of an obstacle that is no plane, with room for roundings.
Bounds3 boundsOf(const Obstacle& o) {
    if (o.kind == Obstacle::Kind::triangle) {
        Bounds3 bounds;
        for (const glm::dvec3& corner : o.corners) {
            const glm::dvec3 room = 1e-12 * glm::abs(corner) + 1e-12;
            bounds.add({corner - room, corner + room});
        }
        return bounds;
    }
    const double c = std::abs(std::cos(o.yaw)), s = std::abs(std::sin(o.yaw));
    const glm::dvec3 h = o.half_size;
    glm::dvec3 reach =
        o.kind == Obstacle::Kind::sphere ? glm::dvec3(h.x) : glm::dvec3(c * h.x + s * h.z, h.y, s * h.x + c * h.z);
    reach += 1e-12 * (reach + glm::abs(o.centre));
    return {o.centre - reach, o.centre + reach};
}

} // namespace

ObstacleTree::ObstacleTree(std::span<const Obstacle> obstacles) : obstacles_(obstacles) {
    std::vector<Bounds3> bounds;
    for (int i = 0; i < int(obstacles.size()); ++i) {
        const bool plane = obstacles[i].kind == Obstacle::Kind::plane;
        (plane ? planes_ : bodies_).push_back(i);
        if (!plane) bounds.push_back(boundsOf(obstacles[i]));
    }
    nodes_ = boundingTree(bounds);
}

template <class Enters, class Visit>
bool ObstacleTree::walk(const Enters& enters, const Visit& visit) const {
    return std::ranges::any_of(planes_, visit) ||
           reference::walk(nodes_, enters, [&](uint32_t item) { return visit(bodies_[item]); });
}

Hit ObstacleTree::nearest(const Ray& ray) const {
    Hit first;
    Ray left = ray; // up to what is hit so far
    walk([&](const Bounds3& bounds) { return passes(bounds, left); },
         [&](int i) {
             Hit hit = reference::nearest(obstacles_.subspan(size_t(i), 1), left);
             if (hit.object < 0 || (hit.t == first.t && i > first.object)) return false;
             hit.object = i;
             first = hit;
             left.end = hit.t;
             return false;
         });
    return first;
}

bool ObstacleTree::occluded(const Ray& ray, int skip) const {
    return walk([&](const Bounds3& bounds) { return passes(bounds, ray); },
                [&](int i) { return i != skip && reference::occluded(obstacles_.subspan(size_t(i), 1), ray); });
}

void ObstacleTree::shadowEdges(const LightSource& light, const Ray& ray, std::vector<double>& t) const {
    const bool distant = light.kind == LightSource::Kind::directional;
    // A shadow reaches the ray from an obstacle that meets the plane of the ray and the light.
    const glm::dvec3 normal = glm::cross(ray.direction, distant ? light.to_light : light.position - ray.origin);
    walk([&](const Bounds3& bounds) { return bodies_.size() <= kFew || meetsPlane(bounds, normal, ray.origin); },
         [&](int i) {
             reference::shadowEdges(obstacles_[size_t(i)], light, ray, t);
             return false;
         });
}

} // namespace brume::reference
