// Displayed colours on a coarse grid of pixels (nodes), for pictures without sharp edges. A node has Y as a float,
// then Cb and Cr in one word. The first node is one step up and left of the view's first pixel. Include after
// lib/view.glsl and lib/planes.glsl. A shader that writes nodes defines BRUME_WRITES_SHADED before.
#include "shaders/shared/constants.h"

layout(constant_id = kIdStep) const uint kStep = 4;

uvec2 shadedNodes(uint rows) { return (uvec2(eye.size.x, rows) + kStep - 1) / kStep + 3; } // `rows`: rows of pixels

#ifdef BRUME_WRITES_SHADED
// `shown`: sRGB, 0 ... 255. `from`: index of the view's first node.
void writeShaded(uint from, uvec2 node, uvec2 nodes, vec3 shown) {
    const uint at = from + node.y * nodes.x + node.x;
    const float cb = dot(shown, kCb) + 128, cr = dot(shown, kCr) + 128; // 0 ... 256, in 256 parts
    shaded[at] = floatBitsToUint(dot(shown, kLuma));
    shaded[at + nodes.x * nodes.y] = nearestWhole(min(256 * cb, 65535)) | nearestWhole(min(256 * cr, 65535)) << 16;
}
#endif
