// Planes of R, G, B to PNG with libpng: every bit of what the display shows.
#pragma once

#include <cstdint>
#include <vector>

#include "server/render/picture.h"

namespace brume {

// Empty when that takes more than `most` bytes. Throws std::runtime_error when libpng refuses (a picture without pixels).
// Precondition: picture.layout.full.
std::vector<uint8_t> encodePng(const PictureView& picture, size_t most);

} // namespace brume
