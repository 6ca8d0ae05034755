#include "server/medium/levels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "server/medium/group.h"

namespace brume {
namespace {

constexpr int kDigitBits = 10;               // of the Morton code's 30, sorted in three passes
constexpr float kSmallestCell = 1.0f / 4096; // m; 50 km are still a whole number of them
constexpr float kCells = 512;                // across the bounds at least half as many, at most these

// Three zeros before each of the ten lowest bits.
uint32_t spread(uint32_t x) {
    x = (x | x << 16) & 0x030000ffu;
    x = (x | x << 8) & 0x0300f00fu;
    x = (x | x << 4) & 0x030c30c3u;
    return (x | x << 2) & 0x09249249u;
}

// Of a power of two that x, positive, is one to two times; -127 for what is smaller than any.
int exponentOf(float x) { return int(std::bit_cast<uint32_t>(x) >> 23) - 127; }

} // namespace

void SpatialOrder::sort(std::span<const gpu::Particle> particles, std::span<gpu::Particle> out) {
    glm::vec3 lo(1e30f), hi(-1e30f);
    for (const gpu::Particle& p : particles) {
        lo = glm::min(lo, p.centre);
        hi = glm::max(hi, p.centre);
    }
    const glm::vec3 size = hi - lo;
    int exponent = 0; // of the cells' side
    std::frexp(std::max({size.x, size.y, size.z, 1e-3f}) / kCells, &exponent);
    // The curve begins at a multiple of 512 cells: then it passes through all of a larger cell before it leaves it.
    const float per_cell = std::ldexp(1.0f, -exponent);
    const glm::vec3 first = glm::floor(lo * (per_cell / kCells)) * kCells;
    keys_.resize(particles.size());
    other_.resize(particles.size());
    constexpr uint32_t kDigits = 1u << kDigitBits;
    std::array<std::array<uint32_t, kDigits>, 3> counts{};
    for (uint32_t i = 0; i < particles.size(); ++i) {
        const glm::uvec3 cell(glm::clamp(particles[i].centre * per_cell - first, 0.0f, 1023.0f));
        const uint32_t code = spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2;
        keys_[i] = uint64_t{code} << 32 | i;
        for (uint32_t d = 0; d < 3; ++d) ++counts[d][code >> d * kDigitBits & (kDigits - 1)];
    }
    for (uint32_t d = 0; d < 3; ++d) {
        uint32_t at = 0;
        for (uint32_t& count : counts[d]) at += std::exchange(count, at);
        for (const uint64_t key : keys_) other_[counts[d][key >> (32 + d * kDigitBits) & (kDigits - 1)]++] = key;
        keys_.swap(other_);
    }
    for (size_t i = 0; i < particles.size(); ++i) out[i] = particles[uint32_t(keys_[i])];
}

void mergeCells(std::span<const gpu::Particle> ordered, float falloff, int exponent, std::vector<gpu::Particle>& out) {
    // Sizes that merge, by the octave of s / cell: below 1/8, 1/8, 1/4, 1/2, 1, 2.
    constexpr int kSmallest = -4, kLargest = 1;
    std::array<Group, kLargest - kSmallest + 1> groups;
    const auto flush = [&](Group& g) {
        if (g.members == 0) return;
        out.push_back(g.merged(double(falloff)));
        g = {};
    };
    const float per_cell = std::ldexp(1.0f, -exponent);
    const auto cellOf = [&](float x) { // floor, in registers
        const float cells = x * per_cell;
        const auto whole = int(cells);
        return whole - (cells < float(whole));
    };
    glm::ivec3 cell(0);
    for (const gpu::Particle& p : ordered) {
        if (const glm::ivec3 here(cellOf(p.centre.x), cellOf(p.centre.y), cellOf(p.centre.z)); here != cell) {
            for (Group& g : groups) flush(g);
            cell = here;
        }
        const double s = 0.1 * double(p.scale) * double(falloff), depth = kUnitDepth * double(p.sigma_t) * s;
        const int octave = std::max(exponentOf(float(s)) - exponent, kSmallest);
        if (!(depth > 0 && depth <= kMostMergedDepth) || octave > kLargest) {
            out.push_back(p);
            continue;
        }
        Group& g = groups[size_t(octave - kSmallest)];
        if (g.depth + depth > kMostMergedDepth) flush(g);
        g.add(p, s, kUnitMass * double(p.sigma_t) * s * s * s, depth);
    }
    for (Group& g : groups) flush(g);
}

int mergeLevel(const Pose& pose, uint32_t width, uint32_t height, const MediumExtent& extent, float merge) {
    const glm::vec3 outside = glm::max(glm::max(extent.lo - pose.position, pose.position - extent.hi), glm::vec3(0));
    const Frustum frustum = frustumOf(pose, width, height);
    // View depth is the distance times a cosine, in the picture's corner the least one.
    const float depth = glm::length(outside) / cornerLength(frustum);
    const float side = merge * depth * (frustum.up + frustum.down) / float(height);
    return side >= kSmallestCell ? std::ilogb(side) : kNoLevel;
}

} // namespace brume
