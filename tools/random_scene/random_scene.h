// RandomScene: a scene, its points and a view, all from one seed. It measures and tests what nobody tuned for.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "common/ply/ply.h"
#include "common/scene.h"

namespace brume {

// What scenes have: a medium and the sun, and a third of them objects. `lit` ones are smaller, and have 0 to 2 fogs, 0
// to 6 points and spots, and 1 to 6 boxes and spheres besides in half of them.
enum class RandomKind { sun, lit };

struct RandomScene {
    uint64_t seed = 0;
    RandomKind kind = RandomKind::sun;
    std::string layout; // of randomLayouts()
    std::string camera; // of randomCameras()
    float spread = 1;   // largest over smallest scale that was drawn from, 1 to 30
    float depth = 1;    // mean optical depth of lines through the points, 0.01 to 100; less where kSigmaT ends it
    glm::uvec2 size{0}; // of the picture, pixels: 160x90 to 1920x1080; `lit`: to 480x270
    PointCloud points;  // 1 to 20,000, log-uniform; `lit`: to 2,000
    Scene scene;        // of layout file; a third of them have objects
};

// A pure function of seed and kind: equal on all machines, as it takes only operations that IEEE 754 defines exactly.
RandomScene randomScene(uint64_t seed, RandomKind kind = RandomKind::sun);

// Writes random-SEED.toml and random-SEED.ply, or random-lit-SEED.*, which brume-server and brume-bench open. Makes the
// folder if it is missing. Returns the path of the former. Throws std::runtime_error if they cannot be written.
std::filesystem::path save(const RandomScene& random, const std::filesystem::path& folder);

} // namespace brume
