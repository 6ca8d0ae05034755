// What viewers see over narrow links: pictures, and what they draw by themselves.
#pragma once

#include <string>

#include "tools/bench/drawing.h"

namespace brume::bench {

// A table for one scene, as Markdown: FLIP and error over time of a camera that goes around, beside the true pictures.
std::string linksTable(const gpu::Device& device, const CostModel& costs, const DrawingQuestion& question,
                       const std::string& scene);

} // namespace brume::bench
