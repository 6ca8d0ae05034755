#include "tools/import/rasterise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <unordered_map>

#include "tools/import/parallel.h"

namespace brume::volumes {

namespace {

constexpr double kReach = 5; // deviations; a ball has 4e-6 of its peak there

struct Box {
    glm::ivec3 from, to; // blocks
    explicit Box(const Ball& ball)
        : from(glm::ivec3(glm::floor(ball.centre - kReach * ball.deviation)) >> 3),
          to(glm::ivec3(glm::ceil(ball.centre + kReach * ball.deviation)) >> 3) {}

    template <class Visit>
    void forBlocks(int x_from, int x_to, const Visit& visit) const {
        for (int x = std::max(from.x, x_from); x <= std::min(to.x, x_to); ++x)
            for (int y = from.y; y <= to.y; ++y)
                for (int z = from.z; z <= to.z; ++z) visit(glm::ivec3(x, y, z));
    }
};

std::vector<glm::ivec3> blocksAround(std::span<const Ball> balls) {
    std::unordered_map<uint64_t, glm::ivec3> found;
    for (const Ball& ball : balls)
        Box(ball).forBlocks(-kFarthest, kFarthest, [&](glm::ivec3 b) { found.emplace(mortonOf(b), b); });
    std::vector<glm::ivec3> out;
    for (const auto& [morton, block] : found) out.push_back(block);
    return out; // Voxels sorts them
}

// A ball's weights along the eight voxels of a block, on each axis.
std::array<std::array<float, kSide>, 3> weightsOf(const Ball& ball, glm::ivec3 block) {
    std::array<std::array<float, kSide>, 3> out;
    const double fall = -0.5 / (ball.deviation * ball.deviation);
    for (int axis = 0; axis < 3; ++axis)
        for (int i = 0; i < kSide; ++i) {
            const double d = double(block[axis] * kSide + i) - ball.centre[axis];
            out[size_t(axis)][size_t(i)] = float(std::exp(fall * d * d));
        }
    return out;
}

} // namespace

uint64_t blocksOf(std::span<const Ball> balls) { return blocksAround(balls).size(); }

Raster rasterised(std::span<const Ball> balls, float least, bool coloured) {
    Raster out{Voxels(blocksAround(balls)), {}};
    const std::span<float> values = out.voxels.values();
    if (coloured) out.albedo.assign(values.size(), glm::vec3(0));
    const std::vector<uint32_t>& layers = out.voxels.layers();
    // Layer by layer, so that each voxel adds up the balls in their order.
    parallelFor(layers.size() - 1, [&](size_t layer) {
        const int x = out.voxels.blocks()[layers[layer]].x;
        for (const Ball& ball : balls)
            Box(ball).forBlocks(x, x, [&](glm::ivec3 block) {
                const size_t first = out.voxels.find(block) * kInBlock;
                const auto w = weightsOf(ball, block);
                for (size_t n = 0; n < kInBlock; ++n) {
                    const float part = float(ball.peak) * w[0][n / 64] * w[1][n / 8 % 8] * w[2][n % 8];
                    values[first + n] += part;
                    if (coloured) out.albedo[first + n] += part * ball.albedo;
                }
            });
    });
    for (size_t i = 0; i < values.size(); ++i) {
        if (coloured && values[i] > 0) out.albedo[i] /= values[i];
        if (!(values[i] > least)) values[i] = 0;
    }
    out.voxels.finish();
    return out;
}

} // namespace brume::volumes
