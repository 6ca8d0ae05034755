#include "tools/import/voxels.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace brume::volumes {

namespace {

// Two zeros after each of the lowest 21 bits.
uint64_t spread(uint64_t v) {
    v = (v | v << 32) & 0x1f00000000ffff;
    v = (v | v << 16) & 0x1f0000ff0000ff;
    v = (v | v << 8) & 0x100f00f00f00f00f;
    v = (v | v << 4) & 0x10c30c30c30c30c3;
    return (v | v << 2) & 0x1249249249249249;
}

} // namespace

uint64_t mortonOf(glm::ivec3 cell) {
    const glm::ivec3 from = cell + kFarthest;
    return spread(uint64_t(from.x)) << 2 | spread(uint64_t(from.y)) << 1 | spread(uint64_t(from.z));
}

Voxels::Voxels(std::vector<glm::ivec3> blocks) : blocks_(std::move(blocks)) {
    std::ranges::sort(blocks_, {}, [](glm::ivec3 b) { return std::tuple(b.x, b.y, b.z); });
    values_.assign(blocks_.size() * kInBlock, 0);
    number_.reserve(blocks_.size());
    for (uint32_t i = 0; i < blocks_.size(); ++i) {
        number_.emplace(mortonOf(blocks_[i]), i);
        if (i == 0 || blocks_[i].x != blocks_[i - 1].x) layers_.push_back(i);
    }
    layers_.push_back(uint32_t(blocks_.size()));
}

void Voxels::finish() {
    active_ = 0;
    sum_ = 0;
    lo_ = glm::ivec3(std::numeric_limits<int>::max()), hi_ = -lo_;
    forActive(*this, [&](glm::ivec3 voxel, float value) {
        ++active_;
        sum_ += double(value);
        lo_ = glm::min(lo_, voxel);
        hi_ = glm::max(hi_, voxel);
    });
}

uint32_t Voxels::find(glm::ivec3 block) const {
    const auto found = number_.find(mortonOf(block));
    return found == number_.end() ? kNoBlock : found->second;
}

float Voxels::at(glm::ivec3 voxel) const {
    const uint32_t block = find(voxel >> 3);
    return block == kNoBlock ? 0 : values_[block * kInBlock + inBlock(voxel)];
}

Voxels halved(const Voxels& voxels) {
    std::vector<glm::ivec3> blocks;
    for (const glm::ivec3 block : voxels.blocks()) // a part of the block before it on each axis belongs to it, too
        for (int n = 0; n < 27; ++n) blocks.push_back(2 * block + glm::ivec3(n / 9, n / 3 % 3, n % 3) - 1);
    std::ranges::sort(blocks, {}, [](glm::ivec3 b) { return std::tuple(b.x, b.y, b.z); });
    blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
    Voxels out(std::move(blocks));
    for (size_t i = 0; i < out.values().size(); ++i) {
        const glm::ivec3 voxel = voxelOf(out.blocks()[i / kInBlock], i % kInBlock), odd = voxel & 1;
        float sum = 0;
        for (int n = 0; n < 8; ++n) sum += voxels.at((voxel >> 1) + (odd & glm::ivec3(n & 1, n >> 1 & 1, n >> 2)));
        out.values()[i] = sum / 8;
    }
    out.finish();
    return out;
}

} // namespace brume::volumes
