// The particles as some eyes see them: all of them, or a level of detail of fewer that look the same from afar.
#pragma once

#include "server/gpu/program.h"
#include "server/medium/extent.h"

namespace brume {

struct MediumView {
    gpu::Resource tick;                     // gpu::Tick with this list's particle_count: uniform block, binding 0
    const gpu::Buffer* particles = nullptr; // gpu::Particle[count]
    uint32_t count = 0;
    uint64_t version = 0;                 // changes whenever a particle or `tick` changes: a key for caches
    const gpu::Buffer* light = nullptr;   // gpu::ParticleLight[count] for methods that need it; else null
    const MediumExtent* extent = nullptr; // of this list

    bool empty() const { return count == 0; }
};

} // namespace brume
