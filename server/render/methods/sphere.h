// Sphere proxies with the full Gaussian (seed 000 section 6.2 names them as future work).
#pragma once

#include "server/render/method.h"

namespace brume {
std::unique_ptr<Method> makeSphere(const MethodContext& context);
}
