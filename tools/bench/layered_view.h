// A view with layers with depth as viewers get it, and what they redraw of it.
#pragma once

#include "common/redraw.h"
#include "tools/bench/layers.h"

namespace brume::bench {

inline constexpr uint32_t kLayersOfPage = 4;

// What is drawn for a view that is shown, with a margin.
Pose wider(const Pose& shown, const LayersQuestion& question);
glm::uvec2 widerSize(const LayersQuestion& question);

// Coded and decoded again. With quality 100 the picture itself is as it was drawn.
struct LayeredView {
    LayeredPicture picture;
    size_t flat_bytes = 0, layer_bytes = 0, surface_bytes = 0;
    double flat_ms = 0, layers_ms = 0;                // of encoding
    double device_ms = 1e30, device_layers_ms = 1e30; // the least of some frames without and with layers
};
LayeredView layeredView(Stage& stage, const Pose& pose, glm::uvec2 size, uint32_t count, int quality, int frames = 1);

// All of it a plane across the view, `depth` m away; or infinitely far.
LayeredPicture asPlane(LayeredPicture p, float depth);
LayeredPicture distant(LayeredPicture p);

RadianceImage redrawn(const LayeredPicture& p, const Pose& eye, glm::uvec2 size);

} // namespace brume::bench
