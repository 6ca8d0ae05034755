// Order-independent slabs: optical depth and in-scattered light of the true overlapping medium along a coarse grid of rays, which
// the medium's band limit allows; no sort (physics: "Order-independent slabs").
#pragma once

#include "server/render/method.h"

namespace brume {
std::unique_ptr<Method> makeSlabs(const MethodContext& context);
}
