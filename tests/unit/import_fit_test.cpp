// The fit of Gaussians to voxels: laws that hold whatever the volume is, and closed forms.
#include "tools/import/fit.h"

#include <cmath>
#include <cstring>
#include <numbers>

#include <gtest/gtest.h>

#include "tools/import/octree.h"
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
    const double deviation = double(kernel.deviation);
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
    Mixture mixture(voxels, {}, Octree(voxels, {}, 0.1).choose(1e-6));
    mixture.refine(3, true);
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
    mixture.refine(200, false);
    for (const Kernel& kernel : mixture.kernels()) // the others go to 0, ever slower
        EXPECT_NEAR(kernel.mass, kernel.cell == truth.cell ? 5 : 0, kernel.cell == truth.cell ? 0.25 : 0.05);
}

TEST(ImportFit, FindsPlaceAndWidthOfAGaussianBesideTheLattice) {
    const Shape shape;
    Kernel truth = kernelOf(shape, 2, {0, 0, 0}, 3);
    truth.at += glm::dvec3(0.7, -1.1, 0.4);
    truth.deviation *= 1.2f;
    const Voxels voxels = samplesOf(truth);
    Mixture mixture(voxels, shape, {kernelOf(shape, 2, {0, 0, 0}, 1)});
    mixture.refine(40, true);
    const Kernel& found = mixture.kernels().front();
    EXPECT_LT(glm::length(found.at - truth.at), 0.01);
    EXPECT_NEAR(found.deviation / truth.deviation, 1, 0.02); // it ends at 3.4 deviations
    EXPECT_NEAR(found.mass, 3, 0.02);                        // so some mass lies beyond
}

TEST(ImportFit, AnEvenCubeIsEvenInside) {
    const Voxels voxels = cube(48, 1);
    const Shape shape;
    std::vector<Kernel> lattice;
    for (int n = 0; n < 12 * 12 * 12; ++n) lattice.push_back(kernelOf(shape, 2, {n / 144, n / 12 % 12, n % 12}, 64));
    Mixture mixture(voxels, shape, lattice);
    mixture.refine(24, false);
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
        EXPECT_EQ(a[i].deviation, b[i].deviation);
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

TEST(ImportOctree, ADearParticleIsWiderOrNone) {
    const Voxels voxels = noise();
    const Octree tree(voxels, {}, 0.1);
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
