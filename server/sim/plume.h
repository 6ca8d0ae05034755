// Particles of an emitter, in a ring buffer in the order of their births. All live equally long, so the living
// particles are one contiguous run of the ring.
#pragma once

#include "server/sim/kernels.h"
#include "server/sim/motion.h"

namespace brume {

class Plume final : public Motion {
public:
    explicit Plume(const Medium& medium);

    // A full column from the first picture on.
    uint64_t runUp() const override;
    // Ages and moves the living particles and retires the oldest. Then adds those born by the end of the step.
    void step(Columns& columns, const MotionStep& step) override;
    void settle(Columns& columns, float extinction) override;
    // Oldest first.
    std::array<Rows, 2> living() const override;
    uint64_t history() const override { return born_; }
    uint64_t firstId() const override { return oldest_; }
    // Of an emitter that cools.
    std::span<const glm::vec3> albedos() const override { return albedos_; }
    uint64_t bytes() const override { return albedos_.capacity() * sizeof(glm::vec3); }
    std::optional<glm::vec3> source() const override { return emitter_.position; }
    void exchange(StateBytes& bytes, Columns& columns, const MotionStep& now) override;
    void keepStart() override { start_born_ = born_, start_oldest_ = oldest_; }
    void restart() override { born_ = start_born_, oldest_ = start_oldest_; }

private:
    void bear(Columns& columns, double now, glm::vec3 volume);
    void cool(const Columns& columns); // sets the albedos of the living particles

    Emitter emitter_;
    glm::vec3 albedo_; // the medium's, which those of the particles come to
    std::vector<glm::vec3> albedos_;
    Range scale_, multiplier_;
    uint64_t seed_;
    uint32_t pool_;
    Turbulence turbulence_;
    uint64_t born_ = 0, oldest_ = 0;             // births so far; deaths so far. Particle number n is in row n % pool_
    uint64_t start_born_ = 0, start_oldest_ = 0; // the same when keepStart() was called
};

} // namespace brume
