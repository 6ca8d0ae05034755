// What viewers see who redraw pictures from layers with depth, beside the true pictures.
#pragma once

#include <string>
#include <vector>

#include "tools/bench/stage.h"

namespace brume::bench {

struct LayersQuestion {
    std::vector<std::string> scenes; // each a scene, or scene:camera
    glm::uvec2 size{640, 360};       // that is shown; what is drawn is wider by `margin`
    float margin = 0.12f;
    int quality = 90;       // of JPEG
    uint32_t ticks = 60;    // simulated first
    bool over_time = false; // True: also of a medium and a camera that go on, at several rates of pictures
    std::string pictures;   // folder for pictures side by side; empty: none
};

// Tables of errors, bytes and times, as Markdown.
std::string layersTables(const gpu::Device& device, const CostModel& costs, const LayersQuestion& question);

} // namespace brume::bench
