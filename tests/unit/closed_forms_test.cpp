// The error function family and transmittance, as float (what shaders compute) and as double (the approximation without
// its rounding), against 50 digits; and the forms that physics gets wrong in float, shown to fail.
#include <gtest/gtest.h>

#include "shaders/shared/srgb.h"
#include "shaders/shared/transmittance.h"
#include "tests/unit/exact.h"
#include "tests/unit/worst.h"

namespace {

using namespace brume;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Calls visit(x) for x = lo, lo * ratio, ... <= hi, each exactly representable as float.
template <typename Visit>
void geometric(double lo, double hi, double ratio, Visit visit) {
    for (double x = lo; x <= hi; x *= ratio) visit(static_cast<double>(static_cast<float>(x)));
}

TEST(Erfcx, RelativeErrorForAllNonNegative) {
    Worst single, fit;
    const auto visit = [&](double x) {
        const double exact = exact::erfcx(x);
        single.relative(physics::erfcx(static_cast<float>(x)), exact, x);
        fit.relative(physics::erfcx(x), exact, x);
    };
    visit(0);
    geometric(1e-6, 30, 1.004, visit);
    geometric(30, 1e12, 1.5, visit);
    EXPECT_LT(fit.deviation(), 1.9e-7) << fit;
    EXPECT_LT(single.deviation(), 4.4e-7) << single;
    EXPECT_EQ(physics::erfcx(kInfinity) * 0, 0) << "finite at infinity";
}

TEST(Erf, ValueAndTails) {
    Worst erf, tail, small;
    const auto visit = [&](double x) {
        for (const double y : {x, -x}) {
            erf.absolute(physics::erf(static_cast<float>(y)), exact::erf(y), y);
            if (x < 1) small.relative(physics::erf(static_cast<float>(y)), exact::erf(y), y);
            if (x < 9) tail.relative(physics::erfc(static_cast<float>(y)), exact::erfc(y), y);
        }
    };
    geometric(1e-12, 12, 1.05, visit);
    EXPECT_LT(erf.deviation(), 3e-7) << erf;
    EXPECT_LT(small.deviation(), 7e-7) << small;
    EXPECT_LT(tail.deviation(), 8e-6) << tail; // x^2 epsilon
    EXPECT_EQ(physics::erf(0.0f), 0);
    EXPECT_EQ(physics::erfc(kInfinity), 0);
    EXPECT_EQ(physics::erfc(-kInfinity), 2);
    EXPECT_EQ(physics::erf(-kInfinity), -1);
}

TEST(ErfDifference, RelativeErrorFromThinnestToWholeLine) {
    Worst single, fit, naive, core;
    for (double a0 = -10; a0 <= 9; a0 += 0.237) {
        geometric(1e-7, 30, 1.5, [&](double h) {
            const double a = static_cast<float>(a0);
            const double exact = exact::erfDifference(a, h);
            if (exact < 1e-36) return; // float has no normal numbers left
            const float af = static_cast<float>(a), hf = static_cast<float>(h);
            single.relative(physics::erfDifference(af, hf), exact, a, h);
            if (a > -2 && a + h < 2) core.relative(physics::erfDifference(af, hf), exact, a, h);
            fit.relative(physics::erfDifference(a, h), exact, a, h);
            naive.relative(std::erf(af + hf) - std::erf(af), exact, a, h);
        });
    }
    EXPECT_LT(fit.deviation(), 4e-7) << fit;
    EXPECT_LT(core.deviation(), 1e-6) << core;
    EXPECT_LT(single.deviation(), 1.7e-5) << single; // the rounding of the exponent, a^2 epsilon
    EXPECT_GT(naive.deviation(), 0.99) << "the plain difference was expected to lose everything: " << naive;
}

TEST(ErfDifference, Extremes) {
    EXPECT_EQ(physics::erfDifference(3.0f, 0.0f), 0);
    EXPECT_EQ(physics::erfDifference(0.5f, -1.0f), 0) << "an empty interval";
    EXPECT_EQ(physics::erfDifference(-kInfinity, kInfinity), 2);
    EXPECT_EQ(physics::erfDifference(kInfinity, kInfinity), 0);
    EXPECT_EQ(physics::erfDifference(1e30f, 1e30f), 0);
    EXPECT_NEAR(physics::erfDifference(-100.0f, 200.0f), 2, 1e-6);
    // Additive: the parts of an interval sum to the whole.
    float sum = 0;
    for (int i = 0; i < 64; ++i) sum += physics::erfDifference(-4 + i * 0.125f, 0.125f);
    EXPECT_NEAR(sum, 2, 2e-6);
}

// Through a Gaussian, from its beginning on, by as many steps as shaders take: each value and each sum, in float and
// in double.
TEST(ErfSteps, FollowTheDifferences) {
    Worst value, sum, single;
    constexpr int kMostSteps = 96;
    geometric(0.02, 1, 1.3, [&](double h) {
        for (double u = -4.5; u < 0; u += 1.3) {
            auto steps = physics::erfSteps(u, h);
            auto in_float = physics::erfSteps(static_cast<float>(u), static_cast<float>(h));
            double added = 0, added_in_float = 0;
            const double h4 = h * h * h * h;
            for (double at = u; at < std::min(4.5, u + kMostSteps * h); at += h) {
                added += steps.value;
                added_in_float += in_float.value;
                const double begin = u - h / 2, end = at + h / 2;
                value.absolute((steps.value - exact::erfDifference(at - h / 2, h)) / h4, 0, at, h);
                sum.absolute((added - exact::erfDifference(begin, end - begin)) / h4, 0, at, h);
                single.absolute(added_in_float, added, at, h);
                steps.value *= steps.ratio, steps.ratio *= steps.change;
                in_float.value *= in_float.ratio, in_float.ratio *= in_float.change;
            }
        }
    });
    EXPECT_LT(value.deviation(), 3.7e-3) << value;
    EXPECT_LT(sum.deviation(), 3.7e-3) << sum;
    EXPECT_LT(single.deviation(), 5e-4) << single;
}

TEST(ErfcInverse, FindsTheArgument) {
    Worst single, fit;
    for (double q = 0; q <= 9; q += 0.01) {
        const double y = exact::erfc(q);
        fit.absolute(physics::erfcInverse(y), q, q);
        single.absolute(physics::erfcInverse(static_cast<float>(y)), q, q);
    }
    EXPECT_LT(fit.deviation(), 3e-7) << fit;
    EXPECT_LT(single.deviation(), 4e-6) << single;
    EXPECT_NEAR(physics::erfcInverse(0.0f), 9.1f, 0.1f);
}

TEST(Exponentials, PhiOpacityAndBack) {
    Worst phi, fit, opacity, depth, narrow_switch;
    const auto plainPhi = [](float x) { return std::abs(x) < 1e-6f ? 1 - x * 0.5f : (1 - std::exp(-x)) / x; };
    geometric(1e-20, 80, 1.05, [&](double x) {
        const auto single = static_cast<float>(x);
        phi.relative(physics::phi(single), exact::phi(x), x);
        fit.relative(physics::phi(x), exact::phi(x), x);
        if (x < 20) phi.relative(physics::phi(-single), exact::phi(-x), -x);
        opacity.relative(physics::opacity(single), exact::opacity(x), x);
        if (x < 1) depth.relative(physics::depthOfOpacity(single), exact::depthOfOpacity(x), x);
    });
    geometric(1e-6, 2e-6, 1.01,
              [&](double x) { narrow_switch.relative(plainPhi(static_cast<float>(x)), exact::phi(x), x); });
    EXPECT_LT(phi.deviation(), 2e-6) << phi;
    EXPECT_LT(fit.deviation(), 6e-8) << fit; // the series' next term
    EXPECT_LT(opacity.deviation(), 4e-7) << opacity;
    EXPECT_LT(depth.deviation(), 5e-7) << depth;
    EXPECT_GT(narrow_switch.deviation(), 0.02) << "a switch at 1e-6 was expected to lose percents: " << narrow_switch;
    EXPECT_EQ(physics::phi(0.0f), 1);
    EXPECT_EQ(physics::phi(1e38f) * 1e38f, 1);
    EXPECT_EQ(physics::opacity(kInfinity), 1);
    EXPECT_LT(physics::depthOfOpacity(1.0f), 100) << "finite for a full opacity";
}

// Extinction along a line past a particle, integrated by the midpoint rule, which converges geometrically for
// Gaussians.
double integratedDepth(double sigma_t, double k, double b2, double a, double h) {
    const int n = 4096;
    double sum = 0;
    for (int i = 0; i < n; ++i) {
        const double q = a + h * (i + 0.5) / n;
        sum += std::exp(-k * k * b2 - q * q);
    }
    return sigma_t * sum * h / (n * k);
}

TEST(SegmentDepth, GaussianFactorBelongsInsideTheExponent) {
    const double u = 9.6, b = 1.583, sigma_t = 0.534; // m, m, 1/m
    const double k = physics::gaussianK(6.0, 1.6), b2 = b * b;
    EXPECT_NEAR(k, std::sqrt(50.0) / u, 1e-12);
    const double a = -8, h = 16;
    const double transmittance = std::exp(-physics::segmentDepth(sigma_t, k, b2, a, h));
    EXPECT_NEAR(transmittance, std::exp(-integratedDepth(sigma_t, k, b2, a, h)), 1e-6);
    EXPECT_NEAR(transmittance, 0.719, 5e-4);
    const double across = std::exp(-k * k * b2);
    const double printed = across * std::exp(-physics::lineDepth(sigma_t, k, 1.0));
    EXPECT_NEAR(printed, 0.071, 5e-4) << "seed 000's equation 10 as printed";
}

TEST(SegmentDepth, AgreesWithIntegrationFromOutsideAndInside) {
    Worst single;
    for (const double b2 : {0.0, 0.3, 4.0}) {
        for (const double a : {-5.0, -1.5, -0.2, 0.0, 0.7, 3.0}) {
            for (const double h : {1e-3, 0.1, 0.6, 2.0, 7.0}) {
                const double exact =
                    integratedDepth(2.5, 0.75, static_cast<float>(b2), static_cast<float>(a), static_cast<float>(h));
                const float depth = physics::segmentDepth(2.5f, 0.75f, static_cast<float>(b2), static_cast<float>(a),
                                                          static_cast<float>(h));
                single.relative(depth, exact, a, h);
            }
        }
    }
    EXPECT_LT(single.deviation(), 5e-6) << single;
}

TEST(LightDepth, HalfLines) {
    const float sigma_t = 1.7f, k = 0.8f, across = physics::gaussianAcross(k, 1.1f);
    const float line = physics::lineDepth(sigma_t, k, across);
    EXPECT_EQ(physics::lightDepth(sigma_t, k, across, kInfinity), 0) << "the light side sees nothing";
    EXPECT_FLOAT_EQ(physics::lightDepth(sigma_t, k, across, -kInfinity), line);
    EXPECT_FLOAT_EQ(physics::lightDepth(sigma_t, k, across, 0.0f), line / 2);
    for (const float s : {-6.0f, -1.0f, -0.1f, 0.3f, 2.0f, 5.0f})
        EXPECT_NEAR(physics::lightDepth(sigma_t, k, across, s), line / 2 * exact::erfc(s),
                    1e-6 * line * exact::erfc(s) * (1 + s * s));
}

// Integral of 1 - T over the plane across one particle, which has a closed form: (pi u^2 / 50) (gamma + ln T0 +
// E1(T0)).
template <typename real>
double discIntegral(real central_depth, real u) {
    const real k = std::sqrt(real(50)) / u;
    const real sigma_t = central_depth * k / real(1.7724538509055159);
    const int n = 4000;
    const double reach = 8 / static_cast<double>(k);
    double sum = 0;
    for (int i = 0; i < n; ++i) {
        const double b = reach * (i + 0.5) / n;
        const real depth = physics::lineDepth(sigma_t, k, physics::gaussianAcross(k, static_cast<real>(b * b)));
        sum += static_cast<double>(physics::opacity(depth)) * 2 * 3.14159265358979 * b * reach / n;
    }
    return sum;
}

TEST(LineDepth, DiscIntegral) {
    EXPECT_NEAR(discIntegral(3.2, 1.6), 0.281567040834, 2e-7); // the midpoint rule in b leaves 1.4e-7
    EXPECT_NEAR(discIntegral(3.2f, 1.6f), 0.281567040834, 4e-7);
}

TEST(Transmittance, HeightFog) {
    // tau = r0 e^(-k y0) L phi(k dy), also upward, downward and level.
    const float density = 0.3f, falloff = 0.2f, start = 1.5f, length = 12;
    for (const float rise : {-6.0f, -1e-4f, 0.0f, 3.0f, 12.0f}) {
        double exact = 0;
        const int n = 20000;
        for (int i = 0; i < n; ++i) exact += density * std::exp(-falloff * (start + rise * (i + 0.5) / n)) * length / n;
        const float depth = density * std::exp(-falloff * start) * length * physics::phi(falloff * rise);
        EXPECT_NEAR(depth, exact, 2e-6 * exact) << rise;
    }
}

TEST(Srgb, WithinThreeHundredthsOfALevel) {
    double worst = 0, last = 0;
    for (int i = 0; i <= 1 << 20; ++i) {
        const float x = float(i) / float(1 << 20);
        const double exact = x > 0.0031308f ? 1.055 * std::pow(double(x), 1 / 2.4) - 0.055 : 12.92 * double(x);
        const double got = double(physics::srgb(x));
        worst = std::max(worst, std::abs(got - exact));
        ASSERT_GE(got, last - 3e-7) << x; // roundings
        last = got;
    }
    EXPECT_LT(255 * worst, 0.031);
    EXPECT_EQ(physics::srgb(0.0f), 0);
}

} // namespace
