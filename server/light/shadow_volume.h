// Volumetric shadow map (seed 000 section 3.4): the optical depth between the light and every texel of slice planes in light
// space. Every particle counts at every plane with its own depth there (the seed deposits all of it in one slice, a bias of -8.6
// %), a little narrower than it is, because linear interpolation widens it again (shaders/shared/sharpen.h).
#pragma once

#include "server/gpu/commands.h"
#include "server/gpu/program.h"
#include "shaders/shared/types.h"

namespace brume {

class ShadowVolume {
public:
    // How a device works on the map: lanes that exchange values, a power of two up to 8, and tiles of them in a workgroup.
    struct Shape {
        uint32_t lanes, tiles;
    };
    static Shape shapeFor(const gpu::Device& device);

    ShadowVolume(const gpu::Device& device, uint32_t capacity) : ShadowVolume(device, capacity, shapeFor(device)) {}
    ShadowVolume(const gpu::Device& device, uint32_t capacity, Shape shape);

    // Records the volume of tick.particle_count particles, unless it is that of the last time: `same_particles` says that they
    // are, the rest is seen from the tick. Makes a new image when the size changed: the device must be idle with the old one.
    // Ends with its writes visible to compute and draws. True when something was recorded.
    bool record(gpu::Commands& commands, const gpu::Resource& tick_block, const gpu::Tick& tick, const gpu::Buffer& particles,
                bool same_particles = false);

    // RGBA32F array; a layer holds four neighbouring planes and shares its last with the next layer's first.
    const gpu::Image& image() const { return image_; }

private:
    void fit(VkCommandBuffer cmd, const gpu::Tick& tick);

    static constexpr uint32_t kRows = 8, kGroup = 6, kNewPlanesPerLayer = 3; // as in the shaders
    const gpu::Device& device_;
    const Shape shape_;
    gpu::ComputeProgram particles_, volume_;
    gpu::Buffer light_particles_, bits_, texels_;
    gpu::Image image_;
    gpu::Tick last_{};
};

} // namespace brume
