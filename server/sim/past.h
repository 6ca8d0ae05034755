// Past: particles and the sun's direction in the last ticks, for what is computed of some particles in each tick.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "common/scene_limits.h"
#include "shaders/shared/types.h"

namespace brume {

struct PastTick {
    uint64_t tick = 0;
    glm::vec3 to_light{0, 1, 0};
    std::vector<gpu::Particle> particles;
};

class Past {
public:
    // For as many particles in each tick.
    explicit Past(uint32_t particles) : ticks_(size_t(limits::kPathGroups.hi)) {
        for (PastTick& one : ticks_) one.particles.resize(particles);
    }
    // Room for the next tick, in place of the oldest. Every tick number is one more than the last one.
    PastTick& next(uint64_t tick) {
        first_ = kept_ == 0 ? tick : first_;
        ++kept_;
        PastTick& one = ticks_[tick % ticks_.size()];
        one.tick = tick;
        return one;
    }
    // The tick of this number; of one that is not kept the oldest there is. Precondition: next() was called.
    const PastTick& at(uint64_t tick) const {
        const uint64_t last = first_ + kept_ - 1, oldest = kept_ > ticks_.size() ? last + 1 - ticks_.size() : first_;
        return ticks_[(tick < oldest ? oldest : tick) % ticks_.size()];
    }
    uint64_t bytes() const { return ticks_.size() * ticks_.front().particles.size() * sizeof(gpu::Particle); }

private:
    std::vector<PastTick> ticks_;
    uint64_t first_ = 0, kept_ = 0; // number of the first tick that was kept, and how many were
};

} // namespace brume
