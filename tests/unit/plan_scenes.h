// Scenes and inputs of plans, for the tests of planning.
#pragma once

#include "server/methods/plans.h"
#include "server/plan/planner.h"

namespace brume {

inline Scene cube(uint32_t count = 500, float scale = 6) {
    Scene scene;
    scene.medium.count = count;
    scene.medium.scale = {scale, scale};
    scene.medium.extinction = 52;
    scene.lights.emplace_back();
    scene.render.method = kAutoMethod;
    return scene;
}

inline PlanInputs inputsOf(const Scene& scene) {
    PlanInputs inputs;
    inputs.scene = planScene(scene, Simulation(scene));
    inputs.views = {ownView(scene)};
    inputs.methods = allMethods();
    return inputs;
}

} // namespace brume
