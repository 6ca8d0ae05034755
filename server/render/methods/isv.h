// Interval shaded volumetrics (seed 000): tetrahedra as interval proxies, by mesh shader where the device has it.
#pragma once

#include "server/render/method.h"

namespace brume {
std::unique_ptr<Method> makeIsv(const MethodContext& context);
}
