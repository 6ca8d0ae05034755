#include "server/medium/shadow_resolution.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

#include "common/scene_limits.h"

namespace brume {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr size_t kMostSamples = 4096;
constexpr double kMostCells = 1 << 25; // texels of all planes: 179 MB, since four texels hold three planes' new values
constexpr uint32_t kMostTexels = uint32_t(limits::kShadowSize.hi),
                   kMostPlaneSteps = uint32_t(limits::kShadowSlices.hi) - 1;
// Fewer would save nothing, and the estimate is a mean: what an eye is close to errs more.
constexpr uint32_t kLeastTexels = 32, kLeastLayers = 18; // planes less one
// Bins of standard deviations, by the exponent and two bits of the float: four an octave.
constexpr int kBinShift = 21;
constexpr size_t kBins = 1024;

// Shares of the estimates that pictures show, from the measured errors of the shipped scenes (sweeps/shadow.toml): a
// line of sight crosses many texels, whose errors are independent, but follows planes.
constexpr double kTexelShare = 0.24, kPlaneShare = 0.6, kBodyShare = 0.24;
// Particles much smaller than a texel have none of their own: pictures then show the whole error.
double shown(double share, double error) { return (share + (1 - share) * error) * error; }

// RMS over the plane of the error of a sharpened (shared/sharpen.h) Gaussian exp(-x^2/2) between texels q apart, over
// sqrt(pi): the leading terms, 4 % within the integral for q <= 1.4.
double gaussianError(double q) { return std::min(q * q * (0.0456 + 0.0155 * q * q), 1.0); }
// Square root of the integrated square of the error of its depth erfc(z / sqrt 2) / 2 between planes q apart: the same.
double depthError(double q) { return std::min(q * q * (0.0143 + 0.0024 * q * q), 1.0); }

uint32_t ladder(double wanted, uint32_t step, uint32_t most) { // 4, 5, 6, 7, 8, 10, 12, 14, 16, 20 ... steps
    double units = std::ceil(wanted / step);
    if (units > 8) {
        const double octave = std::exp2(std::floor(std::log2(units)) - 2);
        units = std::ceil(units / octave) * octave;
    }
    return uint32_t(std::min(units * step, double(most)));
}

// The largest spacing from least to most, to 1 %, whose error is at most `wanted`; the least when there is none.
template <class Error>
double widest(const Error& error, double wanted, double least, double most) {
    if (error(most) <= wanted) return most;
    for (int i = 0; i < 9; ++i) {
        const double middle = std::sqrt(least * most);
        (error(middle) <= wanted ? least : most) = middle;
    }
    return least;
}

} // namespace

ShadowedMedium::ShadowedMedium(std::span<const gpu::Particle> particles, float falloff, const glm::mat3& basis) {
    const size_t stride = (particles.size() + kMostSamples - 1) / kMostSamples;
    std::array<Size, kBins> bins;
    glm::dvec3 first(0), second(0);
    double mass = 0, depths = 0, deviations = 0;
    for (size_t i = 0; i < particles.size(); i += stride) {
        const gpu::Particle& p = particles[i];
        const double s = 0.1 * double(p.scale) * double(falloff), a = std::sqrt(2 * kPi) * double(p.sigma_t) * s;
        if (!(a > 0) || !(s > 0)) continue;
        const double square = a * a * s * s * double(stride), m = 2 * kPi * a * s * s * double(stride);
        Size& bin = bins[std::bit_cast<uint32_t>(float(s)) >> kBinShift];
        bin.squares += square;
        bin.deviation += square * s;
        const glm::dvec3 at(p.centre * basis); // in light space
        mass += m;
        first += m * at;
        second += m * (at * at + s * s);
        depths += a;
        deviations += a * s;
    }
    if (!(mass > 0)) return;
    for (const Size& bin : bins)
        if (bin.squares > 0) sizes_.push_back({bin.deviation / bin.squares, bin.squares});
    const glm::dvec3 mean = first / mass;
    size_ = glm::sqrt(12.0 * glm::max(second / mass - mean * mean, glm::dvec3(1e-12)));
    depth_ = mass / (size_.x * size_.y);
    deviation_ = deviations / depths;
}

double ShadowedMedium::texelError(double spacing) const {
    if (sizes_.empty()) return 0;
    double random = 0;
    for (const Size& size : sizes_)
        random += kPi * size.squares * std::pow(shown(kTexelShare, gaussianError(spacing / size.deviation)), 2);
    random *= std::min(1.0, 1 / depth_) / (size_.x * size_.y);
    // The depth rises to 1, if it does, over half the width; where the rise begins and ends it turns within a standard
    // deviation.
    const double width = std::min(size_.x, size_.y), slope = 2 * std::min(depth_, 1.0) / width;
    const double turn = slope * slope / (2 * std::sqrt(kPi) * deviation_) * 4 / width;
    return std::sqrt(random + kBodyShare * kBodyShare * turn * std::pow(spacing, 4) / 720);
}

double ShadowedMedium::planeError(double spacing) const {
    if (sizes_.empty()) return 0;
    double random = 0;
    for (const Size& size : sizes_)
        random +=
            kPi * size.deviation * size.squares * std::pow(shown(kPlaneShare, depthError(spacing / size.deviation)), 2);
    random /= size_.x * size_.y * size_.z;
    // The extinction rises from none within a standard deviation, on the side where the light is.
    const double extinction = depth_ / size_.z, lit = std::min(size_.z, 1 / extinction);
    const double turn = extinction * extinction / (2 * std::sqrt(kPi) * deviation_) / lit;
    return std::sqrt(random + kBodyShare * kBodyShare * turn * std::pow(spacing, 4) / 720);
}

ShadowResolution shadowResolution(const RenderSettings& settings, const ShadowedMedium& medium, glm::vec3 extent) {
    // Errors grow with the square of a spacing, so for the fewest cells two thirds of the squared error go to the two
    // of texels.
    const double wanted = double(settings.shadow_error), width = double(std::max(extent.x, extent.y)),
                 depth = double(extent.z);
    double texel = widest([&](double h) { return medium.texelError(h); }, wanted * std::sqrt(2.0 / 3),
                          width / kMostTexels, width / kLeastTexels);
    double plane = widest([&](double h) { return medium.planeError(h); }, wanted * std::sqrt(1.0 / 3),
                          depth / kMostPlaneSteps, depth / kLeastLayers);

    ShadowResolution result;
    const bool follows = settings.shadow_size == 0 || settings.shadow_slices == 0;
    for (double cells = HUGE_VAL; follows && cells > kMostCells && texel < width; texel *= 1.1, plane *= 1.1) {
        for (int axis = 0; axis < 2; ++axis)
            result.texels[axis] = settings.shadow_size
                                      ? settings.shadow_size
                                      : std::max(ladder(double(extent[axis]) / texel, 8, kMostTexels), kLeastTexels);
        result.slices = settings.shadow_slices ? settings.shadow_slices : ladder(depth / plane, 6, kMostPlaneSteps) + 1;
        cells = double(result.texels.x) * result.texels.y * result.slices;
    }
    if (!follows) result.texels = glm::uvec2(settings.shadow_size), result.slices = settings.shadow_slices;
    const double across = double(std::max(extent.x / float(result.texels.x), extent.y / float(result.texels.y)));
    result.error = std::hypot(medium.texelError(across), medium.planeError(depth / (result.slices - 1)));
    return result;
}

} // namespace brume
