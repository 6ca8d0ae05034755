// ShownScene: the scene that a server shows, and its state.
#pragma once

#include <memory>

#include "server/inputs/hues.h"
#include "server/inputs/scene_features.h"
#include "server/sim/simulation.h"

namespace brume {

struct ShownScene {
    std::shared_ptr<const Scene> scene; // never null
    Simulation simulation;
    SceneFeatures drawn;  // of the scene's lists, in pictures
    uint64_t version = 0; // grows whenever pictures would change

    // That its pictures are drawn with.
    SceneFeatures features() const { return featuresOf(*scene, simulation.now(), drawn); }
    bool hasSeveralHues() const { return huesOf(simulation.now(), simulation.liveCount()).size() > 1; }
};

} // namespace brume
