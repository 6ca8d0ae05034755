// Voxels of a scalar grid in blocks of 8 x 8 x 8. The centre of voxel (i, j, k) is at the place (i, j, k), as in a VDB.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include <glm/glm.hpp>

namespace brume::volumes {

inline constexpr int kSide = 8;                           // voxels
inline constexpr size_t kInBlock = kSide * kSide * kSide; // x slowest, z fastest
inline constexpr uint32_t kNoBlock = ~0u;
inline constexpr int kFarthest = 1 << 20; // a voxel's coordinates lie between -kFarthest and kFarthest

class Voxels {
public:
    // Zeros. `blocks`: each once, in units of blocks.
    explicit Voxels(std::vector<glm::ivec3> blocks);

    // Sums up what was written into values().
    void finish();

    // Ascending by x, y, z.
    const std::vector<glm::ivec3>& blocks() const { return blocks_; }
    // Of the blocks one after the other.
    std::span<float> values() { return values_; }
    std::span<const float> values() const { return values_; }
    // The number of a block, or kNoBlock.
    uint32_t find(glm::ivec3 block) const;
    // The value of a voxel, 0 outside all blocks.
    float at(glm::ivec3 voxel) const;
    // Number of the first block of each run of blocks that have the same x; at the end the number of all blocks.
    const std::vector<uint32_t>& layers() const { return layers_; }

    uint64_t active() const { return active_; } // voxels above 0
    double sum() const { return sum_; }
    glm::ivec3 lo() const { return lo_; } // the lowest and highest voxels above 0
    glm::ivec3 hi() const { return hi_; }

private:
    std::vector<glm::ivec3> blocks_;
    std::vector<float> values_;
    std::vector<uint32_t> layers_;
    std::unordered_map<uint64_t, uint32_t> number_;
    uint64_t active_ = 0;
    double sum_ = 0;
    glm::ivec3 lo_{0}, hi_{0};
};

// The same trilinear function, of voxels half as wide: voxel (2 i, 2 j, 2 k) is where (i, j, k) was.
Voxels halved(const Voxels& voxels);

// The place of a voxel's value in its block.
inline size_t inBlock(glm::ivec3 voxel) { return size_t((voxel.x & 7) * 64 + (voxel.y & 7) * 8 + (voxel.z & 7)); }
// The voxel of a place in a block.
inline glm::ivec3 voxelOf(glm::ivec3 block, size_t place) {
    return block * kSide + glm::ivec3(int(place / 64), int(place / 8 % 8), int(place % 8));
}

// Calls visit(voxel, value) for each voxel above 0.
template <class Visit>
void forActive(const Voxels& voxels, const Visit& visit) {
    for (size_t i = 0; i < voxels.values().size(); ++i)
        if (const float value = voxels.values()[i]; value > 0)
            visit(voxelOf(voxels.blocks()[i / kInBlock], i % kInBlock), value);
}

// A cell's coordinates as one number: their bits in turns, so that the eight parts of a cell follow each other.
// Precondition: they are between -kFarthest and kFarthest.
uint64_t mortonOf(glm::ivec3 cell);

} // namespace brume::volumes
