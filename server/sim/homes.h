// Particles with homes: each is drawn to its own by a spring, and none is born or dies.
#pragma once

#include "server/sim/motion.h"

namespace brume {

class Homes final : public Motion {
public:
    // `own_sigma`: true if particles came with their own extinctions (1/m), so that the medium's does not apply.
    Homes(uint32_t rows, bool own_sigma) : rows_(rows), own_sigma_(own_sigma) {}

    void step(Columns& columns, const MotionStep& step) override;
    void settle(Columns& columns, float extinction) const override;
    std::array<Rows, 2> living() const override { return {Rows{0, rows_}, Rows{}}; }

private:
    uint32_t rows_;
    bool own_sigma_;
};

} // namespace brume
