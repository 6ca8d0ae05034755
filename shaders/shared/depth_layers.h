// Layers with depth: what a viewer redraws a picture from when its eye has moved (server/render/depth_layers.h). The
// medium along each ray of a lattice is cut into a few parts, near to far, that hide equally much.
#ifndef BRUME_SHARED_DEPTH_LAYERS_H
#define BRUME_SHARED_DEPTH_LAYERS_H

#ifdef __cplusplus
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
namespace brume::gpu {
using uint = uint32_t;
using glm::uvec2;
using std::clamp;
using std::log;
#define BRUME_INLINE inline
#else
#define BRUME_INLINE
#endif

const uint kMostDepthLayers = 8u;
const uint kLeastLayerSpacing = 4u; // pixels between nodes

// The layers of a view.
struct DepthLayers {
    uint count;      // 0: none are asked for
    uvec2 nodes;     // columns and rows of the lattice
    uint every;      // rays between nodes
    uint first;      // ray of the first node, in rows and columns
    uint rows;       // of a layer in the pictures: nodes.y, up to whole blocks of JPEG
    uint held;       // index of the first number in Layered: of each layer the field's quantities up to its end, and
                     // the integral of view depth over what it hides (m)
    uint blocks;     // of colours: the layers', and without surfaces one more of the sky behind them
    uint colours;    // word of Planes: R, G, B of all blocks, one below the other
    uint data;       // word: bytes of transmittance of all layers, one below the other; then of depth
    uint surface;    // word: a byte of depth for each pixel
    float near, far; // m, view depths that the bytes 0 and 255 of depth stand for
};

// Words of four bytes of a row of a layer's picture; PlaneLayout (server/encode/picture.h) has the same.
BRUME_INLINE uint layerWords(uint columns) { return (columns + 7u) / 8u * 2u; }

// View depths (m) of a surface's bytes 1 and 254. Byte 255: the sky.
const float kNearSurface = 0.2, kFarSurface = 500;
const uint kSkyByte = 255u;

// Byte of a view depth between two, which are the bytes 0 and `most`: equal steps of the logarithm.
BRUME_INLINE float depthByte(float depth, float near, float far, float most) {
    return clamp(most * (log(depth / near) / log(far / near)), 0.0f, most);
}

#ifdef __cplusplus
// m, of a surface's byte below kSkyByte.
inline float surfaceDepth(uint8_t byte) {
    return kNearSurface * std::pow(kFarSurface / kNearSurface, float(std::max<int>(byte, 1) - 1) / 253);
}
} // namespace brume::gpu
#endif
#undef BRUME_INLINE
#endif
