#include "common/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "common/metrics_flip.h"
#include "common/metrics_ssim.h"

namespace brume {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

void requireSameSize(const RadianceImage& a, const RadianceImage& b) {
    const size_t pixels = size_t(a.width) * a.height;
    if (a.width != b.width || a.height != b.height || a.radiance.size() != pixels || b.radiance.size() != pixels ||
        a.transmittance.size() != pixels || b.transmittance.size() != pixels)
        throw std::invalid_argument(fmt::format(
            "pictures to compare: {} x {} ({} and {} values) against {} x {} ({} and {})", a.width, a.height,
            a.radiance.size(), a.transmittance.size(), b.width, b.height, b.radiance.size(), b.transmittance.size()));
}

bool isFinite(const RadianceImage& image, size_t i) {
    const glm::vec3 v = image.radiance[i];
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z) && std::isfinite(image.transmittance[i]);
}

// Counts pixels that are not finite in either picture, and keeps the first of them.
void findNotFinite(const RadianceImage& value, const RadianceImage& reference, Errors& errors) {
    for (size_t i = 0; i < value.radiance.size(); ++i) {
        if (isFinite(value, i) && isFinite(reference, i)) continue;
        if (errors.not_finite++ == 0)
            errors.worst = {static_cast<int>(i % value.width), static_cast<int>(i / value.width), kNaN,
                            value.radiance[i], reference.radiance[i]};
    }
}

// The pixels that are compared.
std::vector<size_t> listed(size_t pixels, std::span<const uint8_t> mask) {
    std::vector<size_t> out;
    for (size_t i = 0; i < pixels; ++i)
        if (mask.empty() || mask[i]) out.push_back(i);
    return out;
}

void addRadianceErrors(const RadianceImage& value, const RadianceImage& reference, std::span<const size_t> pixels,
                       Errors& errors) {
    float brightest = 0;
    for (const size_t i : pixels)
        for (int c = 0; c < 3; ++c) brightest = std::max(brightest, reference.radiance[i][c]);
    double squares = 0, reference_squares = 0, signed_sum = 0, rel_sum = 0, worst = -1;
    size_t bright = 0;
    for (const size_t i : pixels) {
        for (int c = 0; c < 3; ++c) {
            const double r = reference.radiance[i][c], difference = value.radiance[i][c] - r;
            const double relative = difference / (r + 0.01);
            rel_sum += relative * relative;
            if (std::abs(relative) > worst) {
                worst = std::abs(relative);
                errors.worst = {static_cast<int>(i % value.width), static_cast<int>(i / value.width), worst,
                                value.radiance[i], reference.radiance[i]};
            }
            if (r <= 1e-3 * brightest) continue;
            squares += difference * difference;
            reference_squares += r * r;
            signed_sum += difference / r;
            ++bright;
        }
    }
    errors.rel_mse = rel_sum / (3.0 * static_cast<double>(pixels.size()));
    errors.relative_rmse = std::sqrt(squares / reference_squares); // 0 / 0 where the reference is black
    errors.bias = signed_sum / static_cast<double>(bright);
}

void addDisplayedErrors(const RadianceImage& value, const RadianceImage& reference, const DisplaySettings& display,
                        std::span<const size_t> pixels, std::span<const uint8_t> mask, Errors& errors) {
    std::vector<glm::vec3> v = displayedLight(value, display), r = displayedLight(reference, display);
    const std::vector<float> map = flipMap(value.width, value.height, v, r);
    std::ranges::transform(v, v.begin(), srgbFromLinear);
    std::ranges::transform(r, r.begin(), srgbFromLinear);
    double squares = 0, flip = 0;
    for (const size_t i : pixels) {
        const glm::dvec3 difference = glm::dvec3(v[i]) - glm::dvec3(r[i]);
        squares += glm::dot(difference, difference);
        flip += map[i];
    }
    errors.psnr = -10 * std::log10(squares / (3.0 * static_cast<double>(pixels.size())));
    errors.flip = flip / static_cast<double>(pixels.size());
    errors.ssim = ssim(value.width, value.height, luma(v), luma(r), mask);
}

// NaN when a frame is not finite.
double meanChange(std::span<const RadianceImage> frames, const DisplaySettings& display) {
    double sum = 0;
    for (size_t frame = 1; frame < frames.size(); ++frame) {
        const RadianceImage &now = frames[frame], &before = frames[frame - 1];
        requireSameSize(now, before);
        Errors found;
        findNotFinite(now, before, found);
        if (found.not_finite > 0) return kNaN;
        const std::vector<float> map = flipMap(now, before, display);
        sum += std::accumulate(map.begin(), map.end(), 0.0) / static_cast<double>(map.size());
    }
    return sum / static_cast<double>(frames.size() - 1);
}

} // namespace

Errors compare(const RadianceImage& value, const RadianceImage& reference, const DisplaySettings& display,
               std::span<const uint8_t> mask) {
    requireSameSize(value, reference);
    if (!mask.empty() && mask.size() != value.radiance.size())
        throw std::invalid_argument(
            fmt::format("a mask of {} values for {} pixels", mask.size(), value.radiance.size()));
    const std::vector<size_t> pixels = listed(value.radiance.size(), mask);
    Errors errors;
    errors.pixels = pixels.size();
    findNotFinite(value, reference, errors);
    if (!errors.comparable()) {
        errors.relative_rmse = errors.bias = errors.rel_mse = errors.psnr = errors.ssim = errors.flip =
            errors.worst.error = kNaN;
        return errors;
    }
    addRadianceErrors(value, reference, pixels, errors);
    addDisplayedErrors(value, reference, display, pixels, mask, errors);
    return errors;
}

std::string describe(const Errors& errors) {
    if (errors.not_finite > 0)
        return fmt::format("not comparable: {} pixels are not finite, the first at ({}, {})", errors.not_finite,
                           errors.worst.x, errors.worst.y);
    if (errors.pixels == 0) return "not comparable: the mask leaves no pixel";
    return fmt::format("relative RMSE {:.3g} %, bias {:+.3g} %, relMSE {:.3g}, PSNR {:.2f} dB, SSIM {:.5f}, FLIP "
                       "{:.4f}, worst {:.3g} % at ({}, {}), {} pixels",
                       100 * errors.relative_rmse, 100 * errors.bias, errors.rel_mse, errors.psnr, errors.ssim,
                       errors.flip, 100 * errors.worst.error, errors.worst.x, errors.worst.y, errors.pixels);
}

double temporalFlip(std::span<const RadianceImage> frames, std::span<const RadianceImage> reference_frames,
                    const DisplaySettings& display) {
    if (frames.size() < 2 || frames.size() != reference_frames.size())
        throw std::invalid_argument(
            fmt::format("frames over time: {} against {}; expected two or more, and as many of the reference",
                        frames.size(), reference_frames.size()));
    requireSameSize(frames[0], reference_frames[0]);
    return meanChange(frames, display) - meanChange(reference_frames, display);
}

} // namespace brume
