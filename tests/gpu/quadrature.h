// The choice of a quadrature by its name alone.
#pragma once

#include <string>

#include "common/settings.h"

namespace brume {

// An empty name changes nothing. Precondition: some method has a quadrature of any other name.
inline void setQuadrature(RenderSettings& render, const std::string& name) {
    if (!name.empty()) apply(Change(quadratureSetting(name)->path, name), {.render = &render});
}

} // namespace brume
