// Measures JPEG, the last stage: bytes and visible error of each quality.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tools/bench/stage.h"

namespace brume::bench {

// One row per quality (1 ... 100, as text): bytes, and FLIP and PSNR between the decoded picture and the displayed
// one before it was split into planes.
nlohmann::json jpegRows(const gpu::Device& device, const std::string& variant, const Case& wanted, glm::uvec2 size,
                        const std::vector<std::string>& qualities);

} // namespace brume::bench
