// An emitter's smoke: a ring of particles in the order of their births. All live equally long, so the living are one run of the
// ring.
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

    // Ages, moves and retires the living, then bears what is due at the end of simulated step `steps` (the first is 1).
    void step(Columns& columns, uint64_t steps, glm::vec3 volume);
    // Scale and sigma of the living; due after every step and after every change of the extinction.
    void ageTo(Columns& columns, float extinction) const;

    // The living, oldest first, in at most two runs of rows.
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
    uint64_t born_ = 0, oldest_ = 0; // births so far, and how many of them are dead; birth number n lives in row n % pool
};

} // namespace brume
