#include "server/error/error_window.h"

#include <algorithm>
#include <cmath>

namespace brume {
namespace {

constexpr float kDark = 1e-3f; // part of the largest channel below which a channel is left out
// Standard deviations of the logarithm of the error on either side of it. Normal errors would need 2. Errors of pixels
// are not: a few large ones make the estimate's own deviation too small.
constexpr double kDeviations = 2.7;

} // namespace

void ErrorWindow::add(std::span<const PixelError> pixels, double law, Time now) {
    for (const PixelError& pixel : pixels) pixels_.push_back({pixel, law, now});
    while (!pixels_.empty() && (pixels_.size() > kMost || now - pixels_.front().at > kKept)) pixels_.pop_front();
}

// The ratio of two sums over random pixels, and its deviation by the delta method.
ErrorEstimate ErrorWindow::estimate(Time now, size_t newest) const {
    ErrorEstimate out;
    const size_t first = pixels_.size() - std::min(newest, pixels_.size());
    const auto each = [&](const auto& visit) { // calls it for each pixel that counts
        for (size_t i = first; i < pixels_.size(); ++i)
            if (now - pixels_[i].at <= kKept) visit(pixels_[i]);
    };
    float largest = 0;
    each([&](const Kept& one) {
        largest = std::max({largest, one.pixel.reference.r, one.pixel.reference.g, one.pixel.reference.b});
    });
    double errors = 0, sizes = 0, laws = 0, bias = 0;
    size_t channels = 0;
    const auto sums = [&](const Kept& one, double& error, double& size) {
        error = size = 0;
        for (int c = 0; c < 3; ++c) {
            const double r = double(one.pixel.reference[c]), apart = double(one.pixel.value[c]) - r;
            if (r <= double(kDark * largest)) continue;
            error += apart * apart, size += r * r;
            bias += apart / r, ++channels;
        }
    };
    each([&](const Kept& one) {
        double error, size;
        sums(one, error, size);
        errors += error, sizes += size, laws += one.law * one.law * size;
        ++out.pixels;
    });
    if (!(sizes > 0)) return {};
    const double mean = errors / sizes, n = double(out.pixels);
    out.rmse = std::sqrt(mean);
    out.law = std::sqrt(laws / sizes);
    out.bias = bias / double(std::max<size_t>(channels, 1));
    double squares = 0;
    each([&](const Kept& one) {
        double error, size;
        sums(one, error, size);
        squares += (error - mean * size) * (error - mean * size);
    });
    const double deviation = std::sqrt(squares * n / std::max(n - 1, 1.0)) / sizes; // standard deviation of `mean`
    const double wide = mean > 0 ? std::exp(kDeviations * deviation / (2 * mean)) : 1;
    out.low = out.rmse / wide, out.high = out.rmse * wide;
    return out;
}

} // namespace brume
