#include "server/encode/layers_encoder.h"

#include <algorithm>

#include "server/encode/png.h"

namespace brume {
namespace {

constexpr int kDataQuality = 90; // of JPEG

} // namespace

EncodedLayers encodeLayers(const DepthLayersView& layers, const PlaneLayout& picture, int quality, JpegEncoder& jpeg) {
    EncodedLayers out;
    if (layers.count > 0) {
        const PlaneLayout& layout = layers.colours.layout;
        out.colours = jpeg.encode(layers.colours, quality);
        out.data = jpeg.encodeGrey(layers.data, layout.width, 2 * layers.count * layers.block_rows, layout.lumaStride(),
                                   kDataQuality);
    }
    if (!layers.surface) return out;
    out.surface = encodeGreyPng(layers.surface, picture.width, picture.height, picture.lumaStride());
    const uint8_t least = *std::min_element(layers.surface, layers.surface + picture.lumaBytes());
    if (least < gpu::kSkyByte) out.nearest = gpu::surfaceDepth(least);
    return out;
}

} // namespace brume
