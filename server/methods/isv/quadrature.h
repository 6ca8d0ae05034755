// The quadratures of interval shading as its shaders number them (kIdQuadrature in shaders/shared/constants.h).
#pragma once

#include "common/scene.h"

namespace brume::methods::isv {

inline uint32_t quadratureId(const IsvSettings& settings) {
    return settings.quadrature == "simpson"         ? 0
           : settings.quadrature == "transmittance" ? 1
           : settings.quadrature == "analytic"      ? 2
                                                    : 3;
}

} // namespace brume::methods::isv
