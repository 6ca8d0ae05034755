// The plan's predictions against measurements: its constants on this device, and how well the whole holds.
#pragma once

#include "server/plan/cost_model.h"
#include "tests/bench/truth.h"

namespace brume::bench {

// Times a few scenes and settings, for about `seconds`, and fits the cost of each pass's unit of work to them. Says on standard
// error how well that went.
CostModel calibrate(const gpu::Device& device, double seconds);

// A table of the shipped scenes, seen from outside and from within, 640x360: what the plan chooses, the times and the error that
// it predicts, and those that are measured. Markdown.
std::string planTable(const gpu::Device& device, const CostModel& model, Truth& truth, const std::vector<std::string>& scenes,
                      const std::vector<std::string>& set);

} // namespace brume::bench
