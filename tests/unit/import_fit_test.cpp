// The fit of Gaussians to voxels: laws that hold whatever the volume is, and closed forms.
#include "tools/import/fit.h"

#include <cmath>
#include <cstring>
#include <numbers>

#include <gtest/gtest.h>

#include "tools/import/octree.h"
#include "tools/import/path.h"
#include "tools/import/pictures.h"
#include "tools/import/rasterise.h"
#include "tools/import/rays.h"
#include "tools/import/samples.h"

namespace brume::volumes::fit_test {
namespace {

Voxels noise() {
    return sampled(glm::ivec3(-20), glm::ivec3(20), 0, [](glm::ivec3 v) {
        const double edge = 1 - glm::dot(glm::dvec3(v), glm::dvec3(v)) / 400;
        return std::max(2 * fractalNoise(glm::dvec3(v) / 24.0, 3, 3) - 1 + float(edge), 0.0f) * float(edge > 0);
    });
}

Voxels cube(int side, float value) {
    return sampled(glm::ivec3(0), glm::ivec3(side - 1), 0, [&](glm::ivec3) { return value; });
}

double massOf(const std::vector<Kernel>& kernels) {
    double sum = 0;
    for (const Kernel& kernel : kernels) sum += double(kernel.mass);
    return sum;
}

// Samples of a Gaussian whose deviation between the samples is that of the kernel's.
Voxels samplesOf(const Kernel& kernel) {
    const double deviation = std::sqrt(kernel.spread[0][0]);
    const double peak = double(kernel.mass) / std::pow(deviation * std::sqrt(2 * std::numbers::pi), 3);
    const Ball ball{kernel.at, deviation, peak};
    return rasterised({&ball, 1}, 0).voxels;
}

TEST(ImportFit, KeepsTheMass) {
    const Voxels voxels = noise();
    for (const double error : {0.1, 0.01}) {
        const Fit found = fit(voxels, {.error = error, .per_value = 0.1});
        EXPECT_NEAR(massOf(found.kernels) / voxels.sum(), 1, 1e-6);
        for (const Kernel& kernel : found.kernels) ASSERT_GT(kernel.mass, 0);
    }
}

TEST(ImportFit, RoundsKeepTheMassByThemselves) {
    const Voxels voxels = noise();
    Mixture mixture(voxels, {}, Octree(voxels, {}, 0.1, false).choose(1e-6));
    mixture.refine(3, Follow::place_and_width);
    EXPECT_NEAR(massOf(mixture.kernels()) / voxels.sum(), 1, 1e-4); // single precision in each round
}

TEST(ImportFit, FindsAGaussianOfTheLatticeAgain) {
    const Shape shape;
    Kernel truth = kernelOf(shape, 2, {1, 2, -1}, 5);
    const Voxels voxels = samplesOf(truth);
    std::vector<Kernel> lattice;
    for (int n = 0; n < 27; ++n)
        lattice.push_back(kernelOf(shape, 2, truth.cell + glm::ivec3(n / 9, n / 3 % 3, n % 3) - 1, 1));
    Mixture mixture(voxels, shape, lattice);
    mixture.refine(200, Follow::nothing);
    for (const Kernel& kernel : mixture.kernels()) // the others go to 0, ever slower
        EXPECT_NEAR(kernel.mass, kernel.cell == truth.cell ? 5 : 0, kernel.cell == truth.cell ? 0.25 : 0.05);
}

TEST(ImportFit, FindsPlaceAndWidthOfAGaussianBesideTheLattice) {
    const Shape shape;
    Kernel truth = kernelOf(shape, 2, {0, 0, 0}, 3);
    truth.at += glm::dvec3(0.7, -1.1, 0.4);
    truth.spread *= 1.2 * 1.2;
    const Voxels voxels = samplesOf(truth);
    Mixture mixture(voxels, shape, {kernelOf(shape, 2, {0, 0, 0}, 1)});
    mixture.refine(40, Follow::place_and_width);
    const Kernel& found = mixture.kernels().front();
    EXPECT_LT(glm::length(found.at - truth.at), 0.01);
    EXPECT_NEAR(std::sqrt(found.spread[0][0] / truth.spread[0][0]), 1, 0.02); // it ends at 3.4 deviations
    EXPECT_NEAR(found.mass, 3, 0.02);                                         // so some mass lies beyond
}

// A disc, tilted against the lattice.
Kernel disc() {
    Kernel out = kernelOf({}, 3, {0, 0, 0}, 40);
    const glm::dvec3 normal = glm::normalize(glm::dvec3(1, 2, -1)), u = acrossOf(normal), v = glm::cross(normal, u);
    const glm::dmat3 unit(u, v, normal);
    glm::dmat3 scaled = unit;
    scaled[0] *= 5.5 * 5.5, scaled[1] *= 3.0 * 3.0, scaled[2] *= 0.9 * 0.9;
    out.spread = scaled * glm::transpose(unit);
    out.at += glm::dvec3(0.8, -0.6, 1.1);
    return out;
}

// Samples of a Gaussian at the voxels' centres, by its formula.
Voxels samplesOfAny(const Kernel& kernel) {
    const glm::dmat3 precision = glm::inverse(kernel.spread);
    const double peak =
        double(kernel.mass) / std::sqrt(std::pow(2 * std::numbers::pi, 3) / glm::determinant(precision));
    return sampled(glm::ivec3(-32), glm::ivec3(40), 0, [&](glm::ivec3 voxel) {
        const glm::dvec3 d = glm::dvec3(voxel) - kernel.at;
        return float(peak * std::exp(-0.5 * glm::dot(d, precision * d)));
    });
}

TEST(ImportFit, FindsTheAxesOfATiltedDisc) {
    const Kernel truth = disc();
    const Voxels voxels = samplesOfAny(truth);
    Mixture mixture(voxels, {}, {kernelOf({}, 3, {0, 0, 0}, 1)});
    mixture.refine(40, Follow::place_and_axes);
    const Kernel& found = mixture.kernels().front();
    EXPECT_LT(glm::length(found.at - truth.at), 0.01);
    EXPECT_NEAR(found.mass / truth.mass, 1, 0.005);
    const glm::dvec3 got = principalAxes(found.spread).deviation, meant = principalAxes(truth.spread).deviation;
    EXPECT_NEAR(std::min({got.x, got.y, got.z}) / std::min({meant.x, meant.y, meant.z}), 1, 0.02); // it ends at 4
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) EXPECT_NEAR(found.spread[i][j], truth.spread[i][j], 0.02 * 5.5 * 5.5);
}

TEST(ImportFit, WeightsOfEllipsoidsAddUpToTheirMass) {
    for (const double thin : {0.35, 0.45, 0.7, 2.0}) {
        Kernel kernel = disc();
        kernel.spread = clampedSpread(kernel.spread, thin, std::max(thin, 4.0));
        const Voxels around = sampled(glm::ivec3(-32), glm::ivec3(40), -1, [](glm::ivec3) { return 1.0f; });
        double sum = 0;
        for (const float value : Mixture(around, {}, {kernel}).sums()) sum += double(value);
        EXPECT_NEAR(sum / double(kernel.mass), 1, 2e-3) << thin;
    }
}

TEST(ImportFit, EllipsoidsAreFewerForASlantedSheet) {
    const Voxels voxels = sampled(glm::ivec3(-16), glm::ivec3(16), 1e-3f, [](glm::ivec3 v) {
        const double off = glm::dot(glm::dvec3(v), glm::normalize(glm::dvec3(2, 5, 1)));
        const double across = glm::dot(glm::dvec3(v), glm::dvec3(v)) - off * off;
        return float(std::exp(-off * off / 4 - across / 100));
    });
    const Fit balls = fit(voxels, {.error = 0.05, .per_value = 0.1});
    const Fit ellipsoids = fit(voxels, {.error = 0.05, .per_value = 0.1, .ellipsoids = true});
    EXPECT_TRUE(balls.kept);
    EXPECT_TRUE(ellipsoids.kept);
    EXPECT_LT(ellipsoids.kernels.size() * 5, balls.kernels.size());
    EXPECT_NEAR(massOf(ellipsoids.kernels) / voxels.sum(), 1, 1e-6);
    const Rays others(voxels, 0.1, 64, 20, 99);
    EXPECT_LE(others.errorOf(ellipsoids.kernels).worst(), 1.1 * 0.05);
}

TEST(ImportFit, AnEvenCubeIsEvenInside) {
    const Voxels voxels = cube(48, 1);
    const Shape shape;
    std::vector<Kernel> lattice;
    for (int n = 0; n < 12 * 12 * 12; ++n) lattice.push_back(kernelOf(shape, 2, {n / 144, n / 12 % 12, n % 12}, 64));
    Mixture mixture(voxels, shape, lattice);
    mixture.refine(24, Follow::nothing);
    const std::vector<float> sums = mixture.sums();
    double worst = 0;
    for (size_t i = 0; i < sums.size(); ++i) {
        const glm::ivec3 voxel = voxelOf(voxels.blocks()[i / kInBlock], i % kInBlock);
        if (glm::clamp(voxel, 16, 31) == voxel) worst = std::max(worst, std::abs(double(sums[i]) - 1));
    }
    // Three axes' ripple of 2 exp(-2 pi^2 0.59^2), and the edges' ringing.
    EXPECT_LT(worst, 0.02);
}

TEST(ImportFit, ABoundHoldsOnOtherRaysToo) {
    const Voxels voxels = noise();
    const Rays others(voxels, 0.1, 64, 20, 99);
    size_t last = 0;
    for (const double error : {0.05, 0.01}) {
        const Fit found = fit(voxels, {.error = error, .per_value = 0.1});
        EXPECT_TRUE(found.kept);
        EXPECT_LE(found.error.worst(), error);
        EXPECT_LE(others.errorOf(found.kernels).worst(), 1.1 * error); // rays at random: some hundredths off
        EXPECT_GT(found.kernels.size(), last);
        last = found.kernels.size();
    }
    EXPECT_LT(last * 5, voxels.active());
}

TEST(ImportFit, TooFewParticlesAreSaid) {
    const Voxels voxels = noise();
    const Fit found = fit(voxels, {.error = 1e-3, .most = 100, .per_value = 0.1});
    EXPECT_FALSE(found.kept);
    EXPECT_FALSE(found.all);
    EXPECT_LE(found.kernels.size(), 100u);
    EXPECT_GT(found.kernels.size(), 10u);
    EXPECT_NEAR(massOf(found.kernels) / voxels.sum(), 1, 1e-6);
}

TEST(ImportFit, TwoRunsAreEqual) {
    const Voxels voxels = noise();
    const auto run = [&] { return fit(voxels, {.error = 0.03, .per_value = 0.1}).kernels; };
    const std::vector<Kernel> a = run(), b = run();
    ASSERT_EQ(a.size(), b.size());
    for (size_t i = 0; i < a.size(); ++i) {
        EXPECT_EQ(a[i].at, b[i].at);
        EXPECT_EQ(a[i].mass, b[i].mass);
        EXPECT_EQ(a[i].spread, b[i].spread);
    }
}

TEST(ImportFit, ALonelyVoxelGetsAParticle) {
    const Voxels voxels = cube(1, 2);
    const Fit found = fit(voxels, {.error = 0.5, .per_value = 1});
    ASSERT_EQ(found.kernels.size(), 1u);
    EXPECT_NEAR(found.kernels[0].mass, 2, 1e-6);
    EXPECT_LT(glm::length(found.kernels[0].at), 1.1);
}

TEST(ImportRays, IntegralsOfClosedForm) {
    const Voxels voxels = cube(8, 2);
    EXPECT_NEAR(integralAlong(voxels, {3.3, 4.7, 0}, {0, 0, 1}), 16, 1e-12);
    EXPECT_NEAR(integralAlong(voxels, {3.3, 100, 3}, {0, -1, 0}), 16, 1e-12);
    EXPECT_NEAR(integralAlong(voxels, {3, 7.5, 0}, {0, 0, 1}), 8, 1e-12); // half a voxel beside the last
    EXPECT_EQ(integralAlong(voxels, {3, 8.1, 0}, {0, 0, 1}), 0);
    EXPECT_EQ(integralAlong(voxels, {-50, 40, 0}, glm::normalize(glm::dvec3(1, 1, 0))), 0);
}

TEST(ImportRays, IntegralsOfManySteps) {
    const Voxels voxels = noise();
    const auto at = [&](glm::dvec3 p) {
        const glm::dvec3 base = glm::floor(p), part = p - base;
        double sum = 0;
        for (int n = 0; n < 8; ++n) {
            const glm::ivec3 corner(n & 1, n >> 1 & 1, n >> 2);
            const glm::dvec3 w = glm::mix(1.0 - part, part, glm::dvec3(corner));
            sum += w.x * w.y * w.z * double(voxels.at(glm::ivec3(base) + corner));
        }
        return sum;
    };
    for (const glm::dvec3 toward : {glm::dvec3(1, 2, 3), glm::dvec3(-3, 1, 0), glm::dvec3(0.1, -1, 2)}) {
        const glm::dvec3 unit = glm::normalize(toward), through(1.3, -2.2, 0.7);
        constexpr int kSteps = 60'000;
        constexpr double kFar = 40, kStep = 2 * kFar / kSteps;
        double sum = 0;
        for (int i = 0; i < kSteps; ++i) sum += kStep * at(through + ((i + 0.5) * kStep - kFar) * unit);
        ASSERT_GT(sum, 1);
        EXPECT_NEAR(integralAlong(voxels, through, unit) / sum, 1, 1e-6);
    }
}

TEST(ImportRays, HalvedVoxelsAreTheSameFunction) {
    const Voxels voxels = noise(), fine = halved(voxels);
    EXPECT_NEAR(fine.sum() / (8 * voxels.sum()), 1, 1e-6);
    const glm::dvec3 unit = glm::normalize(glm::dvec3(1, -2, 0.5)), through(1.3, -2.2, 0.7);
    EXPECT_NEAR(integralAlong(fine, 2.0 * through, unit) / (2 * integralAlong(voxels, through, unit)), 1, 1e-6);
}

TEST(ImportRays, AGaussianItselfHasHardlyAnError) {
    Kernel kernel = kernelOf({}, 3, {0, 0, 0}, 400);
    const Voxels voxels = samplesOf(kernel);
    const Rays rays(voxels, 0.5);
    EXPECT_LT(rays.errorOf({&kernel, 1}).worst(), 2e-3);
    kernel.mass *= 1.1f;
    EXPECT_NEAR(rays.errorOf({&kernel, 1}).depth, 0.1, 2e-3);
    EXPECT_NEAR(rays.errorOf({}).worst(), 1, 1e-12);
}

TEST(ImportRays, SumsOfATiltedDiscAreThoseOfItsSamples) {
    Kernel kernel = disc();
    const Voxels voxels = samplesOfAny(kernel);
    const Rays rays(voxels, 0.5);
    EXPECT_LT(rays.errorOf({&kernel, 1}).worst(), 0.02); // 0.9 voxels wide, so that linear parts are not smooth
    kernel.spread = kernel.spread * 1.2;
    EXPECT_GT(rays.errorOf({&kernel, 1}).worst(), 0.05);
}

TEST(ImportPictures, AFactorIsSeenAsMuchAsTheMediumIsThin) {
    const Voxels voxels = noise();
    std::vector<float> more(voxels.values().begin(), voxels.values().end());
    const auto errorWith = [&](double per_value) { return Pictures(voxels, per_value).errorOf(more); };
    EXPECT_EQ(errorWith(0.1), 0);
    for (float& value : more) value *= 1.1f;
    EXPECT_NEAR(errorWith(1e-4), 0.1, 2e-3); // light is in proportion to what scatters it
    EXPECT_LT(errorWith(1), 0.05);           // and not where hardly any gets through
}

TEST(ImportPictures, ShadowsAreSeenThatDepthsDoNotTell) {
    // The front half before the back half, and the other way round: the same depths from there.
    const auto slab = [](float first, float second) {
        return sampled(glm::ivec3(0), glm::ivec3(31), 0, [=](glm::ivec3 v) { return v.z < 16 ? first : second; });
    };
    const Voxels a = slab(1, 0.1f), b = slab(0.1f, 1);
    EXPECT_GT(Pictures(a, 0.1).errorOf(b.values()), 0.2);
}

TEST(ImportOctree, ADearParticleIsWiderOrNone) {
    const Voxels voxels = noise();
    const Octree tree(voxels, {}, 0.1, false);
    EXPECT_TRUE(tree.choose(1e6).empty());
    EXPECT_EQ(tree.choose(1e-30).size(), voxels.active());
    size_t last = voxels.active();
    for (const double price : {1e-9, 1e-7, 1e-5, 1e-3}) {
        const size_t now = tree.choose(price).size();
        EXPECT_LT(now, last);
        last = now;
    }
}

} // namespace
} // namespace brume::volumes::fit_test
