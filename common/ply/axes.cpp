#include "common/ply/axes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "common/ply/extent.h"
#include "shaders/shared/ellipsoid.h"

namespace brume::ply {
namespace {

constexpr double kMostCosine = 1e-3; // between two axes
constexpr double kExact = 1e-6;      // axes that lack so little are kept to the last bit

glm::dvec3 acrossOf(glm::dvec3 unit) {
    const glm::dvec3 size = glm::abs(unit);
    const glm::dvec3 other = size.x <= size.y && size.x <= size.z ? glm::dvec3(1, 0, 0)
                             : size.y <= size.z                   ? glm::dvec3(0, 1, 0)
                                                                  : glm::dvec3(0, 0, 1);
    return glm::normalize(glm::cross(unit, other));
}

} // namespace

PointAxes axesOf(const Points& points, size_t i, const std::string& up) {
    PointAxes out;
    std::array<glm::dvec3, 3> axes;
    std::array<double, 3> lengths{};
    for (size_t axis = 0; axis < 3; ++axis) {
        const auto number = [&](size_t n) { return points.columns[kAxisAX + 3 * axis + n][i]; };
        axes[axis] = turned({number(0), number(1), number(2)}, up);
        lengths[axis] = glm::length(axes[axis]);
        if (!std::isfinite(lengths[axis])) out.problem = "an axis is not finite";
    }
    const size_t first = size_t(std::ranges::max_element(lengths) - lengths.begin());
    out.longest = lengths[first];
    if (out.problem.empty() && !(out.longest > 0)) out.problem = "no axis has a length";
    if (!out.problem.empty()) return out;
    double cosine = 0;
    for (size_t a = 0; a < 3; ++a) {
        const size_t b = (a + 1) % 3;
        if (std::min(lengths[a], lengths[b]) > kExact * out.longest)
            cosine = std::max(cosine, std::abs(glm::dot(axes[a], axes[b])) / (lengths[a] * lengths[b]));
    }
    if (cosine > kMostCosine) {
        out.problem = fmt::format("the cosine of two of its axes is {:.3g}; allowed: right angles", cosine);
        return out;
    }
    double volume = 1;
    for (double& length : lengths) {
        const double part = length / out.longest, kept = std::max(part, double(gpu::kLeastAxis));
        volume *= part / kept;
        length = kept;
    }
    out.volume = volume;
    if (volume == 1 && cosine < kExact && std::abs(out.longest - 1) < kExact) {
        out.axes = {glm::vec3(axes[0]), glm::vec3(axes[1]), glm::vec3(axes[2])};
        out.longest = 1;
        return out;
    }
    // The shortest has what direction the others leave: a file may give it none.
    const size_t second = lengths[(first + 1) % 3] >= lengths[(first + 2) % 3] ? (first + 1) % 3 : (first + 2) % 3,
                 third = 3 - first - second;
    const glm::dvec3 u = glm::normalize(axes[first]), across = axes[second] - glm::dot(axes[second], u) * u;
    const glm::dvec3 v = glm::length(across) > kExact * out.longest ? glm::normalize(across) : acrossOf(u);
    std::array<glm::vec3, 3> made;
    made[first] = glm::vec3(u);
    made[second] = glm::vec3(lengths[second] * v);
    made[third] = glm::vec3(lengths[third] * glm::cross(u, v));
    out.axes = {made[0], made[1], made[2]};
    return out;
}

} // namespace brume::ply
