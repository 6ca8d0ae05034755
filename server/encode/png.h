// Encodes planes as PNG with libpng: 8 bits a channel, without loss.
#pragma once

#include <cstdint>
#include <vector>

#include "server/encode/picture.h"

namespace brume {

// Returns the PNG; empty if it would be larger than `most` bytes. Throws std::runtime_error if libpng refuses (a
// picture without pixels). Precondition: picture.layout.full.
std::vector<uint8_t> encodePng(const PictureView& picture, size_t most);

// Of four bytes a pixel, red, green, blue and alpha, without gaps. Throws std::runtime_error as above.
std::vector<uint8_t> encodeRgbaPng(const uint8_t* pixels, uint32_t width, uint32_t height);

// Of one plane, in rows `stride` bytes apart. Throws std::runtime_error as above.
std::vector<uint8_t> encodeGreyPng(const uint8_t* plane, uint32_t width, uint32_t height, uint32_t stride);

} // namespace brume
