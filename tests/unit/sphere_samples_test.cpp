// Samples in spheres: what they say of a quantity between them.
#include <gtest/gtest.h>

#include "shaders/shared/sphere_samples.h"
#include "tests/unit/exact.h"

namespace brume {
namespace {

// Relative RMSE of what samples on a lattice of width 1 say of 3 + 2 x - y + 0.5 z, at places between them. Their
// spheres have radius 1.2. `part`: of the derivatives that they have.
float errorOfLinear(float part, bool printed) {
    const auto field = [](const glm::vec3& x) { return 3 + 2 * x.x - x.y + 0.5f * x.z; };
    const glm::vec3 slope(2, -1, 0.5f);
    double errors = 0, values = 0;
    for (int place = 0; place < 200; ++place) {
        const glm::vec3 x(0.37f + 0.01f * float(place % 50), 0.11f + 0.004f * float(place),
                          0.71f - 0.003f * float(place));
        float sum = 0, weights = 0;
        for (int i = 0; i < 27; ++i) {
            const glm::vec3 sample(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1), off = x - sample;
            const float weight = physics::sampleWeight(glm::length(off) / 1.2f, printed);
            sum += weight * (field(sample) + part * glm::dot(off, slope));
            weights += weight;
        }
        const float off = sum / weights - field(x);
        errors += double(off * off), values += double(field(x) * field(x));
    }
    return float(std::sqrt(errors / values));
}

// Equation 5: a sphere twice as wide counts eight times.
TEST(SphereSamples, TheShadingErrorIsThatOfHand) {
    EXPECT_EQ(physics::shadingError(2.0f, 0.25f, 0.5f), 1.0f);
    EXPECT_EQ(physics::shadingError(1.0f, 0.25f, 0.5f), 0.125f);
}

TEST(SphereSamples, PlanesGiveALinearFieldBack) {
    EXPECT_LE(errorOfLinear(1, false), 1e-5f);
    EXPECT_LE(errorOfLinear(1, true), 1e-5f);
}
TEST(SphereSamples, MeansDoNot) {
    EXPECT_GE(errorOfLinear(0, false), 0.02f);
    EXPECT_GE(errorOfLinear(0, true), 0.02f);
}

TEST(SphereSamples, WeightsEndAtTheRim) {
    for (const bool printed : {false, true}) {
        EXPECT_EQ(physics::sampleWeight(1.0, printed), 0);
        EXPECT_EQ(physics::sampleWeight(1e30, printed), 0);
        EXPECT_GE(physics::sampleWeight(0.0, printed), 1);
        double before = physics::sampleWeight(0.0, printed);
        for (double q = 0.01; q < 1; q += 0.01) {
            const double weight = physics::sampleWeight(q, printed);
            EXPECT_LT(weight, before) << q;
            before = weight;
        }
        EXPECT_NEAR(before, printed ? 1 / 0.99 : 0.0121, 1e-4);
    }
}

} // namespace
} // namespace brume
