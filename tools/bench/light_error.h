// What the resolution of the volumetric shadow map costs in time and error: one picture with it, and one with a far finer map.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "tools/bench/sweep.h"

namespace brume::bench {

struct LightCase {
    std::string name;
    Case wanted;
};

// One row per case, their frames in turns: the map's size, the median time of its pass, the error that its maker estimates, and
// the errors of pictures of `size` against those with 512 x 512 texels and 128 planes, by the same method.
nlohmann::json lightRows(const gpu::Device& device, const std::vector<LightCase>& cases, glm::uvec2 size, const Effort& effort);

} // namespace brume::bench
