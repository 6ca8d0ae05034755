// The particles as some eyes see them: all of them, or a level of detail of fewer that look the same from afar.
#pragma once

#include "server/gpu/named_resources.h"
#include "server/medium/extent.h"

namespace brume {

class VolumeBuffers; // server/inputs/volume_buffers.h

struct MediumView {
    // TickBlock, a gpu::Tick with this list's particle_count; Particles, gpu::Particle[count]; ParticleLights,
    // gpu::ParticleLight[count], for methods that need it. And TickInputs::resources.
    gpu::Resources resources;
    uint32_t count = 0;
    uint64_t version = 0;                  // changes whenever a particle or the block changes: a key for caches
    const MediumExtent* extent = nullptr;  // of this list
    const VolumeBuffers* volume = nullptr; // that the list stands for; null: the medium is its particles

    bool empty() const { return count == 0; }
};

} // namespace brume
