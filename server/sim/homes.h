// Particles with homes: each is drawn to its own by a spring, and none is born or dies.
#pragma once

#include <limits>

#include "server/sim/motion.h"

namespace brume {

class Homes final : public Motion {
public:
    // A particle's extinction is its weight times min(medium's extinction / unit, most). `unit` 0: always its weight.
    explicit Homes(uint32_t rows, float unit = 1, float most = std::numeric_limits<float>::max())
        : rows_(rows), unit_(unit), most_(most) {}

    void step(Columns& columns, const MotionStep& step) override;
    void settle(Columns& columns, float extinction) const override;
    std::array<Rows, 2> living() const override { return {Rows{0, rows_}, Rows{}}; }

private:
    uint32_t rows_;
    float unit_, most_;
};

} // namespace brume
