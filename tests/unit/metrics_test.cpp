// Error metrics against numbers worked out by hand, against the authors' program (FLIP), and by their laws.
#include "common/metrics.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "common/metrics_flip.h"
#include "common/metrics_ssim.h"

namespace brume::metrics_test {
namespace {

constexpr DisplaySettings kLinear{.exposure = 1, .filmic = false};
constexpr float kInfinity = std::numeric_limits<float>::infinity(), kNaN = std::numeric_limits<float>::quiet_NaN();

RadianceImage uniform(int width, int height, glm::vec3 radiance) {
    const size_t pixels = size_t(width) * height;
    return {width, height, std::vector<glm::vec3>(pixels, radiance), std::vector<float>(pixels, 0.5f)};
}

// Radiance in [0.1, 0.9] without a pattern.
RadianceImage noise(int width, int height, uint32_t seed) {
    RadianceImage image = uniform(width, height, glm::vec3(0));
    for (auto& pixel : image.radiance)
        for (int c = 0; c < 3; ++c) {
            seed = seed * 1664525u + 1013904223u;
            pixel[c] = 0.1f + 0.8f * static_cast<float>(seed >> 8) * 0x1p-24f;
        }
    return image;
}

double mean(const std::vector<float>& map) {
    double sum = 0;
    for (const float v : map) sum += v;
    return sum / static_cast<double>(map.size());
}

double uniformFlip(glm::vec3 value, glm::vec3 reference) {
    const std::vector<glm::vec3> v(1024, value), r(1024, reference);
    return mean(flipMap(32, 32, v, r));
}

// --- laws ---

TEST(Metrics, EqualPicturesHaveNoError) {
    const RadianceImage image = noise(40, 30, 1);
    const Errors errors = compare(image, image, {});
    EXPECT_TRUE(errors.comparable());
    EXPECT_EQ(errors.pixels, 1200u);
    EXPECT_EQ(errors.relative_rmse, 0);
    EXPECT_EQ(errors.bias, 0);
    EXPECT_EQ(errors.rel_mse, 0);
    EXPECT_EQ(errors.psnr, std::numeric_limits<double>::infinity());
    EXPECT_NEAR(errors.ssim, 1, 1e-12); // double rounding
    EXPECT_EQ(errors.flip, 0);
    EXPECT_EQ(errors.worst.error, 0);
}

TEST(Metrics, WhatASymmetricMetricSeesDoesNotDependOnTheOrder) {
    const RadianceImage a = noise(40, 30, 1), b = noise(40, 30, 2);
    const Errors one = compare(a, b, {}), other = compare(b, a, {});
    EXPECT_EQ(one.psnr, other.psnr);
    EXPECT_NEAR(one.ssim, other.ssim, 1e-12); // double rounding
    EXPECT_EQ(one.flip, other.flip);
    EXPECT_GT(one.flip, 0.05);
    EXPECT_NE(one.bias, other.bias);
}

TEST(Metrics, RelativeErrorsDoNotDependOnTheUnitOfRadiance) {
    RadianceImage a = noise(20, 20, 1), b = noise(20, 20, 2);
    const Errors one = compare(a, b, kLinear);
    for (auto* image : {&a, &b})
        for (auto& pixel : image->radiance) pixel *= 1024.0f; // exact
    const Errors large = compare(a, b, {.exposure = 1.0f / 1024, .filmic = false});
    EXPECT_EQ(one.relative_rmse, large.relative_rmse);
    EXPECT_EQ(one.bias, large.bias);
    EXPECT_EQ(one.flip, large.flip);
    EXPECT_EQ(one.ssim, large.ssim);
    EXPECT_NE(one.rel_mse, large.rel_mse); // its 0.01 has a unit
}

// --- radiance, by hand ---

TEST(Metrics, RadianceErrorsByHand) {
    // Channels: reference 1 against 1.1, 0.5 against 0.4, and 0.0005, which is not bright, against 0.0105.
    const RadianceImage r = uniform(16, 16, {1, 0.5f, 0.0005f}), v = uniform(16, 16, {1.1f, 0.4f, 0.0105f});
    const Errors errors = compare(v, r, kLinear);
    // float32 inputs: 1.1 is 2e-8 off, its difference from 1 so 2e-7 relative.
    EXPECT_NEAR(errors.relative_rmse, std::sqrt(0.02 / 1.25), 1e-6 * 0.13);
    EXPECT_NEAR(errors.bias, (0.1 - 0.2) / 2, 1e-6);
    EXPECT_NEAR(errors.rel_mse, (std::pow(0.1 / 1.01, 2) + std::pow(0.1 / 0.51, 2) + std::pow(0.01 / 0.0105, 2)) / 3,
                1e-6);
    EXPECT_NEAR(errors.worst.error, 0.01 / 0.0105, 1e-6);
}

TEST(Metrics, ABlackReferenceHasNoRelativeError) {
    const RadianceImage black = uniform(16, 16, glm::vec3(0));
    const Errors errors = compare(uniform(16, 16, glm::vec3(0.1f)), black, kLinear);
    EXPECT_TRUE(errors.comparable());
    EXPECT_TRUE(std::isnan(errors.relative_rmse) && std::isnan(errors.bias));
    EXPECT_NEAR(errors.rel_mse, 100, 1e-4);
}

TEST(Metrics, OneWrongPixelIsTheWorst) {
    const RadianceImage r = noise(40, 30, 3);
    RadianceImage v = r;
    v.radiance[17 * 40 + 29].y += 0.05f;
    const Errors errors = compare(v, r, {});
    EXPECT_EQ(errors.worst.x, 29);
    EXPECT_EQ(errors.worst.y, 17);
    EXPECT_EQ(errors.worst.value, v.radiance[17 * 40 + 29]);
    EXPECT_EQ(errors.worst.reference, r.radiance[17 * 40 + 29]);
    EXPECT_NEAR(errors.worst.error, 0.05 / (r.radiance[17 * 40 + 29].y + 0.01), 1e-6); // float32 of 0.9 and 0.05
    EXPECT_GT(errors.flip, 0);
    EXPECT_LT(errors.ssim, 1);
}

// --- masks ---

TEST(Metrics, AMaskOfEverythingIsNoMask) {
    const RadianceImage a = noise(30, 30, 1), b = noise(30, 30, 2);
    const std::vector<uint8_t> all(900, 1);
    const Errors with = compare(a, b, {}, all), without = compare(a, b, {});
    EXPECT_EQ(describe(with), describe(without));
    EXPECT_EQ(with.flip, without.flip);
    EXPECT_EQ(with.ssim, without.ssim);
}

TEST(Metrics, WhatIsFarOutsideTheMaskDoesNotCount) {
    const RadianceImage r = noise(80, 30, 1);
    RadianceImage v = noise(80, 30, 2), far = v;
    std::vector<uint8_t> mask(2400, 0);
    for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 80; ++x) {
            mask[y * 80 + x] = x < 40;
            if (x >= 60) far.radiance[y * 80 + x] = {50, 0, 100}; // farther than any filter reaches
        }
    const Errors near = compare(v, r, {}, mask), changed = compare(far, r, {}, mask), all = compare(far, r, {});
    EXPECT_EQ(near.pixels, 40u * 30);
    EXPECT_EQ(describe(near), describe(changed));
    EXPECT_EQ(near.relative_rmse, changed.relative_rmse);
    EXPECT_EQ(near.flip, changed.flip);
    EXPECT_EQ(near.ssim, changed.ssim);
    EXPECT_GT(all.relative_rmse, 10 * near.relative_rmse);
    EXPECT_GT(all.flip, near.flip);
}

TEST(Metrics, AMaskOfNothingIsSaid) {
    const RadianceImage a = noise(16, 16, 1);
    const Errors errors = compare(a, a, {}, std::vector<uint8_t>(256, 0));
    EXPECT_FALSE(errors.comparable());
    EXPECT_TRUE(std::isnan(errors.relative_rmse) && std::isnan(errors.flip) && std::isnan(errors.ssim));
    EXPECT_NE(describe(errors).find("the mask leaves no pixel"), std::string::npos);
}

// --- what is not finite ---

TEST(Metrics, PixelsThatAreNotFiniteAreCountedWhereverTheyAre) {
    const RadianceImage good = noise(20, 10, 1);
    std::vector<uint8_t> mask(200, 0);
    mask[0] = 1;
    const auto expectSaid = [&](const RadianceImage& v, const RadianceImage& r, size_t count, int x, int y) {
        const Errors errors = compare(v, r, {}, mask);
        EXPECT_FALSE(errors.comparable());
        EXPECT_EQ(errors.not_finite, count);
        EXPECT_EQ(errors.worst.x, x);
        EXPECT_EQ(errors.worst.y, y);
        for (const double error :
             {errors.relative_rmse, errors.bias, errors.rel_mse, errors.psnr, errors.ssim, errors.flip})
            EXPECT_TRUE(std::isnan(error));
        EXPECT_NE(describe(errors).find(std::to_string(count) + " pixels are not finite"), std::string::npos);
    };
    RadianceImage bad = good;
    bad.radiance[7 * 20 + 3].z = kNaN;
    expectSaid(bad, good, 1, 3, 7);
    expectSaid(good, bad, 1, 3, 7);
    bad.radiance[2 * 20 + 4].x = kInfinity;
    expectSaid(bad, good, 2, 4, 2);
    bad = good;
    bad.transmittance[5] = -kInfinity;
    expectSaid(bad, good, 1, 5, 0);
}

TEST(Metrics, SizesMustAgree) {
    const RadianceImage a = noise(16, 12, 1), b = noise(12, 16, 1);
    EXPECT_THROW(compare(a, b, {}), std::invalid_argument);
    EXPECT_THROW(compare(a, a, {}, std::vector<uint8_t>(5, 1)), std::invalid_argument);
    EXPECT_THROW(flipMap(a, b, {}), std::invalid_argument);
    RadianceImage cut = a;
    cut.transmittance.pop_back();
    EXPECT_THROW(compare(cut, a, {}), std::invalid_argument);
}

// --- PSNR and SSIM ---

TEST(Metrics, PsnrOfAKnownNoise) {
    // Values of sRGB's straight part, 12.92 x: a difference of 0.002 shows as 0.02584.
    RadianceImage r = uniform(16, 16, glm::vec3(0.001f)), v = uniform(16, 16, glm::vec3(0.003f));
    EXPECT_NEAR(compare(v, r, kLinear).psnr, -20 * std::log10(0.02584), 1e-4); // float32: 1e-5 relative
    for (size_t i = 0; i < v.radiance.size(); i += 4) v.radiance[i] = r.radiance[i];
    EXPECT_NEAR(compare(v, r, kLinear).psnr, -20 * std::log10(0.02584) - 10 * std::log10(0.75), 1e-4);
}

TEST(Metrics, SsimByHand) {
    // Two even pictures: no variance, only the means' term.
    const std::vector<float> low(121, 0.25f), high(121, 0.5f);
    EXPECT_NEAR(ssim(11, 11, low, high), (2 * 0.125 + 1e-4) / (0.3125 + 1e-4), 1e-12);
    // One window, a single 1 in its middle against black. The middle's weight is (1 / sum of e^(-i^2 / 4.5), i =
    // -5..5)^2.
    const double weight = std::pow(1 / 3.7592315, 2);
    std::vector<float> black(121, 0), dot = black;
    dot[5 * 11 + 5] = 1;
    const double variance = weight - weight * weight;
    EXPECT_NEAR(ssim(11, 11, dot, black), 1e-4 / (weight * weight + 1e-4) * 9e-4 / (variance + 9e-4),
                1e-8); // digits of 3.759...
    // The same dot, as black on white: same means' difference, covariance 0 still.
    const std::vector<float> white(121, 1);
    EXPECT_NEAR(ssim(11, 11, dot, white), (2 * weight + 1e-4) / (weight * weight + 1 + 1e-4) * 9e-4 / (variance + 9e-4),
                1e-6);
}

TEST(Metrics, SsimOfANegativeIsNegative) {
    std::vector<float> a, b;
    for (int i = 0; i < 20 * 20; ++i) {
        a.push_back(static_cast<float>((i * 7919) % 11) / 10);
        b.push_back(1 - a.back());
    }
    EXPECT_LT(ssim(20, 20, a, b), -0.5);
    EXPECT_NEAR(ssim(20, 20, a, a), 1, 1e-12);
    EXPECT_TRUE(std::isnan(ssim(10, 40, std::span(a), std::span(b)))); // no window fits
    std::vector<uint8_t> mask(400, 0);
    mask[4 * 20 + 10] = 1; // its window leaves the picture
    EXPECT_TRUE(std::isnan(ssim(20, 20, a, b, mask)));
    mask[5 * 20 + 10] = 1;
    EXPECT_LT(ssim(20, 20, a, b, mask), 0);
}

// --- FLIP ---

TEST(Flip, EvenPictures) {
    // Linear inputs. As sRGB values 0.5 and 0.51 would give 0.0575: the next line would not hold.
    EXPECT_NEAR(uniformFlip(glm::vec3(0.5f), glm::vec3(0.51f)), 0.0407, 5e-5); // its printed digits
    // Printed digits, and 1e-5 of rounding as below.
    EXPECT_NEAR(uniformFlip(glm::vec3(0), glm::vec3(1)), 0.96738, 2e-5);
    EXPECT_NEAR(uniformFlip({0, 1, 0}, {0, 0, 1}), 1, 2e-5);
}

// The authors' program, version 1.6, on the same pictures; both are float32 and add up in other orders. 1e-5: a
// feature's strength enters by its square root, which makes 1e-4 of the exponent from a rounding of 1e-8.
TEST(Flip, AgreesWithTheAuthorsProgram) {
    constexpr int kWidth = 48, kHeight = 32;
    std::vector<glm::vec3> r, v;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const auto part = [](int value, int of) {
                return static_cast<float>(value % of) / static_cast<float>(of - 1);
            };
            const glm::vec3 p{part(x * 7 + y * 13, 32), 0.8f * static_cast<float>((x / 5 + y / 3) % 2),
                              part(x * x + 3 * y * y, 64)};
            const glm::vec3 q{part(x * 7 + y * 13 + 3, 32), 0.8f * static_cast<float>((x / 5 + y / 4) % 2),
                              part(x * x + 2 * y * y, 64)};
            r.push_back(p);
            v.push_back(x < 16 ? p * glm::vec3(1, 1, 0.9f) : q);
        }
    const std::vector<float> map = flipMap(kWidth, kHeight, v, r);
    EXPECT_NEAR(mean(map), 0.4248514, 1e-5);
    struct {
        int x, y;
        double flip;
    } const expected[] = {{0, 0, 0.1422818},   {10, 20, 0.1603052}, {15, 8, 0.2730329}, {16, 8, 0.3336585},
                          {24, 16, 0.4156375}, {47, 31, 0.9739247}, {40, 3, 0.3409778}, {30, 30, 0.6832829}};
    for (const auto& pixel : expected)
        EXPECT_NEAR(map[pixel.y * kWidth + pixel.x], pixel.flip, 1e-5) << pixel.x << ' ' << pixel.y;
}

TEST(Flip, SeesLessOfTheSameDifferenceWhenItIsFiner) {
    // Stripes of one pixel and of eight against grey of the same mean: the eye blurs the fine ones.
    std::vector<glm::vec3> fine, coarse;
    for (int i = 0; i < 64 * 64; ++i) {
        fine.push_back(glm::vec3(i % 2 ? 0.7f : 0.3f));
        coarse.push_back(glm::vec3(i / 8 % 2 ? 0.7f : 0.3f));
    }
    const std::vector<glm::vec3> grey(4096, glm::vec3(0.5f));
    EXPECT_LT(mean(flipMap(64, 64, fine, grey)), 0.7 * mean(flipMap(64, 64, coarse, grey)));
    // From twice as far away less is seen of either.
    EXPECT_LT(mean(flipMap(64, 64, coarse, grey, 2 * kPixelsPerDegree)), mean(flipMap(64, 64, coarse, grey)));
}

TEST(Flip, ColourMapGrowsLighter) {
    std::vector<float> ramp;
    for (int i = 0; i <= 100; ++i) ramp.push_back(static_cast<float>(i) / 100);
    const auto colours = colourMap(ramp);
    for (size_t i = 1; i < colours.size(); ++i)
        ASSERT_GT(glm::dot(glm::vec3(colours[i]), glm::vec3(0.2126f, 0.7152f, 0.0722f)),
                  glm::dot(glm::vec3(colours[i - 1]), glm::vec3(0.2126f, 0.7152f, 0.0722f)))
            << i;
    const auto outside = colourMap(std::vector<float>{-1, 2, kNaN});
    EXPECT_EQ(outside[0], colours.front());
    EXPECT_EQ(outside[1], colours.back());
    EXPECT_EQ(outside[2], colours.front());
}

TEST(Flip, FlickerIsWhatChangesBeyondTheReference) {
    const RadianceImage dark = uniform(32, 32, glm::vec3(0.5f)), light = uniform(32, 32, glm::vec3(0.51f));
    const std::vector<RadianceImage> still{dark, dark, dark}, popping{dark, light, dark}, rising{dark, light, light};
    // As even pictures: 0.0407 each time it pops.
    EXPECT_NEAR(temporalFlip(popping, still, kLinear), 0.0407, 5e-5);
    EXPECT_NEAR(temporalFlip(rising, still, kLinear), 0.0407 / 2, 5e-5);
    EXPECT_NEAR(temporalFlip(rising, popping, kLinear), -0.0407 / 2, 5e-5);
    EXPECT_EQ(temporalFlip(popping, popping, kLinear), 0);
    std::vector<RadianceImage> broken = still;
    broken[1].radiance[5].x = kNaN;
    EXPECT_TRUE(std::isnan(temporalFlip(broken, still, kLinear)));
    EXPECT_TRUE(std::isnan(temporalFlip(still, broken, kLinear)));
    EXPECT_THROW(temporalFlip({&dark, 1}, {&dark, 1}, kLinear), std::invalid_argument);
    EXPECT_THROW(temporalFlip(still, {&dark, 1}, kLinear), std::invalid_argument);
}

} // namespace
} // namespace brume::metrics_test
