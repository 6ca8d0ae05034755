// OwnFrames: pictures of the scene's own camera, and hashes of them for comparing runs. A picture depends only on the
// simulation's state, the device and its driver: it is alone in its submission, and planned with the
// built-in costs and without overload.
#pragma once

#include "server/plan/planner.h"
#include "server/render/renderer.h"

namespace brume {

class OwnFrames {
public:
    // `device` outlives this. Throws gpu::Error.
    OwnFrames(const gpu::Device& device, const Scene& scene, uint32_t capacity);
    // XXH3 of the planes of a picture of 640x360 at the simulation's present state. Waits for the device. Precondition:
    // called from the thread that makes all other submissions.
    uint64_t hash(const Simulation& simulation);
    // A picture at rest at the simulation's present state, with planes R, G, B: of less error, and as many pixels as
    // asked for. Valid until the next call. Same precondition.
    PictureView picture(const Simulation& simulation, uint32_t width, uint32_t height);

private:
    PictureView draw(const Simulation& simulation, const PlanView& view, bool rests);

    const Scene scene_;
    Renderer renderer_;
    Submission submission_;
};

} // namespace brume
