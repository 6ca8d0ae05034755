// Seams where proxies end, which eyes find although mean errors are small.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tools/bench/stage.h"

namespace brume::bench {

// Each case's picture against the same drawn by `sphere`: whole Gaussians, which end nowhere. A kink is the second
// difference of the luminance to a pixel's neighbours, across or down, less that of the other picture, over the mean of
// 3x3 pixels. Only pixels that show the medium count.
// `ticks`: of simulation first.
nlohmann::json seamRows(const gpu::Device& device, const std::vector<NamedCase>& cases, glm::uvec2 size,
                        uint32_t ticks);

} // namespace brume::bench
