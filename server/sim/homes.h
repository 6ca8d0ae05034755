// Particles with homes: each is drawn to its own by a spring, and none is born or dies.
#pragma once

#include <limits>
#include <utility>
#include <vector>

#include "server/sim/motion.h"

namespace brume {

class Homes : public Motion {
public:
    // A particle's extinction is its weight times min(medium's extinction / unit, most). `unit` 0: always its weight.
    // `albedos`: came with the particles, or empty.
    explicit Homes(uint32_t rows, std::vector<glm::vec3> albedos = {}, float unit = 1,
                   float most = std::numeric_limits<float>::max())
        : rows_(rows), albedos_(std::move(albedos)), unit_(unit), most_(most) {}

    void step(Columns& columns, const MotionStep& step) override;
    void settle(Columns& columns, float extinction) override;
    std::array<Rows, 2> living() const override { return {Rows{0, rows_}, Rows{}}; }
    bool keepsPlaces() const override { return true; }
    std::span<const glm::vec3> albedos() const override { return albedos_; }
    uint64_t bytes() const override { return albedos_.capacity() * sizeof(glm::vec3); }

private:
    uint32_t rows_;
    std::vector<glm::vec3> albedos_;
    float unit_, most_;
};

// Particles that stay at home, whoever pushes.
class Still final : public Homes {
public:
    using Homes::Homes;
    void step(Columns& /*columns*/, const MotionStep& /*step*/) override {}
    bool yields() const override { return false; }
};

} // namespace brume
