#include "tools/import/mixture.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "tools/import/parallel.h"

namespace brume::volumes {

namespace {

// A Gaussian ends where it has fallen to 0.3 %. A whole one is drawn, and the error is measured of whole ones.
constexpr double kReach = 3.4;                    // deviations
constexpr double kLeast = 0.35;                   // voxels; a narrower one falls between the voxels' centres
constexpr double kNarrowest = 0.7, kWidest = 1.6; // deviations in relation to what they begin with
constexpr double kStray = 0.75;                   // how far a Gaussian gets from its cell's middle; widths of the cell
constexpr size_t kMostTaps = 576;                 // of the widest one, at level kLevels - 1, and eight more at each end
constexpr size_t kTogether = 256;                 // kernels that one core takes at a time

double startDeviation(const Shape& shape, int level) {
    const double whole = shape.ratio * shape.of(level);
    return std::sqrt(std::max(whole * whole - kInterpolation, kLeast * kLeast));
}

// A Gaussian's weights at voxels along one axis. They add up to 1.
struct Taps {
    int first = 0, end = 0;           // voxels
    std::array<float, kMostTaps> w{}; // of voxel `first` and those after it

    Taps() = default;
    // `whole_blocks`: zeros up to the ends of the first and the last block.
    void set(double at, double deviation, bool whole_blocks) {
        const int lo = int(std::ceil(at - kReach * deviation)), hi = int(std::floor(at + kReach * deviation));
        first = whole_blocks ? (lo >> 3) * kSide : lo;
        end = whole_blocks ? ((hi >> 3) + 1) * kSide : hi + 1;
        const double fall = -0.5 / (deviation * deviation);
        double sum = 0;
        for (int i = first; i < end; ++i) {
            const double d = double(i) - at;
            const double value = i < lo || i > hi ? 0 : std::exp(fall * d * d);
            sum += value;
            w[size_t(i - first)] = float(value);
        }
        const auto scale = float(1 / sum);
        for (int i = first; i < end; ++i) w[size_t(i - first)] *= scale;
    }
};

struct Weights {
    Taps x, y, z;
    explicit Weights(const Kernel& k) {
        x.set(k.at.x, double(k.deviation), false);
        y.set(k.at.y, double(k.deviation), false);
        z.set(k.at.z, double(k.deviation), true);
    }
};

// Calls visit(block, its first voxel) for each block that the weights cover, of those with x from `from` to `to`.
template <class Visit>
void forBlocks(const Voxels& voxels, const Weights& weights, int from, int to, const Visit& visit) {
    for (int x = std::max(from, weights.x.first >> 3); x <= std::min(to, (weights.x.end - 1) >> 3); ++x)
        for (int y = weights.y.first >> 3; y <= (weights.y.end - 1) >> 3; ++y)
            for (int z = weights.z.first >> 3; z < weights.z.end >> 3; ++z)
                if (const uint32_t block = voxels.find({x, y, z}); block != kNoBlock)
                    visit(block, glm::ivec3(x, y, z) * kSide);
}

// What voxels have, weighted by a Gaussian: the sum, and its moments about the Gaussian's middle.
struct Moments {
    double mass = 0;
    glm::dvec3 first{0};
    double second = 0; // of all three axes
};

// Adds one block's part. `values`: of the block, whose first voxel is `origin`.
template <bool shapes>
void gather(const float* values, glm::ivec3 origin, const Weights& weights, glm::dvec3 at, Moments& out) {
    const int x_from = std::max(weights.x.first, origin.x), x_to = std::min(weights.x.end, origin.x + kSide);
    const int y_from = std::max(weights.y.first, origin.y), y_to = std::min(weights.y.end, origin.y + kSide);
    const float* const wz = &weights.z.w[size_t(origin.z - weights.z.first)];
    std::array<float, kSide * kSide> over_x{};
    for (int x = x_from; x < x_to; ++x) {
        const float wx = weights.x.w[size_t(x - weights.x.first)];
        std::array<float, kSide> over_y{};
        for (int y = y_from; y < y_to; ++y) {
            const float wy = weights.y.w[size_t(y - weights.y.first)];
            const float* const row = values + inBlock({x, y, origin.z});
            for (size_t z = 0; z < kSide; ++z) over_y[z] += wy * row[z];
            if constexpr (shapes) {
                float* const sum = &over_x[size_t(y - origin.y) * kSide];
                for (size_t z = 0; z < kSide; ++z) sum[z] += wx * row[z];
            }
        }
        float slice = 0;
        for (size_t z = 0; z < kSide; ++z) slice += wz[z] * over_y[z];
        const double part = double(wx * slice), d = double(x) - at.x;
        out.mass += part;
        out.first.x += d * part;
        out.second += d * d * part;
    }
    if constexpr (shapes) {
        std::array<float, kSide> over_xy{};
        for (int y = y_from; y < y_to; ++y) {
            const float wy = weights.y.w[size_t(y - weights.y.first)];
            const float* const row = &over_x[size_t(y - origin.y) * kSide];
            float slice = 0;
            for (size_t z = 0; z < kSide; ++z) {
                slice += wz[z] * row[z];
                over_xy[z] += wy * row[z];
            }
            const double part = double(wy * slice), d = double(y) - at.y;
            out.first.y += d * part;
            out.second += d * d * part;
        }
        for (int z = 0; z < kSide; ++z) {
            const double part = double(wz[z] * over_xy[size_t(z)]), d = double(origin.z + z) - at.z;
            out.first.z += d * part;
            out.second += d * d * part;
        }
    }
}

// Adds a Gaussian's part to one block.
void scatter(float* values, glm::ivec3 origin, const Weights& weights, float mass) {
    const int x_from = std::max(weights.x.first, origin.x), x_to = std::min(weights.x.end, origin.x + kSide);
    const int y_from = std::max(weights.y.first, origin.y), y_to = std::min(weights.y.end, origin.y + kSide);
    const float* const wz = &weights.z.w[size_t(origin.z - weights.z.first)];
    for (int x = x_from; x < x_to; ++x)
        for (int y = y_from; y < y_to; ++y) {
            const float w = mass * weights.x.w[size_t(x - weights.x.first)] * weights.y.w[size_t(y - weights.y.first)];
            float* const row = values + inBlock({x, y, origin.z});
            for (size_t z = 0; z < kSide; ++z) row[z] += w * wz[z];
        }
}

glm::dvec3 middleOf(const Shape& shape, int level, glm::ivec3 cell) {
    return (glm::dvec3(cell) + 0.5) * shape.of(level) - 0.5;
}

// Moves a Gaussian to the middle of the mass that it got, and widens it to that mass's spread, within bounds.
void follow(const Shape& shape, const Moments& got, Kernel& kernel) {
    const glm::dvec3 shift = got.first / got.mass;
    const double variance = (got.second / got.mass - glm::dot(shift, shift)) / 3;
    const glm::dvec3 middle = middleOf(shape, kernel.level, kernel.cell);
    const glm::dvec3 stray(kStray * shape.of(kernel.level));
    kernel.at = glm::clamp(kernel.at + shift, middle - stray, middle + stray);
    const double start = startDeviation(shape, kernel.level);
    kernel.deviation =
        float(std::clamp(std::sqrt(std::max(variance, 0.0)), std::max(kNarrowest * start, kLeast), kWidest * start));
}

} // namespace

double trueDeviation(const Kernel& kernel) {
    return std::sqrt(double(kernel.deviation) * double(kernel.deviation) + kInterpolation);
}

Kernel kernelOf(const Shape& shape, int level, glm::ivec3 cell, float mass) {
    return {middleOf(shape, level, cell), float(startDeviation(shape, level)), mass, cell, level};
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
void Mixture::addUp(std::vector<float>& out) const {
    out.assign(voxels_.values().size(), 0);
    const std::vector<uint32_t>& layers = voxels_.layers();
    parallelFor(layers.size() - 1, [&](size_t layer) {
        const int x = voxels_.blocks()[layers[layer]].x;
        for (int level = 0; level < kLevels; ++level) {
            const double width = shape_.of(level);
            const double reach = kReach * kWidest * startDeviation(shape_, level) + (kStray + 1) * width;
            const int first = int(std::floor((x * kSide - reach) / width));
            const int last = int(std::ceil(((x + 1) * kSide + reach) / width));
            const auto begin = kernels_.begin() + std::ptrdiff_t(begin_[size_t(level)]);
            const auto end = kernels_.begin() + std::ptrdiff_t(begin_[size_t(level) + 1]);
            const auto cell_x = [](const Kernel& k) { return k.cell.x; };
            for (auto k = std::ranges::lower_bound(begin, end, first, {}, cell_x); k != end && k->cell.x <= last; ++k) {
                const double far = kReach * double(k->deviation);
                if (k->at.x + far < x * kSide || k->at.x - far > (x + 1) * kSide - 1) continue;
                const Weights weights(*k);
                forBlocks(voxels_, weights, x, x, [&](uint32_t block, glm::ivec3 origin) {
                    scatter(&out[block * kInBlock], origin, weights, k->mass);
                });
            }
        }
    });
}

std::vector<float> Mixture::sums() const {
    std::vector<float> out;
    addUp(out);
    return out;
}

void Mixture::refine(int rounds, bool shapes) {
    std::vector<float> part; // of a voxel's value in what the Gaussians have there
    for (int round = 0; round < rounds; ++round) {
        addUp(part);
        const std::span<const float> values = voxels_.values();
        for (size_t i = 0; i < part.size(); ++i) part[i] = part[i] > 0 ? values[i] / part[i] : 0;
        parallelFor((kernels_.size() + kTogether - 1) / kTogether, [&](size_t n) {
            for (size_t i = n * kTogether; i < std::min((n + 1) * kTogether, kernels_.size()); ++i) {
                Kernel& kernel = kernels_[i];
                const Weights weights(kernel);
                Moments got;
                forBlocks(voxels_, weights, -kFarthest, kFarthest, [&](uint32_t block, glm::ivec3 origin) {
                    if (shapes)
                        gather<true>(&part[block * kInBlock], origin, weights, kernel.at, got);
                    else
                        gather<false>(&part[block * kInBlock], origin, weights, kernel.at, got);
                });
                kernel.mass *= float(got.mass);
                if (shapes && got.mass > 0) follow(shape_, got, kernel);
            }
        });
    }
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
