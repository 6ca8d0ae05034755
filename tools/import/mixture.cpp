#include "tools/import/mixture.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "tools/import/ball_weights.h"
#include "tools/import/ellipsoid_weights.h"
#include "tools/import/parallel.h"

namespace brume::volumes {

namespace {

constexpr double kNarrowest = 0.7, kWidest = 1.6; // deviations in relation to what they begin with
constexpr double kStray = 0.75;                   // how far a Gaussian gets from its cell's middle; widths of the cell
constexpr size_t kTogether = 256;                 // kernels that one core takes at a time

double startDeviation(const Shape& shape, int level) {
    const double whole = shape.ratio * shape.of(level);
    return std::sqrt(std::max(whole * whole - kInterpolation, kLeastDeviation * kLeastDeviation));
}

// Calls visit(block, its first voxel) for each block within reach, of those with x from `from` to `to`.
template <class Weights, class Visit>
void forBlocks(const Voxels& voxels, const Weights& weights, int from, int to, const Visit& visit) {
    const glm::ivec3 lo = weights.first() >> 3, hi = weights.last() >> 3;
    for (int x = std::max(from, lo.x); x <= std::min(to, hi.x); ++x)
        for (int y = lo.y; y <= hi.y; ++y)
            for (int z = lo.z; z <= hi.z; ++z)
                if (const uint32_t block = voxels.find({x, y, z}); block != kNoBlock)
                    visit(block, glm::ivec3(x, y, z) * kSide);
}

glm::dvec3 middleOf(const Shape& shape, int level, glm::ivec3 cell) {
    return (glm::dvec3(cell) + 0.5) * shape.of(level) - 0.5;
}

// Moves a Gaussian to the middle of the mass that it got, and widens it to that mass's spread, within bounds.
void follow(const Shape& shape, const Moments& got, bool axes, Kernel& kernel) {
    const glm::dvec3 shift = got.first / got.mass;
    const glm::dmat3 spread = got.second / got.mass - glm::outerProduct(shift, shift);
    const glm::dvec3 middle = middleOf(shape, kernel.level, kernel.cell);
    const glm::dvec3 stray(kStray * shape.of(kernel.level));
    kernel.at = glm::clamp(kernel.at + shift, middle - stray, middle + stray);
    const double start = startDeviation(shape, kernel.level), widest = kWidest * start;
    if (axes) {
        kernel.spread = clampedSpread(spread, kLeastDeviation, widest);
        return;
    }
    const double variance = (spread[0][0] + spread[1][1] + spread[2][2]) / 3;
    kernel.spread = ballSpread(
        std::clamp(std::sqrt(std::max(variance, 0.0)), std::max(kNarrowest * start, kLeastDeviation), widest));
}

} // namespace

bool isBall(const Kernel& kernel) {
    const glm::dmat3& spread = kernel.spread;
    return spread == glm::dmat3(spread[0][0]);
}

glm::dmat3 trueSpread(const Kernel& kernel) { return kernel.spread + glm::dmat3(kInterpolation); }

Kernel kernelOf(const Shape& shape, int level, glm::ivec3 cell, float mass) {
    return {middleOf(shape, level, cell), ballSpread(startDeviation(shape, level)), mass, cell, level};
}

Mixture::Mixture(const Voxels& voxels, Shape shape, std::vector<Kernel> kernels)
    : voxels_(voxels), shape_(shape), kernels_(std::move(kernels)) {
    order();
}

void Mixture::order() {
    std::ranges::sort(kernels_, {}, [](const Kernel& k) { return std::tuple(k.level, k.cell.x, k.cell.y, k.cell.z); });
    for (int level = 0; level <= kLevels; ++level)
        begin_[size_t(level)] =
            size_t(std::ranges::lower_bound(kernels_, level, {}, &Kernel::level) - kernels_.begin());
}

// One layer of blocks after the other, each by one core: a voxel's sum is always taken in the order of the kernels.
template <class Weights>
void Mixture::addUp(std::vector<float>& out) const {
    out.assign(voxels_.values().size(), 0);
    const std::vector<uint32_t>& layers = voxels_.layers();
    parallelFor(layers.size() - 1, [&](size_t layer) {
        const int x = voxels_.blocks()[layers[layer]].x;
        for (int level = 0; level < kLevels; ++level) {
            const double width = shape_.of(level);
            const double reach = Weights::kReach * kWidest * startDeviation(shape_, level) + (kStray + 1) * width;
            const int first = int(std::floor((x * kSide - reach) / width));
            const int last = int(std::ceil(((x + 1) * kSide + reach) / width));
            const auto begin = kernels_.begin() + std::ptrdiff_t(begin_[size_t(level)]);
            const auto end = kernels_.begin() + std::ptrdiff_t(begin_[size_t(level) + 1]);
            const auto cell_x = [](const Kernel& k) { return k.cell.x; };
            for (auto k = std::ranges::lower_bound(begin, end, first, {}, cell_x); k != end && k->cell.x <= last; ++k) {
                const double far = Weights::kReach * std::sqrt(k->spread[0][0]);
                if (k->at.x + far < x * kSide || k->at.x - far > (x + 1) * kSide - 1) continue;
                const Weights weights(*k);
                forBlocks(voxels_, weights, x, x, [&](uint32_t block, glm::ivec3 origin) {
                    weights.scatter(&out[block * kInBlock], origin, k->mass);
                });
            }
        }
    });
}

std::vector<float> Mixture::sums() const {
    std::vector<float> out;
    if (std::ranges::all_of(kernels_, isBall))
        addUp<BallWeights>(out);
    else
        addUp<EllipsoidWeights>(out);
    return out;
}

void Mixture::refine(int rounds, Follow what) {
    for (int round = 0; round < rounds; ++round) {
        if (what == Follow::place_and_axes)
            refineOnce<EllipsoidWeights>(what);
        else
            refineOnce<BallWeights>(what);
    }
}

template <class Weights>
void Mixture::refineOnce(Follow what) {
    addUp<Weights>(part_);
    const std::span<const float> values = voxels_.values();
    for (size_t i = 0; i < part_.size(); ++i) part_[i] = part_[i] > 0 ? values[i] / part_[i] : 0;
    parallelFor((kernels_.size() + kTogether - 1) / kTogether, [&](size_t n) {
        for (size_t i = n * kTogether; i < std::min((n + 1) * kTogether, kernels_.size()); ++i) {
            Kernel& kernel = kernels_[i];
            const Weights weights(kernel);
            Moments got;
            forBlocks(voxels_, weights, -kFarthest, kFarthest, [&](uint32_t block, glm::ivec3 origin) {
                weights.gather(&part_[block * kInBlock], origin, what != Follow::nothing, got);
            });
            kernel.mass *= float(got.mass);
            if (what != Follow::nothing && got.mass > 0) follow(shape_, got, what == Follow::place_and_axes, kernel);
        }
    });
}

void Mixture::keepMass() {
    std::erase_if(kernels_, [](const Kernel& k) { return !(k.mass > 0); });
    order();
    const double all = std::accumulate(kernels_.begin(), kernels_.end(), 0.0,
                                       [](double s, const Kernel& k) { return s + double(k.mass); });
    const double factor = all > 0 ? voxels_.sum() / all : 0;
    for (Kernel& kernel : kernels_) kernel.mass = float(double(kernel.mass) * factor);
}

} // namespace brume::volumes
