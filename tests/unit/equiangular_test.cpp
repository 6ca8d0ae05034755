// Places and weights along a ray by the angle that a light sees, in float32 against long double, and light of a point
// in fog against the published exact value.
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "shaders/shared/equiangular.h"
#include "tests/unit/worst.h"

namespace brume {
namespace {

// Integral of dt / (t^2 + h^2) without cancellation.
long double exactWeight(long double h, long double a, long double b) {
    return std::atan2(h * (b - a), h * h + a * b) / h;
}

TEST(Equiangular, WeightsInFloat) {
    Worst worst;
    for (const float h : {1e-6f, 1e-4f, 0.03f, 1.0f, 200.0f, 1e4f})
        for (const float a : {-1e5f, -300.0f, -1.0f, -1e-3f, 0.0f, 0.01f, 5.0f, 1e4f})
            for (const float length : {1e-3f, 0.5f, 30.0f, 1e5f}) {
                const float b = a + length;
                if (!(b > a)) continue;
                const float value = physics::equiangularWeight(physics::equiangularPart(h, a, b));
                worst.relative(double(value), double(exactWeight(h, a, b)), double(h), double(a));
            }
    EXPECT_LT(worst.deviation(), 1e-6) << worst;
}

TEST(Equiangular, PlacesDivideTheAngle) {
    for (const float h : {1e-4f, 0.03f, 1.0f, 200.0f})
        for (const auto& [a, b] : {std::pair{-300.0f, 400.0f}, {-1.0f, 0.5f}, {0.01f, 30.0f}, {-50.0f, -0.2f}}) {
            const auto part = physics::equiangularPart(h, a, b);
            float before = a;
            for (const float u : {0.1f, 0.3f, 0.5f, 0.77f, 0.95f}) {
                const float t = physics::equiangularPlace(part, u);
                EXPECT_GT(t, before) << h << ' ' << a << ' ' << u;
                EXPECT_LT(t, b) << h << ' ' << a << ' ' << u;
                const long double angle = exactWeight(h, a, t) * h;
                EXPECT_NEAR(double(angle / part.angle), double(u), 2e-5) << h << ' ' << a << ' ' << u;
                before = t;
            }
        }
}

// Sun, Ramamoorthi, Narasimhan and Nayar, A Practical Analytic Single Scattering Model for Real Time Rendering, 2005: a
// point of intensity 2 seen under 0.5 rad from 4 m away in isotropic fog of extinction 0.3/m and albedo 1, 9 m deep.
TEST(Equiangular, FourNodesOfAPointInFog) {
    const double extinction = 0.3, intensity = 2, distance = 4, angle = 0.5, depth = 9;
    const double closest = distance * std::cos(angle), h = distance * std::sin(angle);
    const auto part = physics::equiangularPart(h, -closest, depth - closest);
    constexpr std::array<std::pair<double, double>, 4> kNodes{{{0.069431844202974, 0.173927422568727},
                                                               {0.330009478207572, 0.326072577431273},
                                                               {0.669990521792428, 0.326072577431273},
                                                               {0.930568155797026, 0.173927422568727}}};
    double sum = 0;
    for (const auto& [u, weight] : kNodes) {
        const double t = physics::equiangularPlace(part, u), from_light = std::hypot(t, h);
        sum += weight * std::exp(-extinction * (closest + t + from_light));
    }
    sum *= intensity * extinction / (4 * 3.14159265358979324) * physics::equiangularWeight(part);
    EXPECT_NEAR(sum / 0.010059723129, 1, 5e-4);
}

} // namespace
} // namespace brume
