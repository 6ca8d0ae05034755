// Light cached on the particles: once per tick, shared by all viewers. The look-ups are in the volumetric shadow map, seven per
// particle. (Exact sums over pairs of particles in closed form cost N^2 of them: for 500 particles as much as 16 planes of the
// map.)
#pragma once

#include "server/gpu/commands.h"
#include "server/gpu/program.h"
#include "shaders/shared/splat.h"
#include "shaders/shared/types.h"

namespace brume {

class ParticleLight {
public:
    ParticleLight(const gpu::Device& device, uint32_t capacity);

    struct Inputs {
        gpu::Resource tick; // binding 0
        const gpu::Buffer *objects, *particles;
        const gpu::Image* shadow_volume;
        const gpu::Sampler* linear;
    };
    // Records the light of `count` particles, unless it is that of the last time. Those whose fit errs by more than `tolerance`
    // (of T_L, 0 ... 1) get gpu::kLookUp. The shadow volume has been recorded before. Ends with its writes visible to compute.
    void record(gpu::Commands& commands, const Inputs& inputs, uint32_t count, float tolerance);
    // Light or particles have changed.
    void invalidate() { tolerance_ = -1; }

    // gpu::ParticleLight[count].
    const gpu::Buffer& buffer() const { return lights_; }

private:
    gpu::ComputeProgram program_;
    gpu::Buffer lights_;
    float tolerance_ = -1; // of what the buffer holds; < 0: nothing yet
};

} // namespace brume
