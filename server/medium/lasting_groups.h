// LastingGroups: a large medium as fewer particles, each merged from the same neighbours for as long as the groups
// last. So they move evenly, where levels of detail (levels.h) are made anew each tick.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shaders/shared/types.h"

namespace brume {

class LastingGroups {
public:
    // Groups particles that share a cell, at most `most` of them, in cells as small as that allows. Particles are known
    // by their numbers from then on.
    void build(std::span<const gpu::Particle> particles, uint32_t most);
    void clear() { ends_.clear(), members_.clear(); }

    bool operator==(const LastingGroups&) const = default; // the same particles in the same groups

    // Particles that were grouped; 0: none were.
    size_t particles() const { return members_.size(); }
    size_t size() const { return ends_.size(); }

    // Each group as one particle that keeps the integral of its members' extinction over space, the scattered part of
    // it, the centre of mass and the isotropic second moment. Precondition: as many particles as were grouped.
    void merge(std::span<const gpu::Particle> particles, float falloff, std::vector<gpu::Particle>& out) const;

private:
    std::vector<uint32_t> members_; // group after group
    std::vector<uint32_t> ends_;    // of the groups, in members_
};

} // namespace brume
