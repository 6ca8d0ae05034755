// What a display shows while camera and medium go on, of pictures that come at several rates.
#pragma once

#include "tools/bench/layers.h"

namespace brume::bench {

// A table of errors, as Markdown: pictures that stay, move as a plane, or by layers.
std::string overTime(const gpu::Device& device, const CostModel& costs, const LayersQuestion& question,
                     const Case& one);

// A camera that goes on.
struct Path {
    const char* name;
    float sideways = 0, around = 0; // m/s; degrees/s about the target
};

// Second differences in time of what a display shows at 60 Hz of five pictures a second, in steps of 255: RMS of the
// medium's pixels, for each picture of the display. The medium stands, so that nothing moves but the camera.
struct Jumps {
    std::vector<double> truth, stays;    // of true pictures; of those that stay until the next one comes
    std::vector<double> layers, blended; // of redrawn ones, and where new ones are blended in
};
// `film`: path of pictures to write, without their number; empty: none.
Jumps arrivalJumps(Stage& stage, const LayersQuestion& question, const Path& path, const std::string& film = {});

// A table of these, as Markdown: their mean and the largest. What pops is more than in true pictures.
std::string arrivals(const gpu::Device& device, const CostModel& costs, const LayersQuestion& question,
                     const Case& one);

} // namespace brume::bench
