// Interleaves a picture's planes of R, G and B.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "server/encode/picture.h"

namespace brume {

// Writes R, G, B of every pixel to the beginning of `out`, rows tightly packed, top row first. `out` grows if it is
// too small. Precondition: picture.layout.full.
inline void packRgb(const PictureView& picture, std::vector<uint8_t>& out) {
    const PlaneLayout& layout = picture.layout;
    out.resize(std::max(out.size(), size_t(3) * layout.width * layout.height));
    uint8_t* to = out.data();
    for (uint32_t y = 0; y < layout.height; ++y) {
        const uint8_t* row = picture.bytes + size_t(y) * layout.lumaStride();
        for (uint32_t x = 0; x < layout.width; ++x)
            for (size_t c = 0; c < 3; ++c) *to++ = row[c * layout.lumaBytes() + x];
    }
}

} // namespace brume
