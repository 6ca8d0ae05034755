// Functions of the simulation that libm has, too: against the latter's with more digits.
#include "common/elementary.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

#include "common/random.h"

namespace brume {
namespace {

static_assert(std::numeric_limits<long double>::digits > 60, "the comparison needs more digits than a double has");

double errorOf(double value, long double exact) {
    return exact == 0 ? std::abs(value) : static_cast<double>(std::abs((value - exact) / exact));
}

// Every 1000th float, denormal ones too; the prime makes their last digits differ.
TEST(Elementary, DepthOfIsExactButForTheLastDigit) {
    size_t not_rounded = 0;
    for (uint32_t bits = 0; bits < std::bit_cast<uint32_t>(1.0f); bits += 1009) {
        const auto x = std::bit_cast<float>(bits);
        const long double exact = -std::log1p(-static_cast<long double>(x));
        ASSERT_LE(errorOf(depthOf(double(x)), exact), 3e-16) << x;
        not_rounded += static_cast<float>(depthOf(double(x))) != static_cast<float>(exact);
    }
    EXPECT_EQ(not_rounded, 0u) << "of a million floats; std::log1p of floats fails two thousand";
}

TEST(Elementary, CubeRootIsExactButForTheLastDigit) {
    EXPECT_EQ(cubeRoot(0), 0);
    EXPECT_EQ(cubeRoot(27), 3);
    Random random(1);
    for (int i = 0; i < 100'000; ++i) {
        const auto x = std::bit_cast<double>(random.bits() >> 1);
        if (!std::isnormal(x)) continue;
        ASSERT_LE(errorOf(cubeRoot(x), std::cbrt(static_cast<long double>(x))), 2e-16) << x;
    }
}

TEST(Elementary, SineAndCosineAreExactButForTheLastDigit) {
    Random random(1);
    for (int i = 0; i < 100'000; ++i) {
        const double x = double(random.uniform(-1000, 1000));
        ASSERT_NEAR(sine(x), double(std::sin(static_cast<long double>(x))), 1e-15) << x;
        ASSERT_NEAR(cosine(x), double(std::cos(static_cast<long double>(x))), 2e-13) << x;
    }
    EXPECT_EQ(sine(0), 0);
    EXPECT_EQ(cosine(0), 1);
}

TEST(Elementary, ExponentialIsExactButForTheLastDigit) {
    EXPECT_EQ(exponential(0), 1);
    EXPECT_EQ(exponential(-1e300), exponential(-700));
    EXPECT_TRUE(std::isnan(exponential(std::numeric_limits<double>::quiet_NaN())));
    Random random(1);
    for (int i = 0; i < 100'000; ++i) {
        const double x = double(random.uniform(-700, 700));
        ASSERT_LE(errorOf(exponential(x), std::exp(static_cast<long double>(x))), 4e-16) << x;
    }
}

} // namespace
} // namespace brume
