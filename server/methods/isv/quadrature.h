// The choices of interval shading as its shaders number them (shaders/shared/constants.h).
#pragma once

#include "common/scene.h"
#include "shaders/shared/constants.h"

namespace brume::methods::isv {

inline uint32_t quadratureId(const IsvSettings& settings) {
    return settings.quadrature == "simpson"         ? 0
           : settings.quadrature == "transmittance" ? 1
           : settings.quadrature == "analytic"      ? 2
                                                    : 3;
}

inline uint32_t earlyReturnId(const IsvSettings& settings) {
    return settings.early_return == "sum"     ? gpu::kReturnSum
           : settings.early_return == "fixed" ? gpu::kReturnFixed
                                              : gpu::kReturnNone;
}
inline bool isTurned(const IsvSettings& settings) { return settings.orientation == "random"; }
inline bool dropsNear(const IsvSettings& settings) { return settings.near == "drop"; }

} // namespace brume::methods::isv
