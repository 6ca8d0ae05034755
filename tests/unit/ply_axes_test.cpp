// Points with semi-axes of their own.
#include <cmath>

#include <gtest/gtest.h>

#include "common/ellipsoid.h"
#include "common/ply/ply.h"
#include "common/scene.h"
#include "shaders/shared/ellipsoid.h"
#include "tests/unit/ply_file.h"

namespace brume::ply_axes_test {
namespace {

using test::asciiPly;

const std::string kAxes = "property float scale\nproperty float sigma_t\nproperty float axis_a_x\n"
                          "property float axis_a_y\nproperty float axis_a_z\nproperty float axis_b_x\n"
                          "property float axis_b_y\nproperty float axis_b_z\nproperty float axis_c_x\n"
                          "property float axis_c_y\nproperty float axis_c_z\n";

PointCloud read(const std::string& points) { return parsePly(asciiPly(kAxes, points), "a.ply", {}, {.axes = true}); }

TEST(PlyAxes, OfTheRightFormAreKeptToTheBit) {
    const PointCloud cloud = read("1 2 3 4 0.5 1 0 0 0 0.25 0 0 0 0.5\n");
    EXPECT_EQ(cloud.axes[0].a, glm::vec3(1, 0, 0));
    EXPECT_EQ(cloud.axes[0].b, glm::vec3(0, 0.25f, 0));
    EXPECT_EQ(cloud.axes[0].c, glm::vec3(0, 0, 0.5f));
    EXPECT_EQ(cloud.scale[0], 4);
    EXPECT_EQ(cloud.sigma_t[0], 0.5f);
    EXPECT_EQ(partOfBall(cloud.axes[0]), 0.125);
    EXPECT_EQ(shortestAxis(cloud.axes[0]), 0.25f);
}

TEST(PlyAxes, OfAnyLengthAreTakenOverTheLongest) {
    const PointCloud cloud = read("0 0 0 2 1 0 0 3 1.5 0 0 0 1 0\n");
    EXPECT_NEAR(cloud.scale[0], 6, 1e-6);
    EXPECT_NEAR(glm::length(cloud.axes[0].a), 1, 1e-6);
    EXPECT_NEAR(glm::length(cloud.axes[0].b), 0.5, 1e-6);
    EXPECT_NEAR(glm::length(cloud.axes[0].c), 1 / 3.0, 1e-6);
}

TEST(PlyAxes, TooThinOnesAreThickenedAndKeepTheirMass) {
    for (const char* third : {"0 0 0.001", "0 0 0"}) {
        const PointCloud cloud = read("0 0 0 2 1 1 0 0 0 1 0 " + std::string(third) + "\n");
        EXPECT_NEAR(glm::length(cloud.axes[0].c), gpu::kLeastAxis, 1e-7) << third;
        EXPECT_NEAR(cloud.axes[0].c.z, gpu::kLeastAxis, 1e-7) << third;
        EXPECT_NEAR(cloud.sigma_t[0], std::string(third) == "0 0 0" ? 0 : 0.1, 1e-6) << third;
    }
}

TEST(PlyAxes, ThoseThatCannotBeDropTheirPoint) {
    const PointCloud cloud = read("0 0 0 2 1 1 0 0 0 1 0 0 0 1\n1 0 0 2 1 1 0 0 1 1 0 0 0 1\n"
                                  "2 0 0 2 1 nan 0 0 0 1 0 0 0 1\n3 0 0 2 1 0 0 0 0 0 0 0 0 0\n");
    EXPECT_EQ(cloud.position.size(), 1u);
    EXPECT_EQ(cloud.axes.size(), 1u);
    EXPECT_EQ(cloud.dropped, 3u);
    EXPECT_NE(cloud.first_dropped.find("the cosine of two of its axes is 0.707; allowed: right angles"),
              std::string::npos)
        << cloud.first_dropped;
}

TEST(PlyAxes, OfOneLengthAreThoseOfBalls) {
    const std::string ball = "0 0 0 2 1 3 0 0 0 3 0 0 0 2.99\n", disc = "0 0 0 2 1 1 0 0 0 1 0 0 0 0.9\n";
    EXPECT_FALSE(hasEllipsoids(asciiPly(kAxes, ball + ball), "a.ply"));
    EXPECT_TRUE(hasEllipsoids(asciiPly(kAxes, ball + disc), "a.ply"));
}

TEST(PlyAxes, AFileWithoutThemSaysWhatIsExpected) {
    try {
        parsePly(test::fourWith("property float axis_a_x\n", "1"), "a.ply", {}, {.axes = true});
        FAIL();
    } catch (const SceneError& error) {
        EXPECT_NE(std::string(error.what()).find("expected axis_a_x, axis_a_y ... axis_c_z, or Gaussian splats"),
                  std::string::npos)
            << error.what();
    }
    const PlyContents none = contentsOf(test::fourWith("property float axis_a_x\n", "1"), "a.ply");
    EXPECT_FALSE(none.axes || none.splats || none.tetrahedra);
    EXPECT_TRUE(contentsOf(asciiPly(kAxes, ""), "a.ply").axes);
}

} // namespace
} // namespace brume::ply_axes_test
