// The first pass of every eye: sky and opaque objects, with the shadows that objects and medium throw on them.
#pragma once

#include <map>
#include <utility>

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
    void record(gpu::Commands& commands, const EyeInputs& in);

private:
    struct Programs {
        gpu::GraphicsProgram draw; // either this or the other is made
        gpu::ComputeProgram compute;
    };
    const Programs& programsFor(bool fog, bool local_lights);

    const gpu::Device& device_;
    const gpu::SpecConstant planes_, boxes_, spheres_;
    const bool by_draw_;
    std::map<std::pair<bool, bool>, Programs> programs_; // by whether there are fog and local lights
};

} // namespace brume
