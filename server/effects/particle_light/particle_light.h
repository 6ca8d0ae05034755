// Light cached on the particles, once per tick for all viewers: seven look-ups in the volumetric shadow map per
// particle. (Exact closed-form sums over pairs of particles cost N^2: for 500 particles as much as 16 planes of the
// map.)
#pragma once

#include "server/gpu/commands.h"
#include "server/gpu/program.h"
#include "shaders/shared/splat.h"
#include "shaders/shared/types.h"

namespace brume {

class ParticleLight {
public:
    // For at most `capacity` particles. `ellipsoids`: SceneFeatures::ellipsoids.
    ParticleLight(const gpu::Device& device, uint32_t capacity, bool ellipsoids = false);

    // Records the light of `count` particles. A particle whose fit errs by more than `tolerance` (of the light's
    // transmittance, 0 ... 1) gets gpu::kLookUp. Precondition: the shadow volume is recorded. Its writes are then
    // visible to compute.
    void record(gpu::Commands& commands, const gpu::Resources& medium, uint32_t count, float tolerance);
    // gpu::ParticleLight[count].
    const gpu::Buffer& buffer() const { return lights_; }

private:
    gpu::ComputeProgram program_;
    gpu::Buffer lights_;
};

} // namespace brume
