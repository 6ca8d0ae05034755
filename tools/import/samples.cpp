#include "tools/import/samples.h"

#include <algorithm>
#include <cmath>

#include "common/random.h"
#include "tools/import/parallel.h"

namespace brume::import {

namespace {

constexpr double kReach = 5; // deviations; a ball has 4e-6 of its peak there

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

Voxels rasterised(std::span<const Ball> balls, float least) {
    glm::dvec3 lo(1e30), hi(-1e30);
    for (const Ball& ball : balls) {
        lo = glm::min(lo, ball.centre - kReach * ball.deviation);
        hi = glm::max(hi, ball.centre + kReach * ball.deviation);
    }
    Voxels all(blocksBetween(glm::ivec3(glm::floor(lo)), glm::ivec3(glm::ceil(hi))));
    const std::vector<uint32_t>& layers = all.layers();
    parallelFor(layers.size() - 1, [&](size_t layer) {
        const int x0 = all.blocks()[layers[layer]].x * kSide;
        for (const Ball& ball : balls) {
            const double far = kReach * ball.deviation, fall = -0.5 / (ball.deviation * ball.deviation);
            const glm::ivec3 from(glm::ceil(ball.centre - far)), to(glm::floor(ball.centre + far));
            for (int x = std::max(from.x, x0); x <= std::min(to.x, x0 + kSide - 1); ++x)
                for (int y = from.y; y <= to.y; ++y)
                    for (int z = from.z; z <= to.z; ++z) {
                        const glm::dvec3 d = glm::dvec3(x, y, z) - ball.centre;
                        const uint32_t block = all.find(glm::ivec3(x, y, z) >> 3);
                        all.values()[block * kInBlock + size_t((x & 7) * 64 + (y & 7) * 8 + (z & 7))] +=
                            float(ball.peak * std::exp(fall * glm::dot(d, d)));
                    }
        }
    });
    for (float& v : all.values())
        if (v <= least) v = 0;
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

} // namespace brume::import
