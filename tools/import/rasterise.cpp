#include "tools/import/rasterise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include "tools/import/parallel.h"

namespace brume::volumes {

namespace {

constexpr double kReach = 5; // deviations; a Gaussian has 4e-6 of its peak there
constexpr uint64_t kEndless = ~0ull;

// The blocks that a Gaussian reaches.
class Reach {
public:
    explicit Reach(const Gaussian& gaussian) : centre_(gaussian.centre) {
        glm::dvec3 half(kReach * gaussian.deviation);
        if (gaussian.axes) {
            const glm::dmat3& axes = *gaussian.axes;
            half *= glm::sqrt(axes[0] * axes[0] + axes[1] * axes[1] + axes[2] * axes[2]); // covariance's diagonal
            const double shortest = std::min({glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2])});
            farthest_ = kReach + kHalfDiagonal / (shortest * gaussian.deviation);
            for (int i = 0; i < 3; ++i) rows_[i] = axes[i] / (glm::dot(axes[i], axes[i]) * gaussian.deviation);
        }
        from_ = glm::ivec3(glm::floor(gaussian.centre - half)) >> 3;
        to_ = glm::ivec3(glm::ceil(gaussian.centre + half)) >> 3;
    }

    // An ellipsoid's vector from its centre to a place, in deviations along its axes.
    glm::dvec3 deviationsTo(glm::dvec3 place) const {
        const glm::dvec3 d = place - centre_;
        return {glm::dot(rows_[0], d), glm::dot(rows_[1], d), glm::dot(rows_[2], d)};
    }

    // Calls visit(block) until it returns false.
    template <class Visit>
    void forBlocks(int x_from, int x_to, const Visit& visit) const {
        for (int x = std::max(from_.x, x_from); x <= std::min(to_.x, x_to); ++x)
            for (int y = from_.y; y <= to_.y; ++y)
                for (int z = from_.z; z <= to_.z; ++z)
                    if (const glm::ivec3 block(x, y, z); reaches(block) && !visit(block)) return;
    }

private:
    static constexpr double kHalfDiagonal = 0.5 * (kSide - 1) * std::numbers::sqrt3; // from a block's middle

    // False for blocks in the corners of a slanted ellipsoid's box, which are most of it.
    bool reaches(glm::ivec3 block) const {
        if (farthest_ == 0) return true;
        return glm::length(deviationsTo(glm::dvec3(block * kSide) + 0.5 * (kSide - 1))) <= farthest_;
    }

    glm::dvec3 centre_;
    glm::ivec3 from_, to_; // blocks
    glm::dmat3 rows_{0};   // of the matrix that makes deviations of voxels; an ellipsoid's alone
    double farthest_ = 0;  // deviations, at most, of the middle of a block that it reaches; 0: a ball
};

// All of them, or more than `most` of them.
std::vector<glm::ivec3> blocksAround(std::span<const Gaussian> gaussians, uint64_t most) {
    std::unordered_map<uint64_t, glm::ivec3> found;
    for (const Gaussian& gaussian : gaussians)
        Reach(gaussian).forBlocks(-kFarthest, kFarthest, [&](glm::ivec3 b) {
            found.emplace(mortonOf(b), b);
            return found.size() <= most;
        });
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

// Calls add(place in the block, value) for the voxels of a block.
template <class Add>
void forVoxels(const Gaussian& gaussian, const Reach& reach, glm::ivec3 block, const Add& add) {
    if (gaussian.axes) {
        for (size_t n = 0; n < kInBlock; ++n) {
            const glm::dvec3 y = reach.deviationsTo(glm::dvec3(voxelOf(block, n)));
            if (const double squared = glm::dot(y, y); squared <= kReach * kReach)
                add(n, float(gaussian.peak * std::exp(-0.5 * squared)));
        }
        return;
    }
    const auto w = weightsOf(gaussian, block);
    for (size_t n = 0; n < kInBlock; ++n) add(n, float(gaussian.peak) * w[0][n / 64] * w[1][n / 8 % 8] * w[2][n % 8]);
}

} // namespace

bool fits(std::span<const Gaussian> gaussians, uint64_t most) { return blocksAround(gaussians, most).size() <= most; }

double massOf(const Gaussian& gaussian) {
    const double volume = gaussian.axes ? std::abs(glm::determinant(*gaussian.axes)) : 1;
    return gaussian.peak * std::pow(2 * std::numbers::pi, 1.5) * std::pow(gaussian.deviation, 3) * volume;
}

Raster rasterised(std::span<const Gaussian> gaussians, float least, bool coloured) {
    Raster out{Voxels(blocksAround(gaussians, kEndless)), {}};
    const std::span<float> values = out.voxels.values();
    if (coloured) out.albedo.assign(values.size(), glm::vec3(0));
    const std::vector<uint32_t>& layers = out.voxels.layers();
    // Layer by layer, so that each voxel adds up the Gaussians in their order.
    parallelFor(layers.size() - 1, [&](size_t layer) {
        const int x = out.voxels.blocks()[layers[layer]].x;
        for (const Gaussian& gaussian : gaussians) {
            const Reach reach(gaussian);
            reach.forBlocks(x, x, [&](glm::ivec3 block) {
                const size_t first = out.voxels.find(block) * kInBlock;
                forVoxels(gaussian, reach, block, [&](size_t n, float part) {
                    values[first + n] += part;
                    if (coloured) out.albedo[first + n] += part * gaussian.albedo;
                });
                return true;
            });
        }
    });
    for (size_t i = 0; i < values.size(); ++i) {
        if (coloured && values[i] > 0) out.albedo[i] /= values[i];
        if (!(values[i] > least)) values[i] = 0;
    }
    out.voxels.finish();
    return out;
}

} // namespace brume::volumes
