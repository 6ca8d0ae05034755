#include "tools/bench/motion_errors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "common/metrics.h"
#include "tools/bench/error.h"

namespace brume::bench {
namespace {

constexpr double kStill = 1e-12; // part of the reference's squares below which its changes are rounding

struct Frame {
    std::vector<double> seen, exact; // luminance
    std::vector<uint8_t> counts;
};

double luminance(const glm::vec3& c) { return 0.2126 * double(c.r) + 0.7152 * double(c.g) + 0.0722 * double(c.b); }

Frame frameOf(const RadianceImage& seen, const RadianceImage& exact) {
    Frame frame{{}, {}, comparedPixels(exact)};
    for (const glm::vec3& pixel : seen.radiance) frame.seen.push_back(luminance(pixel));
    for (const glm::vec3& pixel : exact.radiance) frame.exact.push_back(luminance(pixel));
    return frame;
}

double flickerOf(const std::vector<Frame>& frames) {
    double bends = 0, squares = 0;
    for (size_t i = 2; i < frames.size(); ++i) {
        const Frame &a = frames[i - 2], &b = frames[i - 1], &c = frames[i];
        for (size_t p = 0; p < c.counts.size(); ++p) {
            if (!(a.counts[p] && b.counts[p] && c.counts[p])) continue;
            const double bend = (a.seen[p] - a.exact[p]) - 2 * (b.seen[p] - b.exact[p]) + (c.seen[p] - c.exact[p]);
            bends += bend * bend, squares += c.exact[p] * c.exact[p];
        }
    }
    return squares > 0 ? std::sqrt(bends / squares) : std::numeric_limits<double>::quiet_NaN();
}

// Calls `add`(a pixel, the frame before, the frame) for all that count in both.
template <class Add>
void forPairs(std::span<const Frame> frames, Add add) {
    for (size_t i = 1; i < frames.size(); ++i)
        for (size_t p = 0; p < frames[i].counts.size(); ++p)
            if (frames[i - 1].counts[p] && frames[i].counts[p]) add(p, frames[i - 1], frames[i]);
}

void setLag(const std::vector<Frame>& frames, MotionErrors& out) {
    double rr = 0, dd = 0, ee = 0, rd = 0, re = 0, de = 0; // sums of products
    for (size_t i = 2; i < frames.size(); ++i) {
        const Frame &first = frames[i - 2], &before = frames[i - 1], &now = frames[i];
        for (size_t p = 0; p < now.counts.size(); ++p) {
            if (!(first.counts[p] && before.counts[p] && now.counts[p])) continue;
            const double r = now.exact[p] - before.exact[p], d = (before.exact[p] - first.exact[p]) - r,
                         e = (now.seen[p] - before.seen[p]) - r;
            rr += r * r, dd += d * d, ee += e * e, rd += r * d, re += r * e, de += d * e;
        }
    }
    const double change = dd - rd * rd / rr, by_change = de - rd * re / rr; // what r does not explain
    if (!(change > kStill * rr)) {
        out.lag = std::numeric_limits<double>::quiet_NaN();
        return;
    }
    const double l = by_change / change, g = 1 + (re - l * rd) / rr, left = ee - re * re / rr;
    out.lag = l / g;
    out.ghost = left > kStill * ee ? l * by_change / left : 0;
}

} // namespace

Spread spreadOf(std::span<const double> values) {
    const auto n = double(values.size());
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
    double squares = 0;
    for (const double value : values) squares += (value - mean) * (value - mean);
    return {mean, std::sqrt(squares / n)};
}

MotionErrors motionErrors(std::span<const RadianceImage> seen, std::span<const RadianceImage> reference,
                          const DisplaySettings& display) {
    if (seen.size() < 3 || seen.size() != reference.size())
        throw std::invalid_argument("frames in motion: expected three or more, and as many of the reference");
    MotionErrors out;
    std::vector<Frame> frames;
    for (size_t i = 0; i < seen.size(); ++i) {
        out.rmse.push_back(mediumError(seen[i], reference[i], display).medium.relative_rmse);
        frames.push_back(frameOf(seen[i], reference[i]));
    }
    const Spread spread = spreadOf(out.rmse);
    out.mean = spread.mean, out.deviation = spread.deviation;
    out.greatest = size_t(std::ranges::max_element(out.rmse) - out.rmse.begin());
    out.flicker = flickerOf(frames);
    out.temporal_flip = temporalFlip(seen, reference, display);
    setLag(frames, out);
    for (size_t i = 1; i < frames.size(); ++i) {
        double now[2] = {}, before[2] = {}; // seen, exact
        forPairs(std::span(frames).subspan(i - 1, 2), [&](size_t p, const Frame& a, const Frame& b) {
            before[0] += a.seen[p], before[1] += a.exact[p], now[0] += b.seen[p], now[1] += b.exact[p];
        });
        const double ratio = (now[0] / now[1]) / (before[0] / before[1]);
        out.ratio.least = i == 1 ? ratio : std::min(out.ratio.least, ratio);
        out.ratio.greatest = i == 1 ? ratio : std::max(out.ratio.greatest, ratio);
    }
    return out;
}

} // namespace brume::bench
