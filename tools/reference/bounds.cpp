#include "tools/reference/bounds.h"

#include <algorithm>
#include <cmath>

#include "tools/reference/geometry.h"

namespace brume::reference {

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

bool meetsPlane(const Bounds3& bounds, glm::dvec3 normal, glm::dvec3 origin) {
    const glm::dvec3 half = (bounds.hi - bounds.lo) / 2.0, to = (bounds.lo + bounds.hi) / 2.0 - origin;
    return std::abs(glm::dot(normal, to)) <= glm::dot(glm::abs(normal), half + 1e-12 * glm::abs(to));
}

} // namespace brume::reference
