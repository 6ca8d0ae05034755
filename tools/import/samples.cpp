#include "tools/import/samples.h"

#include <algorithm>
#include <vector>

#include "common/random.h"
#include "tools/import/parallel.h"

namespace brume::volumes {

namespace {

std::vector<glm::ivec3> blocksBetween(glm::ivec3 lo, glm::ivec3 hi) {
    std::vector<glm::ivec3> out;
    for (int x = lo.x >> 3; x <= hi.x >> 3; ++x)
        for (int y = lo.y >> 3; y <= hi.y >> 3; ++y)
            for (int z = lo.z >> 3; z <= hi.z >> 3; ++z) out.emplace_back(x, y, z);
    return out;
}

// The same without blocks of zeros.
Voxels withoutEmpty(const Voxels& all) {
    std::vector<glm::ivec3> kept;
    for (size_t i = 0; i < all.blocks().size(); ++i) {
        const auto block = all.values().subspan(i * kInBlock, kInBlock);
        if (std::ranges::any_of(block, [](float v) { return v > 0; })) kept.push_back(all.blocks()[i]);
    }
    Voxels out(std::move(kept));
    for (size_t i = 0; i < out.blocks().size(); ++i)
        std::ranges::copy(all.values().subspan(all.find(out.blocks()[i]) * kInBlock, kInBlock),
                          out.values().begin() + std::ptrdiff_t(i * kInBlock));
    out.finish();
    return out;
}

float valueAt(glm::ivec3 corner, uint64_t seed) { return Random(seed, mortonOf(corner)).uniform(); }

float noise(glm::dvec3 at, uint64_t seed) {
    const glm::dvec3 base = glm::floor(at), part = at - base;
    const glm::dvec3 smooth = part * part * (3.0 - 2.0 * part);
    double sum = 0;
    for (int n = 0; n < 8; ++n) {
        const glm::ivec3 corner(n & 1, n >> 1 & 1, n >> 2);
        const glm::dvec3 w = glm::mix(1.0 - smooth, smooth, glm::dvec3(corner));
        sum += w.x * w.y * w.z * double(valueAt(glm::ivec3(base) + corner, seed));
    }
    return float(sum);
}

} // namespace

Voxels sampled(glm::ivec3 lo, glm::ivec3 hi, float least, const std::function<float(glm::ivec3)>& value) {
    Voxels all(blocksBetween(lo, hi));
    parallelFor(all.blocks().size(), [&](size_t i) {
        for (size_t n = 0; n < kInBlock; ++n) {
            const glm::ivec3 voxel = all.blocks()[i] * kSide + glm::ivec3(int(n) / 64, int(n) / 8 % 8, int(n) % 8);
            const float v = glm::clamp(voxel, lo, hi) == voxel ? value(voxel) : 0;
            all.values()[i * kInBlock + n] = v > least ? v : 0;
        }
    });
    return withoutEmpty(all);
}

float fractalNoise(glm::dvec3 at, int octaves, uint64_t seed) {
    float sum = 0, all = 0, part = 1;
    for (int i = 0; i < octaves; ++i) {
        sum += part * noise(at, seed + uint64_t(i));
        all += part;
        part *= 0.5f;
        at *= 2.0;
    }
    return sum / all;
}

} // namespace brume::volumes
