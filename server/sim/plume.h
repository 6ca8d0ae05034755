// Particles of an emitter, in a ring buffer in the order of their births. All live equally long, so the living
// particles are one contiguous run of the ring.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "common/scene.h"
#include "server/sim/kernels.h"

namespace brume {

class Plume {
public:
    Plume(const Medium& medium, float viscosity);

    // Ages and moves the living particles and retires the oldest. Then adds those born by the end of simulation step
    // `steps` (the first step is 1).
    void step(Columns& columns, uint64_t steps, glm::vec3 volume);
    // Sets scale and sigma of the living particles. To be called after every step and after every change of the
    // extinction.
    void ageTo(Columns& columns, float extinction) const;

    // Rows of the living particles, oldest first, in at most two runs.
    std::array<Rows, 2> living() const;
    uint32_t liveCount() const { return static_cast<uint32_t>(born_ - oldest_); }
    uint64_t born() const { return born_; }

private:
    void bear(Columns& columns, double now, glm::vec3 volume);

    Emitter emitter_;
    Range scale_, multiplier_;
    uint64_t seed_;
    uint32_t pool_;
    float viscosity_;
    Turbulence turbulence_;
    uint64_t born_ = 0, oldest_ = 0; // births so far; deaths so far. Particle number n is in row n % pool_
};

} // namespace brume
