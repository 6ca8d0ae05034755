// Quadratures of the light that one particle scatters toward the eye: exact answers, convergence, conservation,
// extremes.
#include <algorithm>
#include <cstdio>
#include <functional>
#include <random>
#include <vector>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <gtest/gtest.h>

#include "shaders/shared/scatter.h"
#include "shaders/shared/tetrahedra.h"
#include "tests/unit/worst.h"

namespace {

using namespace brume;

// One interval in units of 1/k with k = 1, and a light S = exp(-(l0 + l1 z)) that is linear in depth along the ray.
struct Interval {
    double peak_line; // optical depth of the whole line
    double a, h, l0, l1;
    double light(double z) const { return std::exp(-(l0 + l1 * z)); }
};

constexpr double kSqrtPi = 1.7724538509055160273;

template <typename real>
physics::GaussianSegment<real> segmentOf(const Interval& i) {
    return physics::gaussianSegment(static_cast<real>(i.peak_line / kSqrtPi), real(1), real(0), static_cast<real>(i.a),
                                    static_cast<real>(i.h));
}

// Adaptive Gauss-Kronrod with libm's erf, independent of the forms under test.
double exactScatter(const Interval& i) {
    const double half_line = i.peak_line / 2;
    const auto f = [&](double z) {
        const double q = i.a + z;
        return i.peak_line / kSqrtPi * std::exp(-q * q - half_line * (std::erf(q) - std::erf(i.a))) * i.light(z);
    };
    double sum = 0;
    const int panels = 8; // so that no narrow feature is missed by the first look
    for (int p = 0; p < panels; ++p)
        sum += boost::math::quadrature::gauss_kronrod<double, 15>::integrate(f, i.h * p / panels,
                                                                             i.h * (p + 1) / panels, 8, 1e-11);
    return sum;
}

template <typename real>
double simpson(const Interval& i, int n) {
    const auto segment = segmentOf<real>(i);
    double sum = 0;
    for (int j = 0; j <= 2 * n; ++j) {
        const auto node = physics::simpsonNode(segment, j, n);
        sum += node.weight * i.light(node.z);
    }
    return sum;
}

// As the dissertation's program does it: T_V starts again at every step.
double simpsonRestarted(const Interval& i, int n) {
    double sum = 0;
    for (int step = 0; step < n; ++step) {
        Interval part = i;
        part.a = i.a + i.h * step / n;
        part.h = i.h / n;
        part.l0 = i.l0 + i.l1 * i.h * step / n;
        sum += simpson<double>(part, 1);
    }
    return sum;
}

template <typename real>
double transmittance(const Interval& i, int n) {
    const auto segment = segmentOf<real>(i);
    double sum = 0;
    for (int j = 0; j < n; ++j) {
        const auto node = physics::transmittanceNode(segment, j, n);
        sum += node.weight * i.light(node.z);
    }
    return sum;
}

template <typename real>
double taylor(const Interval& i) {
    const auto segment = segmentOf<real>(i);
    double sum = 0;
    for (int j = 0; j < 3; ++j) {
        const auto rule = physics::taylorRule<real>(j, real(1) / 16);
        sum += rule.weight * physics::segmentSource(segment, rule.along) * i.light(i.h * rule.along);
    }
    return sum;
}

double printedAnalytic(float t, float light_in, float light_out) {
    // Seed 000 section 3.7 with z_min = 0: overflows where depths are large, 0/0 where they balance.
    return t * (std::exp(t + light_out) - std::exp(light_in)) * std::exp(-t - light_out - light_in) /
           (t + light_out - light_in);
}

TEST(ScatterAnalytic, HomogeneousSlab) {
    // Thickness 1.7, cosines .6 (light) and .85 (view), rho = .9, isotropic, E = 1.
    const double view = 1.7 / 0.85, light = 1.7 / 0.6, source = 0.9 * 0.07957747154594767;
    EXPECT_NEAR(source * physics::scatterAnalytic(view, 0.0, light), 0.0293998491338, 1e-9);
    EXPECT_NEAR(source * physics::scatterAnalytic(view, light, 0.0), 0.0131526148731, 1e-9);
    EXPECT_NEAR(static_cast<float>(source) * physics::scatterAnalytic(2.0f, 0.0f, static_cast<float>(light)),
                0.0293998491338, 1e-8);
}

TEST(ScatterAnalytic, UniformSphereAgainstAndWithTheLight) {
    for (const double depth : {1e-6, 0.01, 0.7, 5.0, 60.0}) { // of the chord, 2 a sigma
        EXPECT_NEAR(physics::scatterAnalytic(depth, 0.0, depth), (1 - std::exp(-2 * depth)) / 2, 1e-7 * depth);
        EXPECT_NEAR(physics::scatterAnalytic(depth, depth, 0.0), depth * std::exp(-depth), 1e-12);
    }
}

TEST(ScatterAnalytic, FiniteWherePrintedIsNot) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> exponent(-6, 3);
    int printed_failures = 0;
    const int cases = 20000;
    Worst stable;
    for (int i = 0; i < cases; ++i) {
        const float t = std::pow(10.0f, exponent(random)), in = std::pow(10.0f, exponent(random)),
                    out = std::pow(10.0f, exponent(random));
        const float value = physics::scatterAnalytic(t, in, out);
        const double exit = static_cast<double>(t) + out, x = std::abs(exit - in);
        const double exact = t * std::exp(-std::min<double>(in, exit)) * (x < 1e-9 ? 1 - x / 2 : -std::expm1(-x) / x);
        if (exact > 1e-30) stable.relative(value, exact, t, in);
        ASSERT_TRUE(std::isfinite(value) && value >= 0 && value <= 1.000001f) << t << " " << in << " " << out;
        printed_failures += !std::isfinite(static_cast<float>(printedAnalytic(t, in, out)));
    }
    EXPECT_LT(stable.deviation(), 1e-4) << stable; // the rounding of depths up to 70 in the exponent, and of their sum
    EXPECT_GT(printed_failures, cases / 20) << "the printed form was expected to fail often";
    EXPECT_EQ(physics::scatterAnalytic(0.0f, 0.0f, 0.0f), 0);
    EXPECT_EQ(physics::scatterAnalytic(1e38f, 0.0f, 0.0f), 1);
    EXPECT_EQ(physics::scatterAnalytic(1e38f, 1e38f, 1e38f), 0);
}

// Cut where the extinction changes fast, so that the rule's order shows.
const Interval kInterval{2.0, -1.1, 1.9, 0.3, 0.8};

TEST(Simpson, ConvergesWithFourthOrder) {
    const double exact = exactScatter(kInterval);
    double previous = 0;
    for (const int n : {4, 8, 16, 32}) {
        const double error = std::abs(simpson<double>(kInterval, n) - exact);
        if (previous != 0) {
            EXPECT_NEAR(std::log2(previous / error), 4, 0.5) << n << " steps: " << error;
        }
        previous = error;
    }
    EXPECT_LT(previous, 1e-6 * exact);
    EXPECT_NEAR(simpson<float>(kInterval, 10), exact, 1e-4 * exact);
}

TEST(Simpson, RestartedTransmittanceDiverges) {
    const double exact = exactScatter(kInterval);
    EXPECT_GT(simpsonRestarted(kInterval, 10), 1.3 * exact);
    EXPECT_GT(simpsonRestarted(kInterval, 100), 1.3 * exact);
}

TEST(Transmittance, TotalScatterIsExactForAnyNodes) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> exponent(-6, 4), entry(-4, 3), length(-4, 1);
    for (int c = 0; c < 2000; ++c) {
        const Interval interval{std::pow(10, exponent(random)), entry(random), std::pow(10, length(random)), 0, 0};
        const auto segment = segmentOf<float>(interval);
        for (int n = 1; n <= 3; ++n) {
            double sum = 0;
            for (int j = 0; j < n; ++j) sum += physics::transmittanceNode(segment, j, n).weight;
            ASSERT_NEAR(sum, -std::expm1(-static_cast<double>(segment.depth)), 4e-7 * sum) << n;
        }
    }
}

TEST(Transmittance, PartOfTheDepth) {
    Worst single, fit;
    for (double depth = 1e-9; depth < 80; depth *= 1.2) {
        for (const double xi : {0.02, 0.1127, 0.2113, 0.5, 0.7887, 0.8873, 0.98}) {
            const double exact = -std::log1p(xi * std::expm1(-depth)) / depth;
            fit.absolute(physics::depthPart(depth, xi), exact, depth, xi);
            single.absolute(physics::depthPart(static_cast<float>(depth), static_cast<float>(xi)), exact, depth, xi);
        }
    }
    EXPECT_LT(fit.deviation(), 2e-6) << fit;
    EXPECT_LT(single.deviation(), 4e-6) << single;
    EXPECT_EQ(physics::depthPart(0.0f, 0.25f), 0.25f);
    EXPECT_LT(physics::depthPart(1e30f, 0.5f), 1e-20f) << "all at the entry";
}

TEST(Transmittance, NodesLieWhereTheirShareOfLightIsAbsorbed) {
    // The opacity up to node i must be its Legendre node times the whole opacity.
    std::mt19937 random(13);
    std::uniform_real_distribution<double> exponent(-3, 2.5), entry(-3, 2), length(-1, 0.8);
    Worst single, fit;
    for (int c = 0; c < 2000; ++c) {
        const Interval interval{std::pow(10, exponent(random)), static_cast<float>(entry(random)),
                                static_cast<float>(std::pow(10, length(random))), 0, 0};
        const double half_line = interval.peak_line / 2;
        const double total = -std::expm1(-half_line * (std::erf(interval.a + interval.h) - std::erf(interval.a)));
        if (total < 1e-6) continue;
        const auto check = [&](Worst& worst, double z, int i, int n) {
            const double opacity = -std::expm1(-half_line * (std::erf(interval.a + z) - std::erf(interval.a)));
            worst.absolute(opacity / total, physics::legendreNode<double>(i, n), interval.peak_line, interval.a);
        };
        for (int n = 1; n <= 3; ++n) {
            for (int i = 0; i < n; ++i) {
                check(fit, physics::transmittanceNode(segmentOf<double>(interval), i, n).z, i, n);
                check(single, physics::transmittanceNode(segmentOf<float>(interval), i, n).z, i, n);
            }
        }
    }
    EXPECT_LT(fit.deviation(), 1e-4) << fit;
    EXPECT_LT(single.deviation(), 1e-3) << single;
}

TEST(Hermite, TotalScatterIsExact) {
    for (double line = 1e-6; line < 1e6; line *= 3) {
        const auto single = static_cast<float>(line);
        const auto first = physics::hermiteNode(single, 0.7f, 0), second = physics::hermiteNode(single, 0.7f, 1);
        EXPECT_NEAR(first.weight + second.weight, -std::expm1(-static_cast<double>(single)),
                    3e-7 * std::min(1.0, line));
        EXPECT_GE(first.weight, second.weight) << "the nearer node is seen better";
        EXPECT_FLOAT_EQ(second.z, 1 / std::sqrt(2.0f) / 0.7f);
        EXPECT_FLOAT_EQ(first.z, -second.z);
    }
    // T_V at the nodes from half (1 + erf q).
    const auto first = physics::hermiteNode(2.0, 1.0, 0), second = physics::hermiteNode(2.0, 1.0, 1);
    EXPECT_NEAR(second.weight / first.weight, std::exp(-2.0 * std::erf(std::sqrt(0.5))), 1e-12);
}

TEST(Hermite, ExactToThirdDegreeForThinParticles) {
    const auto first = physics::hermiteNode(1e-7, 1.0, 0), second = physics::hermiteNode(1e-7, 1.0, 1);
    const double square = first.weight * first.z * first.z + second.weight * second.z * second.z;
    EXPECT_NEAR(square / 1e-7, 0.5, 1e-6) << "variance of exp(-q^2)";
}

TEST(TruncatedHermite, NodesAreMeanAndDeviation) {
    Worst single, fit;
    for (double a = -3; a <= 2; a += 0.37) {
        for (double h = 0.1; h < 8; h *= 1.6) {
            const Interval interval{1.3, static_cast<float>(a), static_cast<float>(h), 0, 0};
            double mass = 0, first = 0, second = 0;
            const int n = 2000;
            for (int j = 0; j < n; ++j) {
                const double z = interval.h * (j + 0.5) / n, g = std::exp(-(interval.a + z) * (interval.a + z));
                mass += g;
                first += g * z;
                second += g * z * z;
            }
            const double mean = first / mass, deviation = std::sqrt(second / mass - mean * mean);
            for (const int i : {0, 1}) {
                const double exact = mean + (i == 0 ? -deviation : deviation);
                fit.absolute(physics::truncatedHermiteNode(segmentOf<double>(interval), i).z, exact, a, h);
                single.absolute(physics::truncatedHermiteNode(segmentOf<float>(interval), i).z, exact, a, h);
            }
        }
    }
    EXPECT_LT(fit.deviation(), 1e-4) << fit;
    EXPECT_LT(single.deviation(), 1e-3) << single;
    // The whole line: Hermite's nodes and weights.
    const auto whole = segmentOf<float>({1.3, -6, 12, 0, 0});
    for (const int i : {0, 1}) {
        const auto node = physics::truncatedHermiteNode(whole, i),
                   hermite = physics::hermiteNode(whole.line, whole.k, i);
        EXPECT_NEAR(node.z - 6, hermite.z, 3e-6);
        EXPECT_NEAR(node.weight, hermite.weight, 1e-6);
    }
}

// RMS relative error over random intervals of seed 000's kind, light depth linear along the ray.
double rmsError(double lo, double hi, const std::function<double(const Interval&)>& quadrature) {
    std::mt19937 random(17);
    std::uniform_real_distribution<double> unit(0, 1);
    double sum = 0;
    const int cases = 200;
    for (int c = 0; c < cases; ++c) {
        const double peak = lo + (hi - lo) * unit(random);
        const double light_in = peak * unit(random), light_out = peak * unit(random), h = 2 + 4 * unit(random);
        const Interval interval{peak, -h / 2 + (unit(random) - 0.5), h, light_in, (light_out - light_in) / h};
        const double exact = exactScatter(interval);
        sum += std::pow(quadrature(interval) / exact - 1, 2);
    }
    return std::sqrt(sum / cases);
}

TEST(Quadratures, RankAsExpected) {
    const auto simpsonSteps = [](int n) { return [n](const Interval& i) { return simpson<float>(i, n); }; };
    const auto points = [](int n) { return [n](const Interval& i) { return transmittance<float>(i, n); }; };
    struct Range {
        double lo, hi;
    };
    for (const Range& depth : {Range{0.02, 0.2}, Range{1, 5}, Range{10, 100}}) {
        const double s1 = rmsError(depth.lo, depth.hi, simpsonSteps(1)),
                     s2 = rmsError(depth.lo, depth.hi, simpsonSteps(2));
        const double s10 = rmsError(depth.lo, depth.hi, simpsonSteps(10));
        const double t1 = rmsError(depth.lo, depth.hi, points(1)), t2 = rmsError(depth.lo, depth.hi, points(2));
        const double t3 = rmsError(depth.lo, depth.hi, points(3)), tay = rmsError(depth.lo, depth.hi, taylor<float>);
        std::printf(
            "peak depth %g to %g: Simpson 1/2/10 %.3g %.3g %.3g, transmittance 1/2/3 %.3g %.3g %.3g, Taylor %.3g\n",
            depth.lo, depth.hi, s1, s2, s10, t1, t2, t3, tay);
        EXPECT_LT(t2, t1);
        EXPECT_LT(t3, t2);
        EXPECT_LT(s2, s1);
        EXPECT_LT(s10, s2);
        EXPECT_LT(t2, s2);
        EXPECT_GT(tay, 0.2) << "the Taylor series was expected to fail";
    }
}

TEST(Nodes, FiniteAndInsideForExtremeInputs) {
    const float sizes[] = {0, 1e-38f, 1e-20f, 1e-7f, 1e-3f, 0.3f, 1, 30, 1e5f, 1e10f, 1e19f, 1e38f};
    std::vector<float> entries;
    for (const float s : sizes) {
        entries.push_back(s);
        entries.push_back(-s);
    }
    for (const float sigma_t : sizes)
        for (const float k : sizes)
            for (const float b2 : sizes)
                for (const float a : entries)
                    for (const float h : sizes) {
                        const auto segment = physics::gaussianSegment(sigma_t, k, b2, a, h);
                        bool good = std::isfinite(segment.depth) && segment.depth >= 0 && std::isfinite(segment.peak);
                        const float length = segment.h / segment.k;
                        const auto check = [&](const physics::ScatterNode<float>& node, float lo, float hi) {
                            good =
                                good && std::isfinite(node.weight) && node.weight >= 0 && node.z >= lo && node.z <= hi;
                        };
                        for (int j = 0; j <= 4; j += 2) check(physics::simpsonNode(segment, j, 2), 0, length);
                        for (int j = 0; j < 3; ++j) {
                            const float source =
                                physics::segmentSource(segment, physics::taylorRule<float>(j, 1.0f / 16).along);
                            good = good && std::isfinite(source) && source >= 0;
                        }
                        for (int j = 0; j < 2; ++j) {
                            check(physics::transmittanceNode(segment, j, 2), 0, length * 1.0001f);
                            check(physics::truncatedHermiteNode(segment, j), 0, length * 1.0001f);
                            check(physics::hermiteNode(segment.line, segment.k, j), -1e38f, 1e38f);
                        }
                        ASSERT_TRUE(good)
                            << "sigma " << sigma_t << " k " << k << " b2 " << b2 << " a " << a << " h " << h;
                    }
}

TEST(Scatter, LinearQuantileInvertsTheDepthOfLinearExtinction) {
    for (const double a : {0.0, 1e-30, 1e-6, 1.0, 3.0, 1e6, 1e18})
        for (const double b : {0.0, 1e-6, 1.0, 1e18})
            for (double s = 0; s <= 1; s += 1.0 / 64) {
                const auto reached = [&](double x) { // the part of the depth before the part x of the length
                    return a + b > 0 ? (a * x + (b - a) * x * x / 2) / physics::linearDepth(a, b, 1.0) : x;
                };
                const double x = physics::linearQuantile(a, b, s);
                const float single = physics::linearQuantile(float(a), float(b), float(s));
                EXPECT_NEAR(reached(x), s, 1e-14) << a << ' ' << b;
                EXPECT_NEAR(reached(double(single)), s, 3e-7) << a << ' ' << b;
                EXPECT_TRUE(x >= 0 && x <= 1 && single >= 0 && single <= 1) << a << ' ' << b << ' ' << s;
            }
    EXPECT_EQ(physics::linearQuantile(0.0f, 0.0f, 0.25f), 0.25f) << "no extinction";
    EXPECT_EQ(physics::linearQuantile(0.0f, 2.0f, 0.25f), 0.5f) << "it grows from nothing: the depth as the square";
}

} // namespace
