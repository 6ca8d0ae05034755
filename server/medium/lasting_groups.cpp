#include "server/medium/lasting_groups.h"

#include <algorithm>
#include <utility>

#include "server/medium/group.h"

namespace brume {
namespace {

constexpr uint32_t kBits = 20; // of a cell's number along an axis

// Two zeros after each of the lowest 21 bits.
uint64_t spread(uint64_t x) {
    x = (x | x << 32) & 0x1f00000000ffffull;
    x = (x | x << 16) & 0x1f0000ff0000ffull;
    x = (x | x << 8) & 0x100f00f00f00f00full;
    x = (x | x << 4) & 0x10c30c30c30c30c3ull;
    return (x | x << 2) & 0x1249249249249249ull;
}

} // namespace

// The finest cells come in the order of a Morton curve. Those of any coarser grid are runs of it.
void LastingGroups::build(std::span<const gpu::Particle> particles, uint32_t most) {
    clear();
    if (particles.empty()) return;
    glm::vec3 lo(1e30f), hi(-1e30f);
    for (const gpu::Particle& p : particles) lo = glm::min(lo, p.centre), hi = glm::max(hi, p.centre);
    const glm::vec3 size = hi - lo;
    const float per_metre = float(1u << kBits) / (std::max({size.x, size.y, size.z, 1e-3f}) * 1.0001f);
    std::vector<std::pair<uint64_t, uint32_t>> keys;
    keys.reserve(particles.size());
    for (uint32_t i = 0; i < particles.size(); ++i) {
        const glm::uvec3 cell((particles[i].centre - lo) * per_metre);
        keys.emplace_back(spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2, i);
    }
    std::ranges::sort(keys);
    uint32_t shift = 0;
    const auto cells = [&] {
        size_t count = 1;
        for (size_t i = 1; i < keys.size(); ++i) count += keys[i].first >> shift != keys[i - 1].first >> shift;
        return count;
    };
    while (cells() > most) ++shift; // halves along one axis after the other
    for (size_t i = 0; i < keys.size(); ++i) {
        if (i > 0 && keys[i].first >> shift != keys[i - 1].first >> shift) ends_.push_back(uint32_t(i));
        members_.push_back(keys[i].second);
    }
    ends_.push_back(uint32_t(members_.size()));
}

void LastingGroups::merge(std::span<const gpu::Particle> particles, float falloff,
                          std::vector<gpu::Particle>& out) const {
    out.clear();
    uint32_t begin = 0;
    for (const uint32_t end : ends_) {
        Group group;
        for (uint32_t i = begin; i < end; ++i) {
            const gpu::Particle& p = particles[members_[i]];
            group.add(p, double(falloff));
        }
        out.push_back(group.merged(double(falloff)));
        begin = end;
    }
}

} // namespace brume
