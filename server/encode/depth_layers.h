// The layers with depth of one eye's picture (shaders/shared/depth_layers.h), as bytes that encoders take.
#pragma once

#include "server/encode/picture.h"
#include "shaders/shared/depth_layers.h"

namespace brume {

// Bytes that layers of a picture take before they are encoded, at most: of the lattice's, and of all. Multiples of 8.
constexpr uint64_t latticeBytes(uint32_t width, uint32_t height, uint32_t count) {
    constexpr uint32_t kBeyond = 8; // nodes outside of the picture, in rows and columns
    constexpr uint32_t kBlock = 8;  // rows of a block of JPEG
    const uint64_t columns = width / gpu::kLeastLayerSpacing + 1 + kBeyond;
    const uint64_t rows = height / gpu::kLeastLayerSpacing + 1 + kBeyond;
    const uint64_t plane = (columns + 7) / 8 * 8 * ((rows + kBlock - 1) / kBlock * kBlock);
    return count == 0 ? 0 : (5 * uint64_t{count} + 3) * plane;
}
constexpr uint64_t depthLayerBytes(uint32_t width, uint32_t height, uint32_t count) {
    return count == 0 ? 0 : latticeBytes(width, height, count) + PlaneLayout{width, height}.lumaBytes();
}

struct DepthLayersView {
    uint32_t count = 0;             // of layers, near to far
    uint32_t columns = 0, rows = 0; // nodes of a layer
    uint32_t block_rows = 0;        // of a layer in the pictures: nodes, and then copies of their last row
    uint32_t spacing = 0;           // pixels between nodes
    float first = 0;                // pixels from the picture's upper left corner to the first node, each way
    float near = 0, far = 0;        // m, view depths of bytes 0 and 255; logarithmic between them
    float exposure = 1;             // of the colours, as of the picture
    bool filmic = false;
    // R, G, B of all layers, one below the other. Without surfaces there is one block more: the sky behind them.
    PictureView colours;
    const uint8_t* data = nullptr; // two planes of count * block_rows such rows: transmittance, then depth
    // A byte of view depth for each pixel, in rows of PlaneLayout::lumaStride(): 255 the sky, else logarithmic from
    // kNearSurface (1) to kFarSurface (254). Null: nothing but sky.
    const uint8_t* surface = nullptr;
};

} // namespace brume
