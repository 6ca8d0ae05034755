// Views that are planned for, of many: a plan's time grows with them, and pictures of viewers at like distances need
// like ways.
#pragma once

#include <span>
#include <vector>

#include "server/plan/corrections.h"
#include "server/plan/work.h"

namespace brume {

// Views that are planned for at most.
inline constexpr size_t kMostPlanViews = 8;

// At most kMostPlanViews of `views`, in which each stands for those next to it in the size of the medium's picture:
// PlanView::weight. Of those it is the one whose laws are the most too low, and else the one that sees the medium
// largest. Views in the medium stand for no others than such. Few views are all planned for.
std::vector<PlanView> alikeViews(std::span<const PlanView> views, const MediumExtent& extent,
                                 const Corrections& corrections);

} // namespace brume
