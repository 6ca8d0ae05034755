#include "common/ply/extent.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

namespace brume::ply {
namespace {

constexpr double kInside = 0.98;     // of the points
constexpr double kFar = 20;          // radii
constexpr size_t kFewest = 8;        // points, of which one can be told to be far from the others
constexpr double kFarFromOne = 2000; // m, which are told as km

bool isFinite(glm::dvec3 place) { return std::isfinite(place.x + place.y + place.z); }

// The distance along the axis where it is largest.
double distanceOf(glm::dvec3 place, glm::dvec3 middle) {
    const glm::dvec3 d = glm::abs(place - middle);
    return std::max({d.x, d.y, d.z});
}

} // namespace

glm::dvec3 turned(glm::dvec3 place, const std::string& up) {
    if (up == "x") return {-place.y, place.x, place.z};
    if (up == "z") return {place.x, place.z, -place.y};
    if (up == "-y") return {place.x, -place.y, -place.z};
    return place;
}

glm::dvec3 placeOf(const Points& points, size_t i, const std::string& up) {
    return turned({points.columns[kX][i], points.columns[kY][i], points.columns[kZ][i]}, up);
}

PlyExtent extentOf(const Points& points, const std::string& up) {
    PlyExtent out;
    std::vector<double> numbers; // one of each point at a finite place
    numbers.reserve(points.count());
    const auto take = [&](const auto& number) {
        numbers.clear();
        for (size_t i = 0; i < points.count(); ++i)
            if (const glm::dvec3 place = placeOf(points, i, up); isFinite(place)) numbers.push_back(number(place));
    };
    const auto at = [&](size_t index) { // the number of that rank
        const auto nth = numbers.begin() + std::ptrdiff_t(index);
        std::nth_element(numbers.begin(), nth, numbers.end());
        return *nth;
    };
    for (int axis = 0; axis < 3; ++axis) {
        take([axis](glm::dvec3 place) { return place[axis]; });
        out.count = numbers.size();
        if (numbers.empty()) return out;
        out.middle[axis] = at((numbers.size() - 1) / 2);
    }
    take([&](glm::dvec3 place) { return distanceOf(place, out.middle); });
    const size_t last = numbers.size() - 1;
    out.radius = at(numbers.size() < kFewest ? last : std::min(size_t(kInside * double(last)), last - 1));
    if (!(out.radius > 0)) out.radius = at(last); // nearly all are at one place
    if (!(out.radius > 0)) return out;
    for (const double distance : numbers)
        if (distance > kFar * out.radius) ++out.far, out.farthest = std::max(out.farthest, distance);
    return out;
}

bool isFar(const PlyExtent& extent, glm::dvec3 place) {
    return extent.far > 0 && isFinite(place) && distanceOf(place, extent.middle) > kFar * extent.radius;
}

std::string farText(const PlyExtent& extent, double unit) {
    const double metres = extent.farthest * unit;
    const std::string distance =
        metres < kFarFromOne ? fmt::format("{:.4g} m", metres) : fmt::format("{:.4g} km", metres / 1000);
    return extent.far == 1 ? fmt::format("1 point is {} from the others", distance)
                           : fmt::format("{} points are up to {} from the others", extent.far, distance);
}

} // namespace brume::ply
