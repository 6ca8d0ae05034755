// Six-way light maps: what light from the right, the top and the front of a puff of smoke, and from the left, the
// bottom and the back, scatters toward the eye in each texel (McTaggart 2004; Mattsson 2022).
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <glm/glm.hpp>

namespace brume::methods::sprites {

// Texels of all frames, frame after frame, row by row from the top left; a frame is `side` texels wide and high.
struct LightMaps {
    uint32_t side = 0, frames = 0;
    // Light from the right, the top and the front; and the texel's optical depth over the mean of the frame's texels.
    std::vector<glm::vec4> positive;
    std::vector<glm::vec4> negative; // light from the left, the bottom and the back; w is not used
};

// Made at the first call. Puffs of seeded Gaussians with single scattering. Light is 1 in the mean over a frame,
// weighted by depth.
const LightMaps& bakedMaps();
// A ball: light is 1 everywhere, and the depth follows its chords.
LightMaps evenMaps();
// NAME-positive.png and NAME-negative.png: frames beside each other, each as wide as high; alpha of the first is the
// opacity. Throws std::runtime_error, one line, where they cannot be used.
LightMaps mapsOf(const std::filesystem::path& name);

} // namespace brume::methods::sprites
