// The size that a viewer gets for the size that it wishes for.
#pragma once

#include <algorithm>
#include <cmath>

#include "server/net/options.h"

namespace brume::net {

struct PictureSize {
    uint16_t width, height;
    friend bool operator==(PictureSize, PictureSize) = default;
};

// Within kMinSide ... max_side and max_pixels, as near to the wished aspect as that allows.
inline PictureSize fitSize(PictureSize wish, const NetOptions& options) {
    const double width = std::max(wish.width, kMinSide), height = std::max(wish.height, kMinSide);
    const double scale =
        std::min({1.0, options.max_side / std::max(width, height), std::sqrt(options.max_pixels / (width * height))});
    const auto side = [&](double wished) { return std::max(uint16_t(wished * scale), kMinSide); };
    return {side(width), side(height)};
}

} // namespace brume::net
