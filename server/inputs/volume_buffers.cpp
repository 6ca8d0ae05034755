#include "server/inputs/volume_buffers.h"

#include <utility>
#include <vector>

#include "server/inputs/on_device.h"

namespace brume {
namespace {

static_assert(Volume::kBrick == gpu::kSlabTile);
constexpr uint32_t kRimBefore = Volume::kRimBefore; // samples read one node before and two behind
constexpr float kNoCoarseNodes = 1e30f;

} // namespace

VolumeBuffers::VolumeBuffers(const gpu::Device& device, std::shared_ptr<const Volume> volume, glm::vec3 centre)
    : device_(device), volume_(std::move(volume)) {
    const double spacing = volume_->spacing;
    grid_.origin = glm::vec3(volume_->origin + glm::dvec3(centre) - double(kRimBefore) * spacing);
    grid_.spacing = float(spacing);
    grid_.bricks = volume_->bricks();
    grid_.variance = 0;
    grid_.least_coarse = kNoCoarseNodes;
    makeMarks();
}

// Of the bricks in whose cells there is medium, and of all bricks for reading.
void VolumeBuffers::makeMarks() {
    const glm::uvec3 bricks = grid_.bricks, coarse = bricks / 2u + 1u;
    const uint32_t row = (bricks.x + 31) / 32, words = row * bricks.y * bricks.z;
    std::vector<uint32_t> marks(2 * words + (coarse.x + 31) / 32 * coarse.y * coarse.z, ~0u);
    std::fill_n(marks.begin(), words, 0u);
    const Volume& v = *volume_;
    for (uint32_t z = 0; z < v.size.z; ++z)
        for (uint32_t y = 0; y < v.size.y; ++y)
            for (uint32_t x = 0; x < v.size.x; ++x) {
                if (!(v.at({x, y, z}) > 0)) continue;
                const glm::uvec3 node = glm::uvec3(x, y, z) + kRimBefore;
                for (uint32_t i = 0; i < 8; ++i) { // the eight cells around it
                    const glm::uvec3 brick = (node - glm::uvec3(i & 1, i >> 1 & 1, i >> 2)) / gpu::kSlabTile;
                    marks[(brick.z * bricks.y + brick.y) * row + brick.x / 32] |= 1u << brick.x % 32;
                }
            }
    marks_ = onDevice(device_, marks, "volume marks");
}

void VolumeBuffers::follow(float times) {
    if (times == times_) return;
    times_ = times;
    const glm::uvec3 size = grid_.bricks * gpu::kSlabTile;
    std::vector<float> nodes(size_t(size.x) * size.y * size.z, 0.0f);
    size_t from = 0;
    for (uint32_t z = 0; z < volume_->size.z; ++z)
        for (uint32_t y = 0; y < volume_->size.y; ++y) {
            float* to = &nodes[(size_t(z + kRimBefore) * size.y + y + kRimBefore) * size.x + kRimBefore];
            for (uint32_t x = 0; x < volume_->size.x; ++x) *to++ = times * volume_->extinction[from++];
        }
    nodes_ = onDevice(device_, nodes, "volume nodes");
}

} // namespace brume
