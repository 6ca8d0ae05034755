// OwnFrames: hashes of pictures of the scene's own camera, for comparing runs. A picture depends only on the
// simulation's state, the device and its driver: it is 640x360, alone in its submission, and planned with the
// built-in costs and without overload.
#pragma once

#include "server/plan/planner.h"
#include "server/render/renderer.h"

namespace brume {

class OwnFrames {
public:
    // `device` outlives this. Throws gpu::Error.
    OwnFrames(const gpu::Device& device, const Scene& scene, uint32_t capacity);
    // XXH3 of the picture's planes at the simulation's present state. Waits for the device. Precondition: called from
    // the thread that makes all other submissions.
    uint64_t hash(const Simulation& simulation);

private:
    const Scene scene_;
    Renderer renderer_;
    Submission submission_;
};

} // namespace brume
