#include "tools/bench/printed_path.h"

#include <algorithm>
#include <cmath>

#include "shaders/shared/interval_set.h"
#include "tools/reference/geometry.h"

namespace brume::bench {

using reference::Interval;
using reference::Ray;

namespace {

// `early`: ends with the first round that changes nothing.
void bubbleSort(std::span<PathHit> slots, bool early) {
    for (size_t round = 1; round < slots.size(); ++round) {
        bool changed = false;
        for (size_t i = 0; i + round < slots.size(); ++i)
            if (slots[i].t > slots[i + 1].t) std::swap(slots[i], slots[i + 1]), changed = true;
        if (early && !changed) return;
    }
}

} // namespace

float printedPath(std::span<PathHit> slots, PathSort sort) {
    size_t stored = slots.size();
    if (sort == PathSort::stored) stored = size_t(std::ranges::find(slots, 0, &PathHit::value) - slots.begin());
    bubbleSort(slots.first(stored), sort == PathSort::early);
    int counter = 0;
    for (const PathHit& hit : slots) counter -= hit.value;
    float entry = 0, path = 0;
    bool within = counter > 0;
    for (const PathHit& hit : slots) {
        if (hit.value == 0) continue;
        if (!within) entry = hit.t, within = true;
        counter += hit.value;
        if (counter == 0) path += hit.t - entry, within = false;
    }
    return path;
}

float mergedPath(std::span<const PathHit> hits) {
    physics::IntervalSet<float> parts;
    parts.count = 0, parts.fused = 0;
    float begin = 0;
    for (const PathHit& hit : hits) {
        if (hit.value > 0) {
            begin = hit.t;
        } else {
            physics::addInterval(parts, begin, hit.t);
            begin = 0;
        }
    }
    return physics::lengthOf(parts);
}

std::vector<PathHit> hitsOf(const reference::UnionMedium& medium, size_t i, glm::dvec3 to_light) {
    std::vector<PathHit> hits;
    const Ray ray{medium.balls[i].centre, to_light};
    for (const reference::UnionMedium::Ball& ball : medium.balls) {
        const Interval part = reference::insideSphere(ball.centre, ball.radius, ray);
        if (part.empty() || !(part.end > 0)) continue;
        if (part.begin > 0) hits.push_back({float(part.begin), 1});
        hits.push_back({float(part.end), -1});
    }
    return hits;
}

Interval insideIcosahedron(glm::dvec3 centre, double radius, const Ray& ray) {
    // Its faces look toward the corners of a dodecahedron: (1, 1, 1) and (0, 1 / g, g) with all signs, the latter in
    // turns. g: the golden ratio.
    const double g = (1 + std::sqrt(5.0)) / 2, length = std::sqrt(3.0);
    const double inner = radius * g * g / (std::sqrt(3.0) * std::sqrt(g * std::sqrt(5.0))); // m, to the faces
    Interval part{-reference::kInfinity, reference::kInfinity};
    const auto cut = [&](glm::dvec3 normal) {
        normal /= length;
        const double slope = glm::dot(normal, ray.direction), off = glm::dot(normal, centre - ray.origin);
        for (const double side : {off - inner, off + inner}) { // both planes across the normal
            if (slope == 0) continue;
            const double t = side / slope;
            if ((side > off) == (slope > 0))
                part.end = std::min(part.end, t);
            else
                part.begin = std::max(part.begin, t);
        }
        if (slope == 0 && std::abs(off) > inner) part = {0, 0};
    };
    for (const double y : {-1.0, 1.0})
        for (const double z : {-1.0, 1.0}) cut({1, y, z});
    for (const double sign : {-1.0, 1.0}) {
        cut({0, sign / g, g});
        cut({sign / g, g, 0});
        cut({g, 0, sign / g});
    }
    return part;
}

} // namespace brume::bench
