// The plan's predictions against measurements: its constants on this device, and how well the whole holds.
#pragma once

#include "server/plan/cost_model.h"
#include "tools/bench/truth.h"

namespace brume::bench {

// Times a few scenes and settings, for about `seconds`, and fits the cost of each pass's unit of work to them. Says on standard
// error how well that went.
CostModel calibrate(const gpu::Device& device, double seconds);

struct PlanTable {
    std::vector<std::string> scenes{"cloud", "cloud-5000", "tubes", "props", "plume", "cumulus", "cloud-65535"};
    std::vector<std::string> cameras{"outside", "inside"}; // poseOf()
    std::vector<std::string> set;                          // key=value instead of the scenes'
};

// Scenes seen from everywhere, 640x360, every fifth pixel compared: what the plan chooses, the times and errors that it predicts,
// and those that are measured; and how far they are apart at worst, by whether the laws of server/plan/plan.cpp were fitted on
// the view. Markdown.
std::string planTable(const gpu::Device& device, const CostModel& model, Truth& truth, const PlanTable& wanted);

} // namespace brume::bench
