// Pixels of PNG and JPEG files in memory.
#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "common/gltf/bytes.h"

namespace brume::gltf {

struct Pixels {
    int width = 0, height = 0;
    std::vector<glm::u8vec4> texels; // row by row from the top left; sRGB, alpha linear
};

// Throws Wrong if it is neither, is broken, or has more than `most` pixels a side or `left` in all.
Pixels pixelsOf(const Bytes& file, int most, size_t left);

} // namespace brume::gltf
