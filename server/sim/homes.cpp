#include "server/sim/homes.h"

#include <algorithm>

#include "server/sim/kernels.h"

namespace brume {

void Homes::step(Columns& columns, const MotionStep& step) {
    springStep(columns, {0, rows_},
               {.dt = static_cast<float>(kTickSeconds),
                .spring = step.settings.spring,
                .viscosity = step.settings.viscosity,
                .volume = step.volume});
}

void Homes::settle(Columns& columns, float extinction) {
    setSigma(columns, {0, rows_}, unit_ > 0 ? std::min(extinction / unit_, most_) : 1);
}

} // namespace brume
