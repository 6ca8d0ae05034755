// Compares the plan's predictions with measurements: fits the cost model to this device, and tabulates predicted and
// measured values.
#pragma once

#include "server/plan/cost_model.h"
#include "tools/bench/truth.h"

namespace brume::bench {

// Times a few scenes and settings for about `seconds`, and fits the cost per unit of work of each pass. Reports on
// standard error how well the costs fit.
CostModel calibrate(const gpu::Device& device, double seconds);

struct PlanTable {
    std::vector<std::string> scenes{"cloud", "cloud-5000", "tubes", "props", "plume", "cumulus", "cloud-65535"};
    std::vector<std::string> cameras{"outside", "inside"}; // poseOf()
    std::vector<std::string> set;                          // key=value, replaces the scenes' values
};

// Renders all scenes from all cameras at 640x360 and compares every fifth pixel. Returns Markdown: the plan's choice,
// predicted and measured times and errors, and the largest differences. These are given apart for views that the laws
// of server/plan/plan.cpp were fitted on, and for others.
std::string planTable(const gpu::Device& device, const CostModel& model, Truth& truth, const PlanTable& wanted);

} // namespace brume::bench
