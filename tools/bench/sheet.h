// Sheet: the pictures of a sweep's series as one, to be looked at beside each other.
#pragma once

#include <filesystem>

#include "tools/bench/sweep.h"

namespace brume::bench {

// Draws each variant in each place, with sky and ambient light: a row for each scene and camera, a column for each
// variant. `size`: of each picture. Throws std::runtime_error if it cannot be written.
void writeSheet(const gpu::Device& device, const Series& series, glm::uvec2 size, const std::filesystem::path& file);

} // namespace brume::bench
