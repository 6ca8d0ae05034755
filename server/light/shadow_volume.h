// Volumetric shadow map (seed 000 section 3.4): the optical depth between the light and every texel of slice planes in light
// space, each plane exact (the seed deposits a particle's whole depth in one slice, a bias of -8.6 %).
#pragma once

#include "server/gpu/commands.h"
#include "server/gpu/program.h"
#include "shaders/shared/types.h"

namespace brume {

class ShadowVolume {
public:
    ShadowVolume(const gpu::Device& device, uint32_t capacity);

    // Records the volume of tick.particle_count particles. Makes a new image when size or slices changed: the device must be idle
    // with the old one. Ends with its writes visible to compute and draws.
    void record(gpu::Commands& commands, const gpu::Resource& tick_block, const gpu::Tick& tick, const gpu::Buffer& particles);

    // RGBA32F array; a layer holds four neighbouring planes and shares its last with the next layer's first.
    const gpu::Image& image() const { return image_; }

private:
    static constexpr uint32_t kPlanes = 16, kTile = 16, kNewPlanesPerLayer = 3; // as in the shaders
    const gpu::Device& device_;
    gpu::ComputeProgram particles_, volume_;
    gpu::Buffer light_particles_, columns_;
    gpu::Image image_;
};

} // namespace brume
