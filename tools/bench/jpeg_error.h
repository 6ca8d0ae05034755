// The last stage's error: what JPEG of a quality costs in bytes and changes in what a viewer sees.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tools/bench/stage.h"

namespace brume::bench {

// One row per quality (1...100, as text). FLIP and PSNR of the decoded picture against the displayed one before the planes.
nlohmann::json jpegRows(const gpu::Device& device, const Case& wanted, glm::uvec2 size,
                        const std::vector<std::string>& qualities);

} // namespace brume::bench
