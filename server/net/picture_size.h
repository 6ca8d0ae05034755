// The size of picture that a viewer gets for the size that it asks for.
#pragma once

#include <algorithm>
#include <cmath>

#include "server/net/options.h"

namespace brume::net {

struct PictureSize {
    uint16_t width, height;
    friend bool operator==(PictureSize, PictureSize) = default;
};

// Within kMinSide ... max_side and max_pixels, with the asked aspect as far as these allow.
inline PictureSize fitSize(PictureSize asked, const NetOptions& options) {
    const double width = std::max(asked.width, kMinSide), height = std::max(asked.height, kMinSide);
    const double scale =
        std::min({1.0, options.max_side / std::max(width, height), std::sqrt(options.max_pixels / (width * height))});
    const auto side = [&](double length) { return std::max(uint16_t(length * scale), kMinSide); };
    return {side(width), side(height)};
}

} // namespace brume::net
