// The first pass of every eye: sky and opaque objects, with the shadows that objects and medium throw on them.
#pragma once

#include <map>
#include <span>
#include <utility>

#include "server/gpu/commands.h"
#include "server/inputs/eye_inputs.h"
#include "server/inputs/eye_request.h"

namespace brume {

class Surfaces {
public:
    // Compiled for the scene's objects: kinds that it has none of cost nothing. CPU drivers draw several times faster
    // into targets than they store to images; on some GPUs compute is far faster than draws.
    Surfaces(const gpu::Device& device, const Scene& scene) : Surfaces(device, scene, device.isCpu()) {}
    Surfaces(const gpu::Device& device, const Scene& scene, bool by_draw);

    // Makes room for pictures of these sizes. Precondition: nothing of it is on the device.
    void prepare(std::span<const EyeRequest> eyes);
    // Writes all of the eye's target, with transmittance 1. Every kind of pass may read and write it afterwards.
    void record(gpu::Commands& commands, const EyeInputs& in);

private:
    struct Programs {
        gpu::GraphicsProgram draw; // either this or the other is made
        gpu::ComputeProgram compute;
    };
    const Programs& programsFor(bool fog, bool local_lights);
    void recordBins(gpu::Commands& commands, const EyeInputs& in);

    const gpu::Device& device_;
    const gpu::SpecConstant planes_, boxes_, spheres_, many_, meshes_;
    const uint32_t binned_; // boxes and spheres, if they are many; else 0
    const bool by_draw_;
    gpu::ComputeProgram bins_program_;
    gpu::Buffer bins_; // uint[bins][words]: which of many the rays of a bin of the last eye's pixels may hit
    std::map<std::pair<bool, bool>, Programs> programs_; // by whether there are fog and local lights
};

} // namespace brume
