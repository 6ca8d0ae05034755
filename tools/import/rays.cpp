#include "tools/import/rays.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/random.h"
#include "tools/import/parallel.h"
#include "tools/import/path.h"

namespace brume::volumes {

namespace {

constexpr double kMargin = 4;   // voxels around the medium that rays go through, too
constexpr double kFarOff = 6.5; // deviations; a Gaussian has 1e-9 there

} // namespace

Rays::Rays(const Voxels& voxels, double per_value, int side, int random, uint64_t seed)
    : per_value_(per_value), side_(side) {
    const glm::dvec3 middle = glm::dvec3(voxels.lo() + voxels.hi()) / 2.0;
    const glm::dvec3 half = glm::dvec3(voxels.hi() - voxels.lo()) / 2.0 + kMargin;
    for (int i = 0; i < 3 + random; ++i) {
        Random numbers(seed, uint64_t(i));
        Bundle& bundle = bundles_.emplace_back();
        bundle.toward = i < 3 ? glm::dvec3(i == 0, i == 1, i == 2) : glm::normalize(glm::dvec3(numbers.direction()));
        bundle.u = acrossOf(bundle.toward);
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
    for (const Kernel& kernel : kernels) {
        // The Gaussian's sum along the rays is a Gaussian of u and v, here in steps between rays. In a row of one v it
        // has the variance `along_u`, and its middle lies `tilt` (v - v of the middle) beside u of the middle.
        const glm::dmat3 spread = trueSpread(kernel) / (bundle.step * bundle.step);
        const glm::dvec3 of_u = spread * bundle.u;
        const double uu = glm::dot(bundle.u, of_u), uv = glm::dot(bundle.v, of_u),
                     vv = glm::dot(bundle.v, spread * bundle.v);
        const double tilt = uv / vv, along_u = uu - tilt * uv;
        const double u = (glm::dot(kernel.at, bundle.u) - bundle.u0) / bundle.step;
        const double v = (glm::dot(kernel.at, bundle.v) - bundle.v0) / bundle.step, far = kFarOff * std::sqrt(vv);
        const int v_from = std::max(int(std::ceil(v - far)), 0), v_to = std::min(int(std::floor(v + far)), side_ - 1);
        const double peak = per_value_ * double(kernel.mass) /
                            (2 * std::numbers::pi * bundle.step * bundle.step * std::sqrt(vv * along_u));
        const double fall = std::exp(-1 / along_u); // of the ratio of neighbours
        for (int j = v_from; j <= v_to; ++j) {
            const double off = j - v, middle = u + tilt * off;
            const double half = std::sqrt(std::max((kFarOff * kFarOff - off * off / vv) * along_u, 0.0));
            const int u_from = std::max(int(std::ceil(middle - half)), 0);
            const int u_to = std::min(int(std::floor(middle + half)), side_ - 1);
            const double d = u_from - middle;
            double value = peak * std::exp(-0.5 * (off * off / vv + d * d / along_u));
            double ratio = std::exp(-(d + 0.5) / along_u);
            for (int i = u_from; i <= u_to; ++i, value *= ratio, ratio *= fall)
                out[size_t(j) * size_t(side_) + size_t(i)] += value;
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
    return {std::sqrt(all.depth / all.depth_of), std::sqrt(all.opacity / all.opacity_of), 0};
}

} // namespace brume::volumes
