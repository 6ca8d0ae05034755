// What a display shows while camera and medium go on, of pictures that come at several rates.
#pragma once

#include "tools/bench/layers.h"

namespace brume::bench {

// A table of errors, as Markdown: pictures that stay, move as a plane, or by layers.
std::string overTime(const gpu::Device& device, const CostModel& costs, const LayersQuestion& question,
                     const Case& one);

// A table of second differences in time of what a display shows at 60 Hz of five pictures a second, in steps of 255:
// RMS, mean over pictures and the largest. What pops is more than in true pictures.
std::string arrivals(const gpu::Device& device, const CostModel& costs, const LayersQuestion& question,
                     const Case& one);

} // namespace brume::bench
