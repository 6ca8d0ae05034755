#include "server/sim/homes.h"

#include "server/sim/kernels.h"

namespace brume {

void Homes::step(Columns& columns, const MotionStep& step) {
    springStep(columns, {0, rows_},
               {.dt = static_cast<float>(kTickSeconds),
                .spring = step.settings.spring,
                .viscosity = step.settings.viscosity,
                .volume = step.volume});
}

void Homes::settle(Columns& columns, float extinction) const {
    if (!own_sigma_) setSigma(columns, {0, rows_}, extinction);
}

} // namespace brume
