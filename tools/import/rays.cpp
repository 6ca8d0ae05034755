#include "tools/import/rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/random.h"
#include "tools/import/parallel.h"

namespace brume::volumes {

namespace {

constexpr double kMargin = 4;   // voxels around the medium that rays go through, too
constexpr double kFarOff = 6.5; // deviations; a Gaussian has 1e-9 there

// The eight voxels around a cell between voxels' centres, of the blocks that a run of cells needs.
class Corners {
public:
    explicit Corners(const Voxels& voxels) : voxels_(voxels) {}

    // False: all are 0.
    bool of(glm::ivec3 cell, std::array<double, 8>& out) {
        if (const glm::ivec3 block = cell >> 3; block != block_) {
            block_ = block;
            some_ = false;
            for (int n = 0; n < 8; ++n) {
                blocks_[size_t(n)] = voxels_.find(block + glm::ivec3(n & 1, n >> 1 & 1, n >> 2));
                some_ = some_ || blocks_[size_t(n)] != kNoBlock;
            }
        }
        if (!some_) return false;
        for (int n = 0; n < 8; ++n) {
            const glm::ivec3 in = (cell & 7) + glm::ivec3(n & 1, n >> 1 & 1, n >> 2);
            const glm::ivec3 over = in >> 3;
            const uint32_t block = blocks_[static_cast<unsigned>(over.x + 2 * over.y + 4 * over.z)];
            out[size_t(n)] = block == kNoBlock ? 0 : double(voxels_.values()[block * kInBlock + inBlock(in)]);
        }
        return true;
    }

private:
    const Voxels& voxels_;
    glm::ivec3 block_{std::numeric_limits<int>::max()};
    std::array<uint32_t, 8> blocks_{};
    bool some_ = false;
};

double interpolated(const std::array<double, 8>& c, glm::dvec3 part) {
    const glm::dvec3 rest = 1.0 - part;
    return rest.z * (rest.y * (rest.x * c[0] + part.x * c[1]) + part.y * (rest.x * c[2] + part.x * c[3])) +
           part.z * (rest.y * (rest.x * c[4] + part.x * c[5]) + part.y * (rest.x * c[6] + part.x * c[7]));
}

// A vector of unit length that is perpendicular to a direction.
glm::dvec3 across(glm::dvec3 toward) {
    const glm::dvec3 other = std::abs(toward.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    return glm::normalize(glm::cross(toward, other));
}

} // namespace

double integralAlong(const Voxels& voxels, glm::dvec3 through, glm::dvec3 toward) {
    // The part of the line within the box of all cells that have a corner above 0.
    double t = -std::numeric_limits<double>::max(), end = -t;
    const glm::dvec3 lo(voxels.lo() - 1), hi(voxels.hi() + 1);
    for (int axis = 0; axis < 3; ++axis) {
        if (toward[axis] == 0) {
            if (through[axis] < lo[axis] || through[axis] >= hi[axis]) return 0;
            continue;
        }
        const double a = (lo[axis] - through[axis]) / toward[axis], b = (hi[axis] - through[axis]) / toward[axis];
        t = std::max(t, std::min(a, b));
        end = std::min(end, std::max(a, b));
    }
    if (!(t < end)) return 0;
    // From cell to cell. In each the values along the line are a cubic, which Simpson's rule integrates exactly.
    glm::ivec3 cell, step;
    glm::dvec3 next, between;
    for (int axis = 0; axis < 3; ++axis) {
        const double at = std::clamp(through[axis] + t * toward[axis], lo[axis], hi[axis] - 1e-9);
        cell[axis] = int(std::floor(at));
        step[axis] = toward[axis] > 0 ? 1 : -1;
        between[axis] = toward[axis] == 0 ? std::numeric_limits<double>::max() : 1 / std::abs(toward[axis]);
        next[axis] = toward[axis] == 0 ? std::numeric_limits<double>::max()
                                       : (double(cell[axis] + (toward[axis] > 0)) - through[axis]) / toward[axis];
    }
    Corners corners(voxels);
    std::array<double, 8> values{};
    double sum = 0;
    while (t < end) {
        const int axis = next.x < next.y ? (next.x < next.z ? 0 : 2) : (next.y < next.z ? 1 : 2);
        const double leave = std::min(next[axis], end);
        if (leave > t && corners.of(cell, values)) {
            const auto value = [&](double s) { return interpolated(values, through + s * toward - glm::dvec3(cell)); };
            sum += (leave - t) / 6 * (value(t) + 4 * value((t + leave) / 2) + value(leave));
        }
        t = std::max(t, leave);
        cell[axis] += step[axis];
        next[axis] += between[axis];
    }
    return sum;
}

Rays::Rays(const Voxels& voxels, double per_value, int side, int random, uint64_t seed)
    : per_value_(per_value), side_(side) {
    const glm::dvec3 middle = glm::dvec3(voxels.lo() + voxels.hi()) / 2.0;
    const glm::dvec3 half = glm::dvec3(voxels.hi() - voxels.lo()) / 2.0 + kMargin;
    for (int i = 0; i < 3 + random; ++i) {
        Random numbers(seed, uint64_t(i));
        Bundle& bundle = bundles_.emplace_back();
        bundle.toward = i < 3 ? glm::dvec3(i == 0, i == 1, i == 2) : glm::normalize(glm::dvec3(numbers.direction()));
        bundle.u = across(bundle.toward);
        bundle.v = glm::cross(bundle.toward, bundle.u);
        // Wide enough for the box, and a random part of the distance between rays beside its edge.
        const double u_half = glm::dot(half, glm::abs(bundle.u)), v_half = glm::dot(half, glm::abs(bundle.v));
        bundle.step = 2 * std::max(u_half, v_half) / side;
        bundle.u0 = glm::dot(middle, bundle.u) - bundle.step * side / 2 + bundle.step * double(numbers.uniform());
        bundle.v0 = glm::dot(middle, bundle.v) - bundle.step * side / 2 + bundle.step * double(numbers.uniform());
        bundle.depth.resize(size_t(side) * size_t(side));
        const double along = glm::dot(middle, bundle.toward);
        parallelFor(size_t(side), [&](size_t row) {
            for (size_t column = 0; column < size_t(side); ++column) {
                const glm::dvec3 through = bundle.u * (bundle.u0 + bundle.step * double(column)) +
                                           bundle.v * (bundle.v0 + bundle.step * double(row)) + bundle.toward * along;
                bundle.depth[row * size_t(side) + column] = per_value * integralAlong(voxels, through, bundle.toward);
            }
        });
    }
}

std::vector<double> Rays::depthsOf(const Bundle& bundle, std::span<const Kernel> kernels) const {
    std::vector<double> out(bundle.depth.size(), 0);
    std::vector<double> along_u(static_cast<size_t>(side_));
    for (const Kernel& kernel : kernels) {
        const double deviation = trueDeviation(kernel), reach = kFarOff * deviation;
        const double u = (glm::dot(kernel.at, bundle.u) - bundle.u0) / bundle.step;
        const double v = (glm::dot(kernel.at, bundle.v) - bundle.v0) / bundle.step, far = reach / bundle.step;
        const int u_from = std::max(int(std::ceil(u - far)), 0), u_to = std::min(int(std::floor(u + far)), side_ - 1);
        const int v_from = std::max(int(std::ceil(v - far)), 0), v_to = std::min(int(std::floor(v + far)), side_ - 1);
        const double fall = -0.5 * bundle.step * bundle.step / (deviation * deviation);
        const double peak = per_value_ * double(kernel.mass) / (2 * std::numbers::pi * deviation * deviation);
        for (int i = u_from; i <= u_to; ++i) along_u[size_t(i)] = peak * std::exp(fall * (i - u) * (i - u));
        for (int j = v_from; j <= v_to; ++j) {
            const double w = std::exp(fall * (j - v) * (j - v));
            for (int i = u_from; i <= u_to; ++i) out[size_t(j) * size_t(side_) + size_t(i)] += w * along_u[size_t(i)];
        }
    }
    return out;
}

SeenError Rays::errorOf(std::span<const Kernel> kernels) const {
    struct Sums {
        double depth = 0, depth_of = 0, opacity = 0, opacity_of = 0;
    };
    std::vector<Sums> sums(bundles_.size());
    parallelFor(bundles_.size(), [&](size_t n) {
        const std::vector<double> got = depthsOf(bundles_[n], kernels);
        for (size_t i = 0; i < got.size(); ++i) {
            const double depth = bundles_[n].depth[i], off = got[i] - depth;
            const double stopped = -std::expm1(-depth), stopped_off = -std::expm1(-got[i]) - stopped;
            sums[n].depth += off * off;
            sums[n].depth_of += depth * depth;
            sums[n].opacity += stopped_off * stopped_off;
            sums[n].opacity_of += stopped * stopped;
        }
    });
    Sums all;
    for (const Sums& s : sums)
        all = {all.depth + s.depth, all.depth_of + s.depth_of, all.opacity + s.opacity, all.opacity_of + s.opacity_of};
    return {std::sqrt(all.depth / all.depth_of), std::sqrt(all.opacity / all.opacity_of)};
}

} // namespace brume::volumes
