// Writes OpenEXR without its library: scan lines of half floats R, G, B, A, compressed line by line (ZIPS).
// Layout: https://openexr.com/en/latest/OpenEXRFileLayout.html
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

namespace brume {

// Row by row from the top left. Numbers beyond the range of half floats become its ends. Throws std::runtime_error.
std::vector<uint8_t> encodeExr(std::span<const glm::vec4> pixels, uint32_t width, uint32_t height);

} // namespace brume
