// Encodes a picture's layers with depth: colours as JPEG without subsampling, transmittance and depths as grey JPEG,
// depths of surfaces as grey PNG.
#pragma once

#include <vector>

#include "server/encode/depth_layers.h"
#include "server/encode/jpeg.h"

namespace brume {

struct EncodedLayers {
    std::vector<uint8_t> colours; // JPEG; DepthLayersView::colours
    std::vector<uint8_t> data;    // JPEG: transmittance of all layers, and below it their depths
    std::vector<uint8_t> surface; // PNG of the picture's size
    float nearest = 0;            // m, least depth of a surface; 0: nothing but sky
};

// Parts that `layers` lacks are empty. `quality`: of JPEG, 1 ... 100. Throws std::runtime_error or std::bad_alloc.
EncodedLayers encodeLayers(const DepthLayersView& layers, const PlaneLayout& picture, int quality, JpegEncoder& jpeg);

} // namespace brume
