// Gaussians as voxels: balls and ellipsoids against their formula.
#include "tools/import/rasterise.h"

#include <cmath>

#include <glm/gtc/quaternion.hpp>
#include <gtest/gtest.h>

#include "shaders/shared/ellipsoid.h"

namespace brume::volumes::rasterise_test {
namespace {

constexpr double kCut = 4e-6; // of the peak, where a Gaussian ends

// Slanted, with semi-axes of such lengths.
Gaussian slanted(glm::dvec3 lengths, double deviation) {
    const glm::dmat3 turn = glm::mat3_cast(glm::normalize(glm::dquat(0.9, 0.3, -0.5, 0.2)));
    return {{3.25, -6.5, 1.75},
            deviation,
            2,
            {0.25f, 0.5f, 1},
            glm::dmat3(turn[0] * lengths.x, turn[1] * lengths.y, turn[2] * lengths.z)};
}

double valueAt(const Gaussian& gaussian, glm::dvec3 place) {
    glm::dvec3 y = place - gaussian.centre;
    if (gaussian.axes) y = physics::inSemiAxes(y, (*gaussian.axes)[0], (*gaussian.axes)[1], (*gaussian.axes)[2]);
    return gaussian.peak * std::exp(-0.5 * glm::dot(y, y) / (gaussian.deviation * gaussian.deviation));
}

TEST(Rasterise, GaussiansAddUpAtTheVoxels) {
    const Gaussian all[]{slanted({1, 0.3, 0.5}, 8), {{-4, 0, 2.5}, 3, 1.5}, slanted({0.4, 1, 0.4}, 6)};
    const Voxels voxels = rasterised(all, 0).voxels;
    double mass = 0;
    for (const Gaussian& gaussian : all) mass += massOf(gaussian);
    EXPECT_NEAR(voxels.sum() / mass, 1, 2e-5);
    for (int x = -50; x <= 50; ++x)
        for (int y = -50; y <= 50; ++y)
            for (int z = -50; z <= 50; ++z) {
                double sum = 0;
                for (const Gaussian& gaussian : all) sum += valueAt(gaussian, glm::dvec3(x, y, z));
                ASSERT_NEAR(voxels.at({x, y, z}), sum, 3 * kCut * 2) << x << ' ' << y << ' ' << z;
            }
}

TEST(Rasterise, ABallIsAnEllipsoidOfEqualAxes) {
    const Gaussian round = slanted({1, 1, 1}, 4);
    const Ball ball{round.centre, round.deviation, round.peak, round.albedo};
    const Voxels a = rasterised({&round, 1}, 0).voxels, b = rasterised({&ball, 1}, 0).voxels;
    forActive(b, [&](glm::ivec3 voxel, float value) { ASSERT_NEAR(a.at(voxel), value, kCut * 2); });
    EXPECT_DOUBLE_EQ(massOf(round), massOf(ball));
}

TEST(Rasterise, ANeedleTakesFewBlocksOfItsBox) {
    const Gaussian needle = slanted({1, 0.01, 0.01}, 100);
    const Raster raster = rasterised({&needle, 1}, 1e-4f, true);
    EXPECT_LT(raster.voxels.blocks().size(), 1000u) << "the box has some 57,000";
    EXPECT_TRUE(fits({&needle, 1}, raster.voxels.blocks().size()));
    EXPECT_FALSE(fits({&needle, 1}, raster.voxels.blocks().size() - 1));
    EXPECT_NEAR(raster.voxels.sum() / massOf(needle), 1, 1e-3);
    for (size_t i = 0; i < raster.albedo.size(); ++i) {
        if (raster.voxels.values()[i] > 0) {
            ASSERT_LT(glm::length(raster.albedo[i] - needle.albedo), 1e-6f);
        }
    }
}

} // namespace
} // namespace brume::volumes::rasterise_test
