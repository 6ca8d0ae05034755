// Volumetric shadow map (seed 000 section 3.4): the optical depth between the light and every texel of slice planes
// in light space. A particle adds to every plane the part of its optical depth before that plane. Particles are drawn a
// little narrower, since linear interpolation widens them again (shaders/shared/sharpen.h). With `fronts` it is as
// printed in the seed: a particle is as wide as it is, and all of it counts from the first plane behind its front on,
// the point of its ball (Particle::scale) that is nearest to the light.
#pragma once

#include "server/gpu/commands.h"
#include "server/gpu/variants.h"
#include "server/inputs/tetrahedra_buffers.h"
#include "server/inputs/volume_buffers.h"
#include "shaders/shared/types.h"

namespace brume {

class ShadowVolume {
public:
    // For at most `capacity` particles. `ellipsoids`: SceneFeatures::ellipsoids; not with `fronts`.
    ShadowVolume(const gpu::Device& device, uint32_t capacity, bool ellipsoids = false, bool fronts = false);

    // Records the volume of the tick's particles, or of the tetrahedra or the volume that these stand for, unless the
    // image holds it already. `shared`: TickBlock, Particles and Axes. `same_particles`: true if the particles are
    // those of the last call; light and resolution are compared here. Returns true if something was recorded. Its
    // writes are then visible to compute and draws. Makes a new image if the size changed; precondition: the device
    // does not use the old one.
    bool record(gpu::Commands& commands, const gpu::Resources& shared, const gpu::Tick& tick,
                bool same_particles = false, const TetrahedraBuffers* tetrahedra = nullptr,
                const VolumeBuffers* volume = nullptr);

    // RGBA32F array. A layer holds four neighbouring planes; its last plane is also the first plane of the next layer.
    const gpu::Image& image() const { return image_; }

private:
    void makeImage(VkCommandBuffer cmd, const gpu::Tick& tick);
    void recordParticles(gpu::Commands& commands, const gpu::Resources& shared, const gpu::Tick& tick);
    void recordTetrahedra(gpu::Commands& commands, const gpu::Resources& shared, const gpu::Tick& tick,
                          const TetrahedraBuffers& tetrahedra);
    void recordVolume(gpu::Commands& commands, const gpu::Resources& shared, const gpu::Tick& tick,
                      const VolumeBuffers& volume);
    // Fills the image in bands of rows, each a whole number of kRows rows: record(first, rows) fills a band in texels_.
    template <class Record>
    void inBands(VkCommandBuffer cmd, const gpu::Tick& tick, const Record& record);

    static constexpr uint32_t kRows = 8, kGroup = 6, kNewPlanesPerLayer = 3; // the same numbers as in the shaders
    const gpu::Device& device_;
    gpu::ComputeProgram particles_, volume_;
    gpu::Variants tetrahedra_, of_volume_;
    gpu::Buffer light_particles_, light_skews_, bins_, texels_;
    gpu::Image image_;
    gpu::Tick last_{};
};

} // namespace brume
