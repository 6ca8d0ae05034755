// Phase functions: normalisation, mean cosine, reciprocity, and the stable form at strong asymmetry.
#include <gtest/gtest.h>

#include "common/phase_lobes.h"
#include "shaders/shared/phase.h"
#include "tests/unit/exact.h"
#include "tests/unit/worst.h"

namespace {

using namespace brume;

constexpr double kPi = 3.14159265358979323846;

// Directions of travel that enclose the angle theta, away from the axes.
template <typename real>
struct Pair {
    glm::vec<3, real> in, out;
};
template <typename real>
Pair<real> pairAt(double theta) {
    const glm::dvec3 in = glm::normalize(glm::dvec3(0.3, -0.8, 0.52));
    const glm::dvec3 across = glm::normalize(glm::cross(in, glm::dvec3(0.1, 0.2, 0.97)));
    return {glm::vec<3, real>(in), glm::vec<3, real>(std::cos(theta) * in + std::sin(theta) * across)};
}

// Integrates p and p cos over the sphere; theta = e^t resolves the narrow peak.
struct Moments {
    double total = 0, cosine = 0;
};
Moments moments(const PhaseLobes& lobes) {
    const auto& [part, g, alpha, second] = lobes;
    const bool backward = g < 0 || second < 0;
    Moments m;
    const int n = 20000;
    const double lo = std::log(1e-8), step = (std::log(kPi) - lo) / n;
    for (int i = 0; i < n; ++i) {
        const double angle = std::exp(lo + (i + 0.5) * step);
        const double theta = backward ? kPi - angle : angle; // measured from the peak
        const Pair<double> pair = pairAt<double>(theta);
        const double ring = 2 * kPi * std::sin(angle) * angle * step;
        const double p = physics::phaseOfLobes(pair.in, pair.out, part, g, alpha, second);
        m.total += p * ring;
        m.cosine += p * ring * std::cos(theta);
    }
    return m;
}

TEST(HenyeyGreenstein, IntegratesToOneWithMeanCosineG) {
    for (const double g : {-0.999, -0.8, -0.3, 0.0, 1e-9, 0.3, 0.76, 0.95, 0.999}) {
        const Moments m = moments({1, g});
        EXPECT_NEAR(m.total, 1, 1e-6) << g;
        EXPECT_NEAR(m.cosine, g, 1e-6) << g;
    }
}

TEST(Mixture, IntegratesToOneWithMeanCosineAG) {
    const Moments m = moments({0.35, 0.8});
    EXPECT_NEAR(m.total, 1, 1e-6);
    EXPECT_NEAR(m.cosine, 0.35 * 0.8, 1e-6);
    const Pair<float> pair = pairAt<float>(1);
    EXPECT_FLOAT_EQ(physics::phaseOfLobes(pair.in, pair.out, 0.0f, 0.9f, 0.0f, 0.0f),
                    static_cast<float>(1 / (4 * kPi)));
}

// Mean cosine of Draine's function, as the header gives it.
double meanCosine(double g, double alpha) {
    return g * (1 + alpha * (3 + 2 * g * g) / 5) / (1 + alpha * (1 + 2 * g * g) / 3);
}

TEST(Draine, IntegratesToOneWithItsMeanCosine) {
    for (const double g : {-0.8, 0.0, 0.3, 0.76, 0.95})
        for (const double alpha : {0.0, 0.5, 1.0, 22.0, 1e4}) {
            const Moments m = moments({1, g, alpha});
            EXPECT_NEAR(m.total, 1, 1e-6) << g << ' ' << alpha;
            EXPECT_NEAR(m.cosine, meanCosine(g, alpha), 1e-6) << g << ' ' << alpha;
        }
}

TEST(Draine, IsRayleighWithoutALobe) {
    for (const double theta : {0.0, 0.4, 1.5707963, 2.0, 3.1}) {
        const Pair<double> pair = pairAt<double>(theta);
        const double cosine = std::cos(theta);
        EXPECT_NEAR(physics::phaseDraine(pair.in, pair.out, 0.0, 1.0), 3 / (16 * kPi) * (1 + cosine * cosine), 1e-14);
    }
}

TEST(Double, IntegratesToOneWithBothMeanCosines) {
    Medium medium;
    medium.phase = kDoublePhase;
    medium.anisotropy = 0.7f;
    medium.asymmetry = 0.8f;
    medium.second_asymmetry = 0.3f;
    const Moments m = moments(lobesOf(medium));
    EXPECT_NEAR(m.total, 1, 1e-6);
    EXPECT_NEAR(m.cosine, 0.7 * 0.8 + 0.3 * 0.3, 1e-6);
}

// Mie theory gives a mean cosine of 0.85 to 0.88 to cloud droplets in visible light, growing with the diameter.
TEST(Droplets, ScatterForwardAsCloudsDo) {
    double last = 0;
    for (const float diameter : {5.0f, 10.0f, 20.0f, 50.0f}) {
        Medium medium;
        medium.phase = kDropletPhase;
        medium.droplet = diameter;
        const PhaseLobes lobes = lobesOf(medium);
        const Moments m = moments(lobes);
        EXPECT_NEAR(m.total, 1, 1e-6) << diameter;
        EXPECT_NEAR(m.cosine, (1 - lobes.part) * lobes.second + lobes.part * meanCosine(lobes.asymmetry, lobes.draine),
                    1e-6);
        EXPECT_GT(m.cosine, std::max(last, 0.8)) << diameter;
        EXPECT_LT(m.cosine, 0.9) << diameter;
        last = m.cosine;
        // Brighter straight back than across: the light that a fog bow and a glory have.
        const auto at = [&](double theta) {
            const Pair<double> pair = pairAt<double>(theta);
            return physics::phaseOfLobes(pair.in, pair.out, lobes.part, lobes.asymmetry, lobes.draine, lobes.second);
        };
        EXPECT_GT(at(kPi), 1.5 * at(0.55 * kPi)) << diameter;
    }
}

TEST(Droplets, AreStableInFloatAtTheirPeak) {
    Worst stable;
    const PhaseLobes lobes = dropletLobes(50);
    for (double theta = 0; theta < kPi; theta = theta * 1.1 + 1e-4) {
        const Pair<float> pair = pairAt<float>(theta);
        const glm::dvec3 in = glm::normalize(glm::dvec3(pair.in)), out = glm::normalize(glm::dvec3(pair.out));
        const double exact = physics::phaseOfLobes(in, out, double(float(lobes.part)), double(float(lobes.asymmetry)),
                                                   double(float(lobes.draine)), double(float(lobes.second)));
        const float got = physics::phaseOfLobes(pair.in, pair.out, float(lobes.part), float(lobes.asymmetry),
                                                float(lobes.draine), float(lobes.second));
        stable.relative(got, exact, theta);
    }
    EXPECT_LT(stable.deviation(), 3e-5) << stable;
}

// The control: what engines use in place of Henyey-Greenstein, and why nothing is drawn with it here.
TEST(Schlick, DiffersFromHenyeyGreensteinAndDiverges) {
    const auto mean = [](double g) {
        Moments m;
        const int n = 20000;
        for (int i = 0; i < n; ++i) {
            const double theta = (i + 0.5) * kPi / n;
            const Pair<double> pair = pairAt<double>(theta);
            const double p = physics::phaseSchlick(pair.in, pair.out, g), ring = 2 * kPi * std::sin(theta) * kPi / n;
            m.total += p * ring;
            m.cosine += p * ring * std::cos(theta);
        }
        return m;
    };
    EXPECT_NEAR(mean(0.6).total, 1, 1e-5);
    EXPECT_NEAR(mean(0.6).cosine, 0.645, 1e-3);
    const Pair<double> forward = pairAt<double>(0.0);
    EXPECT_LT(physics::phaseSchlick(forward.in, forward.out, 0.95), 0) << "k is 1.0009";
}

TEST(HenyeyGreenstein, ForwardIsForward) {
    const glm::vec3 travel(0, 0, -1);
    EXPECT_GT(physics::phaseHenyeyGreenstein(travel, travel, 0.5f),
              physics::phaseHenyeyGreenstein(travel, -travel, 0.5f));
    EXPECT_FLOAT_EQ(physics::phaseHenyeyGreenstein(travel, travel, 0.5f),
                    static_cast<float>(exact::henyeyGreenstein(1, 0.5)));
    EXPECT_FLOAT_EQ(physics::phaseHenyeyGreenstein(travel, -travel, 0.5f),
                    static_cast<float>(exact::henyeyGreenstein(-1, 0.5)));
}

TEST(HenyeyGreenstein, Reciprocal) {
    // Light that travels the path backward enters along -out and leaves along -in.
    for (const float g : {-0.9f, 0.2f, 0.99f}) {
        for (const double theta : {0.0, 0.01, 1.0, 3.0}) {
            const Pair<float> pair = pairAt<float>(theta);
            EXPECT_FLOAT_EQ(physics::phaseHenyeyGreenstein(pair.in, pair.out, g),
                            physics::phaseHenyeyGreenstein(-pair.out, -pair.in, g));
        }
    }
}

TEST(HenyeyGreenstein, StableAtThePeak) {
    Worst stable, naive;
    for (const float g : {0.999f, -0.999f}) {
        for (double angle = 0; angle < 0.01; angle += 1e-4) {
            const double theta = g < 0 ? kPi - angle : angle;
            const Pair<float> pair = pairAt<float>(theta);
            // Of the rounded directions, not of theta: the rounding is the caller's.
            const glm::dvec3 in = glm::normalize(glm::dvec3(pair.in)), out = glm::normalize(glm::dvec3(pair.out));
            const double side = g < 0 ? -1 : 1;
            const double d =
                (1 - std::abs(g)) * (1.0 - std::abs(g)) + std::abs(g) * glm::dot(in - side * out, in - side * out);
            const double exact = (1 - static_cast<double>(g) * g) / (4 * kPi * d * std::sqrt(d));
            stable.relative(physics::phaseHenyeyGreenstein(pair.in, pair.out, g), exact, angle, g);
            const float cosine = glm::dot(pair.in, pair.out);
            const float base = 1 + g * g - 2 * g * cosine;
            naive.relative((1 - g * g) / (4 * static_cast<float>(kPi) * base * std::sqrt(base)), exact, angle, g);
        }
    }
    EXPECT_LT(stable.deviation(), 5e-4) << stable; // 1 - |g| itself is known to 6e-5, the directions to 6e-8
    EXPECT_GT(naive.deviation(), 0.1) << "the form with the cosine was expected to fail: " << naive;
}

TEST(HenyeyGreenstein, FiniteForAnyAsymmetry) {
    const glm::vec3 travel(1, 0, 0);
    for (const float g : {-1.0f, -0.9999999f, 0.0f, 0.9999999f, 1.0f}) {
        EXPECT_TRUE(std::isfinite(physics::phaseHenyeyGreenstein(travel, travel, g))) << g;
        EXPECT_TRUE(std::isfinite(physics::phaseHenyeyGreenstein(travel, -travel, g))) << g;
    }
}

} // namespace
