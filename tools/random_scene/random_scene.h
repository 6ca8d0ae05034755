// RandomScene: a scene, its points and a view, all from one seed. It measures and tests what nobody tuned for.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "common/ply.h"
#include "common/scene.h"

namespace brume {

struct RandomScene {
    uint64_t seed = 0;
    std::string layout; // of randomLayouts()
    std::string camera; // of randomCameras()
    float spread = 1;   // largest over smallest scale that was drawn from, 1 to 30
    float depth = 1;    // mean optical depth of lines through the points, 0.01 to 100; less where kSigmaT ends it
    glm::uvec2 size{0}; // of the picture, pixels: 160x90 to 1920x1080
    PointCloud points;  // 1 to 20,000, log-uniform
    Scene scene;        // of layout file; a third of them have objects
};

// A pure function of the seed: equal on all machines, as it takes only operations that IEEE 754 defines exactly.
RandomScene randomScene(uint64_t seed);

// Writes random-SEED.toml and random-SEED.ply, which brume-server and brume-bench open. Makes the folder if it is
// missing. Returns the path of the former. Throws std::runtime_error if they cannot be written.
std::filesystem::path save(const RandomScene& random, const std::filesystem::path& folder);

} // namespace brume
