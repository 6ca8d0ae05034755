#include "server/effects/shadow_volume/shadow_volume.h"

#include <algorithm>

#include "server/inputs/line_bins.h"
#include "shaders/shadow_particles_comp.h"
#include "shaders/shadow_volume_comp.h"
#include "shaders/tetrahedra_shadow_comp.h"
#include "shaders/volume_shadow_comp.h"

namespace brume {

using gpu::storageBuffer;

namespace {

struct Band { // as in the shader
    glm::uvec3 tiles;
    uint32_t first_row, rows;
};
// Of texels that wait for their way into the image. Devices need not let a shader see more than 128 MiB of a buffer.
constexpr VkDeviceSize kMostStaged = 64 << 20;

// Whether two ticks of the same particles have the same volume.
bool sameVolume(const gpu::Tick& a, const gpu::Tick& b) {
    return a.particle_count == b.particle_count && a.sun.to_light == b.sun.to_light && a.map.x == b.map.x &&
           a.falloff == b.falloff && a.cut == b.cut && a.map.lo == b.map.lo && a.map.hi == b.map.hi &&
           a.map.texels == b.map.texels && a.map.slices == b.map.slices;
}

} // namespace

ShadowVolume::ShadowVolume(const gpu::Device& device, uint32_t capacity, bool ellipsoids, bool fronts)
    : device_(device),
      particles_(device, {VK_SHADER_STAGE_COMPUTE_BIT, shadow_particles_comp, "shadow_particles"},
                 {{gpu::kIdLanes, device.lanesTogether()}, {gpu::kIdEllipsoids, ellipsoids}, {gpu::kIdFronts, fronts}}),
      volume_(device, {VK_SHADER_STAGE_COMPUTE_BIT, shadow_volume_comp, "shadow_volume"},
              {{gpu::kIdLanes, device.lanesTogether()},
               {gpu::kIdLockstep, device.lockstep()},
               {gpu::kIdEllipsoids, ellipsoids}}),
      tetrahedra_(device, tetrahedra_shadow_comp, "tetrahedra_shadow"),
      of_volume_(device, volume_shadow_comp, "volume_shadow") {
    light_particles_ = gpu::Buffer(device, std::max(capacity, 1u) * sizeof(gpu::LightParticle),
                                   VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device, "light particles");
    if (ellipsoids)
        light_skews_ = gpu::Buffer(device, std::max(capacity, 1u) * sizeof(gpu::Skew),
                                   VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device, "light skews");
}

void ShadowVolume::makeImage(VkCommandBuffer cmd, const gpu::Tick& tick) {
    const uint32_t layers = gpu::groups(tick.map.slices - 1, kNewPlanesPerLayer);
    if (image_ && image_.extent().width == tick.map.texels.x && image_.extent().height == tick.map.texels.y &&
        image_.layers() == layers)
        return;
    const VkImageUsageFlags usage =
        VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    image_ = gpu::Image(device_, {VK_FORMAT_R32G32B32A32_SFLOAT, {tick.map.texels.x, tick.map.texels.y}, usage, layers},
                        "shadow volume");
    gpu::toGeneral(cmd, image_);
}

template <class Record>
void ShadowVolume::inBands(VkCommandBuffer cmd, const gpu::Tick& tick, const Record& record) {
    // Through a buffer, which a CPU driver stores to several times faster than to an image.
    const VkDeviceSize row = VkDeviceSize(tick.map.texels.x) * image_.layers() * sizeof(glm::vec4); // of texels
    const uint32_t all = gpu::groups(tick.map.texels.y, kRows);
    const uint32_t most = uint32_t(std::clamp<VkDeviceSize>(kMostStaged / (row * kRows), 1, all));
    texels_.atLeast(device_, row * std::min(tick.map.texels.y, most * kRows),
                    VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT, gpu::Memory::device,
                    "shadow texels");
    for (uint32_t first = 0; first < all; first += most) {
        const uint32_t rows = std::min(most, all - first);
        record(first, rows);
        gpu::computeToTransfer(cmd);
        VkBufferImageCopy copy{};
        copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, image_.layers()};
        copy.imageOffset = {0, int32_t(first * kRows), 0};
        copy.imageExtent = {tick.map.texels.x, std::min(rows * kRows, tick.map.texels.y - first * kRows), 1};
        vkCmdCopyBufferToImage(cmd, texels_.handle(), image_.handle(), VK_IMAGE_LAYOUT_GENERAL, 1, &copy);
        gpu::everythingBefore(cmd); // the next band uses the buffer again; draws read the image
    }
}

bool ShadowVolume::record(gpu::Commands& commands, const gpu::Resources& shared, const gpu::Tick& tick,
                          bool same_particles, const TetrahedraBuffers* tetrahedra, const VolumeBuffers* volume) {
    if (image_ && same_particles && sameVolume(tick, last_)) return false;
    last_ = tick;
    const gpu::Commands::Pass pass(commands, tetrahedra ? "tetrahedra shadow" : "shadow volume");
    makeImage(commands.handle(), tick);
    gpu::everythingBefore(commands.handle()); // the last tick's viewers have read it
    if (tetrahedra)
        recordTetrahedra(commands, shared, tick, *tetrahedra);
    else if (volume)
        recordVolume(commands, shared, tick, *volume);
    else
        recordParticles(commands, shared, tick);
    return true;
}

void ShadowVolume::recordParticles(gpu::Commands& commands, const gpu::Resources& shared, const gpu::Tick& tick) {
    const VkCommandBuffer cmd = commands.handle();
    const glm::uvec3 tiles{gpu::groups(tick.map.texels.x, device_.lanesTogether()),
                           gpu::groups(tick.map.texels.y, kRows), gpu::groups(tick.map.slices - 1, kGroup)};
    const uint32_t particles = std::max(tick.particle_count, 1u);
    const VkDeviceSize bytes = lineBinBytes(tiles.x + tiles.y, particles);
    bins_.atLeast(device_, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                  gpu::Memory::device, "shadow bins");
    vkCmdFillBuffer(cmd, bins_.handle(), 0, bytes, 0);
    gpu::transferToCompute(cmd);
    const gpu::Resource skews = storageBuffer("LightSkews", light_skews_ ? light_skews_ : light_particles_);
    particles_.bind(commands, shared,
                    {storageBuffer("LightParticles", light_particles_), skews, storageBuffer("Bins", bins_)}, tiles);
    vkCmdDispatch(cmd, gpu::groups(particles, 32), 1, 1);
    gpu::computeToCompute(cmd);
    inBands(cmd, tick, [&](uint32_t first, uint32_t rows) {
        const Band band{tiles, first, rows};
        volume_.bind(commands, shared,
                     {storageBuffer("LightParticles", light_particles_), skews, storageBuffer("Bins", bins_),
                      storageBuffer("Texels", texels_)},
                     band);
        vkCmdDispatch(cmd, gpu::groups(tiles.x * rows, 8) * 8, 1, 1);
    });
}

void ShadowVolume::recordTetrahedra(gpu::Commands& commands, const gpu::Resources& shared, const gpu::Tick& tick,
                                    const TetrahedraBuffers& tetrahedra) {
    inBands(commands.handle(), tick, [&](uint32_t first, uint32_t rows) {
        const gpu::TetrahedraBand band{first * kRows, rows * kRows, image_.layers(), tetrahedra.faceCount()};
        tetrahedra_.with().bind(commands, shared,
                                {storageBuffer("Cells", tetrahedra.cells), storageBuffer("Faces", tetrahedra.faces),
                                 storageBuffer("Texels", texels_), storageBuffer("FaceNodes", tetrahedra.nodes)},
                                band);
        vkCmdDispatch(commands.handle(), gpu::groups(tick.map.texels.x, 8), rows, 1);
    });
}

void ShadowVolume::recordVolume(gpu::Commands& commands, const gpu::Resources& shared, const gpu::Tick& tick,
                                const VolumeBuffers& volume) {
    inBands(commands.handle(), tick, [&](uint32_t first, uint32_t rows) {
        const struct {
            gpu::MediumGrid medium;
            uint32_t first_row, rows, layers;
        } push{volume.grid(), first * kRows, rows * kRows, image_.layers()};
        of_volume_.with().bind(commands, shared,
                               {storageBuffer("Nodes", volume.nodes()), storageBuffer("Marks", volume.marks()),
                                storageBuffer("Texels", texels_)},
                               push);
        vkCmdDispatch(commands.handle(), gpu::groups(tick.map.texels.x, 8), rows, 1);
    });
}

} // namespace brume
