// How fast the renderer's quadratures (shaders/shared/scatter.h, here in double) converge: their order, not only their
// error.
#include <cmath>
#include <cstdio>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <gtest/gtest.h>

#include "shaders/shared/scatter.h"

namespace {

using namespace brume;
using Segment = physics::GaussianSegment<double>;

constexpr double kSqrtPi = 1.7724538509055160273;

// k = 1; a and h in units of 1/k.
Segment segmentOf(double line, double a, double h) { return physics::gaussianSegment(line / kSqrtPi, 1.0, 0.0, a, h); }

// Integral of S T_V sigma over the segment: adaptive, with libm's erf.
template <typename Light>
double exact(double line, double a, double h, const Light& light) {
    const auto f = [&](double z) {
        const double q = a + z;
        return line / kSqrtPi * std::exp(-q * q - line / 2 * (std::erf(q) - std::erf(a))) * light(z);
    };
    double sum = 0;
    for (int p = 0; p < 8; ++p)
        sum += boost::math::quadrature::gauss_kronrod<double, 15>::integrate(f, h * p / 8, h * (p + 1) / 8, 10, 1e-13);
    return sum;
}

// Twice as many steps, a sixteenth of the error.
TEST(Order, SimpsonIsOfFourth) {
    for (const double line : {0.3, 2.0, 6.0}) {
        const double a = -0.9, h = 1.5;
        const auto light = [](double z) { return std::exp(-0.4 - 0.8 * z - 0.3 * z * z); };
        const double truth = exact(line, a, h, light);
        const auto error = [&](int n) {
            const Segment segment = segmentOf(line, a, h);
            double sum = 0;
            for (int j = 0; j <= 2 * n; ++j) {
                const auto node = physics::simpsonNode(segment, j, n);
                sum += node.weight * light(node.z);
            }
            return sum / truth - 1;
        };
        // Between 4 and 8 steps: fewer are no limit yet, more would show erfcx's 4e-7.
        const double order = std::log2(error(4) / error(8));
        std::printf("Simpson, depth %g: errors %.2e %.2e, order %.2f\n", line, error(4), error(8), order);
        EXPECT_GT(std::abs(error(8)), 1.5e-6);
        EXPECT_NEAR(order, 4, 0.3) << line;
    }
}

// n Gauss-Legendre nodes in opacity y: for S = e^(-c t), t = view depth, S = (1 - y)^c, the relative error falls as
// depth^(2n).
TEST(Order, TransmittanceSpaceIsOfTwiceItsNodes) {
    const double c = 6, a = -1, h = 2;
    for (const int n : {1, 2}) { // 3 nodes are below the form's own error at once
        const auto error = [&](double line) {
            const Segment segment = segmentOf(line, a, h);
            double sum = 0;
            for (int i = 0; i < n; ++i) {
                const auto node = physics::transmittanceNode(segment, i, n);
                sum += node.weight * std::exp(-c * line / 2 * (std::erf(a + node.z) - std::erf(a)));
            }
            const double depth = line * std::erf(1.0);
            return sum / (-std::expm1(-(1 + c) * depth) / (1 + c)) - 1;
        };
        const double line = n == 1 ? 0.1 : 0.4, order = std::log2(error(line) / error(line / 2));
        std::printf("transmittance space, %d nodes: errors %.2e %.2e, order %.2f\n", n, error(line), error(line / 2),
                    order);
        EXPECT_GT(std::abs(error(line / 2)), 1e-5);
        EXPECT_NEAR(order, 2 * n, 0.3) << n;
    }
}

// Two Gauss-Hermite nodes are exact for cubics: for S = e^(-s z) through a thin particle the error is of fourth order
// in s.
TEST(Order, HermiteIsOfFourth) {
    const double line = 1e-7; // thin: the weights are then Hermite's own
    const auto error = [&](double slope) {
        double sum = 0;
        for (int i = 0; i < 2; ++i) {
            const auto node = physics::hermiteNode(line, 1.0, i);
            sum += node.weight * std::exp(-slope * node.z);
        }
        return sum / (line * std::exp(slope * slope / 4)) - 1; // the integral of a Gaussian times e^(-s z)
    };
    const double order = std::log2(error(0.8) / error(0.4));
    std::printf("Gauss-Hermite: errors %.2e %.2e, order %.2f\n", error(0.8), error(0.4), order);
    EXPECT_NEAR(order, 4, 0.3);
}

// 000's light depth, linear between entry and exit, does not converge to the true one with more steps: its limit is
// another.
TEST(Order, LinearLightDepthHasALimitOfItsOwn) {
    const double line = 3, a = -2.5, h = 5;
    const auto depth = [&](double z) { return line / 2 * std::erfc(-(a + z)); }; // lit from behind: what lies beyond
    const double truth = exact(line, a, h, [&](double z) { return std::exp(-depth(z)); });
    const auto error = [&](int n) {
        const Segment segment = segmentOf(line, a, h);
        double sum = 0;
        for (int j = 0; j <= 2 * n; ++j) {
            const auto node = physics::simpsonNode(segment, j, n);
            sum += node.weight * std::exp(-glm::mix(depth(0), depth(h), node.z / h));
        }
        return sum / truth - 1;
    };
    EXPECT_GT(std::abs(error(10)), 0.01);
    EXPECT_NEAR(error(40), error(160), 1e-4) << "converged, to something else";
}

} // namespace
