// The path of a ray within particles by the steps that Mattsson (2022, sections 3.1 and 4.3.3) prints: a control, and
// what the merging of intervals (shaders/shared/interval_set.h) is timed against.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tools/reference/world.h"

namespace brume::bench {

// Where a ray enters a particle, +1, or leaves one, -1. A slot without a hit has 0 and 0.
struct PathHit {
    float t = 0; // m
    int value = 0;
};

enum class PathSort {
    slots,  // bubble sort of all slots, as many rounds as there are slots
    early,  // the same, but it ends with the first round that changes nothing
    stored, // bubble sort of the slots with hits
};

// Sorts the slots and returns the path, m, by the counter of equation 3.1. Hits are in the first slots, in any order.
float printedPath(std::span<PathHit> slots, PathSort sort);
// The same path by merging intervals. `hits`: each particle's entry, if it is not behind the begin of the ray, before
// its exit.
float mergedPath(std::span<const PathHit> hits);

// Hits of the ray from the centre of ball `i`, ball after ball.
std::vector<PathHit> hitsOf(const reference::UnionMedium& medium, size_t i, glm::dvec3 to_light);

// The part of the whole line through the ray that is inside a regular icosahedron; empty if there is none.
// `radius`: m, from the centre to its corners.
reference::Interval insideIcosahedron(glm::dvec3 centre, double radius, const reference::Ray& ray);

// Series of rows, as of a sweep: microseconds a ray on one core by cut-off and by number of particles, the least of
// `repeats`, without finding the hits; and what icosahedra change. Rays go from the centres of `tubes-union`'s balls to
// a light. Those with as many hits as the cut-off are black, and nothing is sorted.
nlohmann::json printedPathSeries(uint32_t repeats);

} // namespace brume::bench
