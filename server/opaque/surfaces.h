// The first pass of every eye: sky and opaque objects, with the shadows that objects and medium throw on them.
#pragma once

#include "server/gpu/commands.h"
#include "server/inputs/eye_inputs.h"

namespace brume {

class Surfaces {
public:
    // Compiled for the scene's objects: kinds that it has none of cost nothing. CPU drivers draw several times faster
    // into targets than they store to images; on some GPUs compute is far faster than draws.
    Surfaces(const gpu::Device& device, const Scene& scene) : Surfaces(device, scene, device.isCpu()) {}
    Surfaces(const gpu::Device& device, const Scene& scene, bool by_draw);

    // Writes all of the eye's target, with transmittance 1. Every kind of pass may read and write it afterwards.
    void record(gpu::Commands& commands, const EyeInputs& in) const;

private:
    gpu::GraphicsProgram draw_; // either this or the other is made
    gpu::ComputeProgram compute_;
};

} // namespace brume
