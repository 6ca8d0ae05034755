// The plan of methods that draw the particles they see one after the other, far to near: what they have in common.
#pragma once

#include <numbers>

#include "server/plan/method_plan.h"

namespace brume {

namespace costs {
inline constexpr CostInfo kOrder{"order", "cull, sort", 1300}; // particles + 2000: cull and sort
} // namespace costs

inline constexpr double kDiscOfBox = std::numbers::pi / 4; // part of the box around a sphere's picture that it covers

// Surfaces, order and composing of a view.
inline void addDrawnWork(const ViewWork& view, Work& work) {
    constexpr double kLeastSorted = 2000; // the passes of the sort, with however few
    work[costs::kOpaque] = view.pixels() * (1 + view.scene().objects);
    work[costs::kCompose] = view.pixels();
    work[costs::kOrder] = view.scene().particles + kLeastSorted;
}

} // namespace brume
