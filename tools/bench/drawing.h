// What viewers see who draw by themselves, beside the reference.
#pragma once

#include <string>
#include <vector>

#include "tools/bench/stage.h"

namespace brume::bench {

struct DrawingQuestion {
    std::vector<std::string> scenes; // each a scene, or scene:camera
    glm::uvec2 size{640, 360};       // of the picture whose pixels are looked at
    uint32_t pixels = 500;           // that are traced, of each view, or somewhat more
    uint32_t ticks = 60;             // simulated first
    bool links = false;              // True: also over narrow links (drawing_links.h), of the first scene
};

// A table of errors and bytes, as Markdown.
std::string drawingTable(const gpu::Device& device, const CostModel& costs, const DrawingQuestion& question);

} // namespace brume::bench
