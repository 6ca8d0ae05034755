// What another phase function does to a picture.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tools/bench/stage.h"

namespace brume::bench {

// The medium's picture by Schlick's phase function (shaders/shared/phase.h) against that by Henyey and Greenstein's, of
// the same asymmetry. The sun's light comes from one direction, so a pixel has one angle: its radiance is multiplied by
// the ratio of the two. Precondition: one sun, phase `mixture` with anisotropy 1, no sky and no ambient light.
nlohmann::json phaseRows(const gpu::Device& device, const std::vector<NamedCase>& cases, glm::uvec2 size);

} // namespace brume::bench
