// What of method isv is as the dissertation prints it: the Taylor series of section 3.9, even extinction, and the term
// for multiple scattering.
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "shaders/shared/scatter.h"

namespace {

using namespace brume;

constexpr double kSqrtPi = 1.7724538509055160273;

// Seed 000 section 3.9 term by term, over (0, h): four Taylor terms about the middle with forward differences, each
// integrated from -h/2 to h/2.
double printedTaylor(const std::function<double(double)>& f, double h, double step) {
    const double m = h / 2, d = h * step;
    const double f0 = f(m), f1 = f(m + d), f2 = f(m + 2 * d), f3 = f(m + 3 * d);
    const double derivatives[4] = {f0, (f1 - f0) / d, (f2 - 2 * f1 + f0) / (d * d),
                                   (f3 - 3 * f2 + 3 * f1 - f0) / (d * d * d)};
    double sum = 0, factorial = 1;
    for (int k = 0; k < 4; ++k) {
        factorial *= k + 1;
        sum += derivatives[k] / factorial * (std::pow(m, k + 1) - std::pow(-m, k + 1));
    }
    return sum;
}

double taylorOf(const std::function<double(double)>& f, double h, double step = 1.0 / 16) {
    double mean = 0;
    for (int j = 0; j < 3; ++j) {
        const auto rule = physics::taylorRule<double>(j, step);
        mean += rule.weight * f(h * rule.along);
    }
    return mean * h;
}

TEST(Taylor, IsThePrintedSeriesTermByTerm) {
    const auto bell = [](double x) { return std::exp(-x * x + 0.3 * x); };
    for (const double h : {1e-3, 0.4, 2.5, 9.0})
        for (const double step : {1.0 / 16, 0.3, 0.01}) {
            const double printed = printedTaylor(bell, h, step);
            EXPECT_NEAR(taylorOf(bell, h, step), printed, 1e-12 * (h + std::abs(printed))) << h << ' ' << step;
        }
}

TEST(Taylor, ExactForPolynomialsButForTheDifferencesOwnError) {
    for (const double h : {0.1, 1.0, 7.0})
        for (int degree = 0; degree <= 3; ++degree) {
            const double exact = std::pow(h, degree + 1) / (degree + 1);
            const double step = h / 16, third = degree == 3 ? 6 : 0; // f''' of x^3
            EXPECT_NEAR(taylorOf([&](double x) { return std::pow(x, degree); }, h),
                        exact + third * step * h * h * h / 24, 1e-12 * exact)
                << h << ' ' << degree;
        }
    EXPECT_GT(std::abs(taylorOf([](double x) { return std::pow(x, 4); }, 1.0) - 0.2), 0.01) << "no more than that";
}

// Over a particle the series does not converge: it misses by the whole, and is far too bright where a shadow's edge
// lies between its nodes.
TEST(Taylor, FailsOverAParticle) {
    EXPECT_LT(taylorOf([](double x) { return std::exp(-(x - 3) * (x - 3)); }, 6), -0.5 * kSqrtPi)
        << "less than nothing";
    const auto behind_an_edge = [](double x) { return x < 3.3 ? 0.0 : std::exp(-(x - 3) * (x - 3)); };
    EXPECT_LT(taylorOf(behind_an_edge, 6), -10);
    const auto before_an_edge = [](double x) { return x < 3.3 ? std::exp(-(x - 3) * (x - 3)) : 0.0; };
    EXPECT_GT(taylorOf(before_an_edge, 6), 30 * 0.5 * kSqrtPi) << "of less than half of the whole";
}

TEST(EvenSource, ItsMeanIsTheOpacity) {
    for (const double depth : {1e-4, 0.3, 2.0, 20.0}) {
        double mean = 0;
        for (int j = 0; j <= 400; ++j) {
            const auto rule = physics::simpsonRule<double>(j, 200);
            mean += rule.weight * physics::evenSource(depth, rule.along);
        }
        EXPECT_NEAR(mean, -std::expm1(-depth), 1e-6 * depth) << depth;
    }
    for (const float along : {0.0f, 0.5f, 1.0f}) EXPECT_TRUE(std::isfinite(physics::evenSource(1e38f, along)));
}

TEST(LegacyMultiple, IsEquation11) {
    EXPECT_DOUBLE_EQ(physics::legacyMultiple(0.25, 0.8), 0.25 * 0.001 * 0.8);
    EXPECT_EQ(physics::legacyMultiple(1.0f, 0.0f), 0);
}

} // namespace
