// Small scenes and helpers for the tests of the simulation.
#pragma once

#include <utility>
#include <vector>

#include "server/sim/simulation.h"

namespace brume {

inline Scene cubeScene(uint32_t count = 1000, uint64_t seed = 1) {
    Scene scene;
    scene.lights.push_back({.to_light = {0.6f, 0.8f, 0}});
    scene.render.method = "sphere";
    scene.medium.count = count;
    scene.medium.seed = seed;
    return scene;
}

inline Scene plumeScene(uint64_t seed = 1) {
    Scene scene = cubeScene(1000, seed);
    scene.medium.layout = Layout::emitter;
    scene.medium.scale = {0.5f, 1};
    scene.medium.emitter.rate = 300;
    scene.medium.emitter.life = 3;
    return scene;
}

inline Command command(CommandBody body) { return {.viewer = 1, .seq = 1, .body = std::move(body)}; }

inline void give(Simulation& simulation, std::vector<Command> commands) { simulation.step(commands); }

inline std::vector<gpu::Particle> particlesOf(const Simulation& simulation) {
    std::vector<gpu::Particle> out(simulation.liveCount());
    simulation.write(out);
    return out;
}

} // namespace brume
