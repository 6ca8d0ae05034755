// The buffer of bits that shaders/lib/line_bins_write.glsl writes.
#pragma once

#include "server/gpu/commands.h"

namespace brume {

// Bytes for `particles` and so many lines of tiles: a bit each, and their pages (shaders/lib/line_pages.glsl).
inline VkDeviceSize lineBinBytes(uint32_t lines, uint32_t particles) {
    const uint32_t words = gpu::groups(particles, 32);
    return VkDeviceSize(lines) * (words + gpu::groups(words, 32 * 64)) * sizeof(uint32_t);
}

} // namespace brume
