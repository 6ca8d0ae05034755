// Measures time and error of a resolution of the volumetric shadow map, against a picture with a far finer map.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "tools/bench/sweep.h"

namespace brume::bench {

// One row per case; frames of all cases are timed in turns. A row holds the map's size, the median time of its pass,
// the estimated error (ShadowResolution::error), and the errors of pictures of `size`. These are compared with
// pictures by the same method, but with 512 x 512 texels and 128 planes.
nlohmann::json lightRows(const gpu::Device& device, const std::vector<NamedCase>& cases, glm::uvec2 size,
                         const Effort& effort);

} // namespace brume::bench
