// SetParticles: rows of a medium whose layout is `live`, as a simulation elsewhere sends them.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/glm.hpp>

#include "common/scene_limits.h"

namespace brume {

inline constexpr size_t kMostRows = 3000; // of one message: without albedos they fit 64 KiB, with them 2000 do

// Particles one after another; entry i of each list is of the same one.
struct ParticleRows {
    std::vector<glm::vec3> positions;       // m, relative to the medium's centre and the volume
    std::vector<float> scales, extinctions; // m; 1/m, at the particle's centre
    std::vector<glm::vec3> albedos;         // empty: all have the medium's

    size_t bytes() const {
        return (positions.size() + albedos.size()) * sizeof(glm::vec3) +
               (scales.size() + extinctions.size()) * sizeof(float);
    }
};

struct SetParticles {
    uint32_t first = 0;                                                          // row of the first of them
    uint32_t live = 0;                                                           // rows 0 ... live - 1 are there now
    float seconds = 0;                                                           // until rows that were there arrive
    std::shared_ptr<const ParticleRows> rows = std::make_shared<ParticleRows>(); // never null
};

// What is wrong with a message to a medium of `capacity` rows: one line; empty if nothing is.
inline std::string problemOf(const SetParticles& set, uint32_t capacity) {
    const ParticleRows& rows = *set.rows;
    const size_t count = rows.positions.size();
    if (rows.scales.size() != count || rows.extinctions.size() != count ||
        (!rows.albedos.empty() && rows.albedos.size() != count))
        return fmt::format("{} positions, {} scales, {} extinctions and {} albedos; as many of each, or no albedos",
                           count, rows.scales.size(), rows.extinctions.size(), rows.albedos.size());
    if (count > kMostRows) return fmt::format("{} rows in one message; at most {}", count, kMostRows);
    if (uint64_t{set.first} + count > capacity || set.live > capacity)
        return fmt::format("rows {} ... {}, {} live: the scene has medium.count = {} rows", set.first,
                           uint64_t{set.first} + count, set.live, capacity);
    const auto outside = [](const char* name, size_t row, Limits allowed) {
        return fmt::format("{} of row {} must be {} ... {}", name, row, allowed.lo, allowed.hi);
    };
    const auto holds = [](Limits allowed, glm::vec3 v) {
        return allowed.holds(v.x) && allowed.holds(v.y) && allowed.holds(v.z);
    };
    if (!limits::kMoveTime.holds(set.seconds))
        return fmt::format("seconds must be {} ... {}", limits::kMoveTime.lo, limits::kMoveTime.hi);
    for (size_t i = 0; i < count; ++i) {
        const size_t row = set.first + i;
        if (!holds(limits::kPlace, rows.positions[i])) return outside("the position", row, limits::kPlace);
        if (!limits::kScale.holds(rows.scales[i])) return outside("the scale", row, limits::kScale);
        if (!limits::kSigmaT.holds(rows.extinctions[i])) return outside("the extinction", row, limits::kSigmaT);
        if (!rows.albedos.empty() && !holds(limits::kColour, rows.albedos[i]))
            return outside("the albedo", row, limits::kColour);
    }
    return {};
}

} // namespace brume
