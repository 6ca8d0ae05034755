#include "common/metrics_ssim.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace brume {

namespace {

constexpr int kTaps = 2 * kSsimRadius + 1;

std::array<double, kTaps> window() {
    std::array<double, kTaps> out;
    double sum = 0;
    for (int i = 0; i < kTaps; ++i) sum += out[i] = std::exp(-(i - kSsimRadius) * (i - kSsimRadius) / (2 * 1.5 * 1.5));
    for (double& weight : out) weight /= sum;
    return out;
}

struct Moments {
    double a = 0, b = 0, aa = 0, bb = 0, ab = 0;
    void add(double weight, const Moments& m) {
        a += weight * m.a;
        b += weight * m.b;
        aa += weight * m.aa;
        bb += weight * m.bb;
        ab += weight * m.ab;
    }
};

double similarity(const Moments& m) {
    constexpr double kMean = 0.01 * 0.01, kVariance = 0.03 * 0.03;
    const double product = m.a * m.b, squares = m.a * m.a + m.b * m.b;
    return (2 * product + kMean) * (2 * (m.ab - product) + kVariance) /
           ((squares + kMean) * (m.aa + m.bb - squares + kVariance));
}

} // namespace

double ssim(int width, int height, std::span<const float> a, std::span<const float> b, std::span<const uint8_t> mask) {
    const std::array<double, kTaps> weights = window();
    double sum = 0;
    size_t windows = 0;
    std::vector<Moments> columns(width); // of one row of windows: weighted down the columns
    for (int y = kSsimRadius; y < height - kSsimRadius; ++y) {
        for (int x = 0; x < width; ++x) {
            columns[x] = {};
            for (int i = 0; i < kTaps; ++i) {
                const size_t at = size_t(y + i - kSsimRadius) * width + x;
                const double va = a[at], vb = b[at];
                columns[x].add(weights[i], {va, vb, va * va, vb * vb, va * vb});
            }
        }
        for (int x = kSsimRadius; x < width - kSsimRadius; ++x) {
            if (!mask.empty() && !mask[size_t(y) * width + x]) continue;
            Moments moments;
            for (int i = 0; i < kTaps; ++i) moments.add(weights[i], columns[x + i - kSsimRadius]);
            sum += similarity(moments);
            ++windows;
        }
    }
    return sum / static_cast<double>(windows); // 0 / 0 where there is none
}

std::vector<float> luma(std::span<const glm::vec3> srgb) {
    std::vector<float> out;
    out.reserve(srgb.size());
    for (const glm::vec3& pixel : srgb) out.push_back(glm::dot(pixel, glm::vec3(0.299f, 0.587f, 0.114f)));
    return out;
}

} // namespace brume
