// The estimate of a picture's error from some of its pixels.
#include "server/error/error_window.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "common/random.h"
#include "server/error/error_meter.h"

namespace brume::error_window_test {
namespace {

using std::chrono::seconds;

const ErrorWindow::Time kStart = ErrorWindow::Time{} + std::chrono::hours(1);

std::vector<PixelError> same(size_t count, float value, float reference) {
    return {count, PixelError{glm::vec3(value), glm::vec3(reference)}};
}

TEST(ErrorWindow, IsTheRelativeRmseOfItsPixels) {
    ErrorWindow window;
    EXPECT_EQ(window.estimate(kStart).pixels, 0u);
    window.add(same(60, 1.01f, 1), 0.02, kStart);
    EXPECT_FALSE(window.estimate(kStart).known());
    EXPECT_EQ(window.estimate(kStart).correction(), 1);
    window.add(same(60, 2.04f, 2), 0.01, kStart);
    const ErrorEstimate e = window.estimate(kStart);
    ASSERT_TRUE(e.known());
    const double size = 60 * (1 + 4);
    EXPECT_NEAR(e.rmse, std::sqrt(60 * (1e-4 + 1.6e-3) / size), 1e-7);
    EXPECT_NEAR(e.law, std::sqrt(60 * (4e-4 * 1 + 1e-4 * 4) / size), 1e-9);
    EXPECT_NEAR(e.correction(), e.rmse / e.law, 1e-12);
    EXPECT_NEAR(e.bias, 0.015, 1e-6);
    EXPECT_LT(e.low, e.rmse);
    EXPECT_GT(e.high, e.rmse);
}

TEST(ErrorWindow, LeavesOutWhatIsDarkAndForgetsWhatIsOld) {
    ErrorWindow window;
    std::vector<PixelError> pixels = same(200, 1, 1);
    for (PixelError& pixel : pixels)
        pixel.value.b = 9e-4f * 2, pixel.reference.b = 9e-4f; // twice as bright as it should
    window.add(pixels, 0.01, kStart);
    EXPECT_EQ(window.estimate(kStart).rmse, 0);
    window.add(same(200, 1.1f, 1), 0.01, kStart + seconds(20));
    EXPECT_NEAR(window.estimate(kStart + seconds(20)).rmse, 0.1 / std::sqrt(2), 0.01);
    EXPECT_NEAR(window.estimate(kStart + ErrorWindow::kKept + seconds(1)).rmse, 0.1, 1e-6);
    EXPECT_EQ(window.estimate(kStart + seconds(20) + ErrorWindow::kKept + seconds(1)).pixels, 0u);
    for (int i = 0; i < 10; ++i) window.add(same(200, 1.2f, 1), 0.01, kStart + seconds(21));
    EXPECT_EQ(window.estimate(kStart + seconds(21)).pixels, ErrorWindow::kMost);
    EXPECT_NEAR(window.estimate(kStart + seconds(21)).rmse, 0.2, 1e-6);
}

// Errors of several kinds: all alike; one pixel in ten five times as far off; one in fifty, which needs more pixels.
TEST(ErrorWindow, TheTruthIsInsideItsInterval) {
    Random random(7);
    for (const float rare : {1.0f, 0.1f, 0.02f}) {
        const auto pixel = [&] {
            const float size = random.uniform(0.2f, 1), off = random.uniform(-0.01f, 0.01f);
            return PixelError{glm::vec3(size * (1 + off * (random.uniform() < rare ? 5 : 1))), glm::vec3(size)};
        };
        ErrorWindow all;
        double errors = 0, sizes = 0;
        for (int i = 0; i < 200'000; ++i) {
            const PixelError one = pixel();
            errors += std::pow(double(one.value.r - one.reference.r), 2), sizes += std::pow(double(one.reference.r), 2);
        }
        const double truth = std::sqrt(errors / sizes);
        int inside = 0;
        for (int trial = 0; trial < 200; ++trial) {
            ErrorWindow window;
            std::vector<PixelError> some(rare < 0.1f ? ErrorWindow::kMost : 300);
            for (PixelError& one : some) one = pixel();
            window.add(some, 0.01, kStart);
            const ErrorEstimate e = window.estimate(kStart);
            inside += truth >= e.low && truth <= e.high;
            EXPECT_LT(e.high, 2.5 * e.low) << rare;
        }
        EXPECT_GE(inside, 190) << rare;
    }
}

TEST(MeterPixels, AreSpreadOverWhatIsSeenOfTheBox) {
    const Pose pose = lookAt({0, 0, 10}, {0, 0, 0}, 0.8f);
    const auto near = [&](uint64_t seed) { return pixelsOf(pose, {320, 180}, glm::vec3(-1), glm::vec3(1), seed); };
    const std::vector<glm::uvec2> pixels = near(1);
    ASSERT_EQ(pixels.size(), 256u);
    EXPECT_EQ(pixels, near(1));
    EXPECT_NE(pixels, near(2));
    // The box's front is at a depth of 9 m: half its side is 180 / (2 tan 0.4 * 9) = 23.7 pixels.
    glm::uvec2 lo(1000), hi(0);
    for (const glm::uvec2 p : pixels) lo = glm::min(lo, p), hi = glm::max(hi, p);
    EXPECT_NEAR(lo.x, 160 - 23.7, 2);
    EXPECT_NEAR(hi.x, 160 + 23.7, 2);
    EXPECT_NEAR(lo.y, 90 - 23.7, 2);
    EXPECT_NEAR(hi.y, 90 + 23.7, 2);
    EXPECT_TRUE(pixelsOf(pose, {320, 180}, glm::vec3(0, 0, 20), glm::vec3(1, 1, 21), 1).empty()) << "behind the eye";
    EXPECT_TRUE(pixelsOf(pose, {320, 180}, glm::vec3(50, 0, 0), glm::vec3(51, 1, 1), 1).empty())
        << "beside the picture";
    for (const glm::uvec2 p : pixelsOf(pose, {320, 180}, glm::vec3(-20), glm::vec3(20), 1)) // the eye is inside
        EXPECT_TRUE(p.x < 320 && p.y < 180);
}

} // namespace
} // namespace brume::error_window_test
