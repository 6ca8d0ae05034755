#include "tools/reference/obstacle_tree.h"

#include <algorithm>
#include <cmath>

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

bool passes(const Bounds3& bounds, const Ray& ray) {
    Interval inside{ray.begin, ray.end};
    for (int axis = 0; axis < 3; ++axis) {
        const double origin = ray.origin[axis], slope = ray.direction[axis];
        if (slope == 0) {
            if (origin < bounds.lo[axis] || origin > bounds.hi[axis]) return false;
            continue;
        }
        const double a = (bounds.lo[axis] - origin) / slope, b = (bounds.hi[axis] - origin) / slope;
        inside = common(inside, {std::min(a, b), std::max(a, b)});
    }
    return inside.begin <= inside.end;
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
    if (std::ranges::any_of(planes_, visit)) return true;
    for (size_t n = 0; n < nodes_.size();) {
        const BoundingNode& node = nodes_[n];
        const bool entered = enters(node.bounds);
        if (entered && node.item != BoundingNode::kInner && visit(bodies_[node.item])) return true;
        n = entered ? n + 1 : node.next;
    }
    return false;
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
    walk(
        [&](const Bounds3& bounds) {
            if (bodies_.size() <= kFew) return true;
            const glm::dvec3 half = (bounds.hi - bounds.lo) / 2.0, to = (bounds.lo + bounds.hi) / 2.0 - ray.origin;
            return std::abs(glm::dot(normal, to)) <= glm::dot(glm::abs(normal), half + 1e-12 * glm::abs(to));
        },
        [&](int i) {
            reference::shadowEdges(obstacles_[size_t(i)], light, ray, t);
            return false;
        });
}

} // namespace brume::reference
