// Pictures of the scene's own camera, for comparing runs: 640x360, alone in their submission, planned with the built-in costs and
// without overload, so that they depend on the state, the device and its driver only.
#pragma once

#include "server/plan/planner.h"
#include "server/render/renderer.h"

namespace brume {

class OwnFrames {
public:
    // `device` outlives this. Throws gpu::Error.
    OwnFrames(const gpu::Device& device, const Scene& scene, uint32_t capacity);
    // XXH3 of the picture's planes at the simulation's present state. Waits for the device. Precondition: from the thread that
    // submits all else to it.
    uint64_t hash(const Simulation& simulation);

private:
    const Scene scene_;
    Renderer renderer_;
    Submission submission_;
};

} // namespace brume
