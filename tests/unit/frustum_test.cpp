// What a picture covers: square pixels, the eyes' own frusta.
#include <cmath>

#include <gtest/gtest.h>

#include "common/camera.h"

namespace brume {
namespace {

TEST(Frustum, IsSymmetricWithoutOneOfItsOwn) {
    Pose pose;
    pose.fov_y = 1.1f;
    const Frustum f = frustumOf(pose, 640, 360);
    EXPECT_EQ(f.left, f.right);
    EXPECT_EQ(f.up, f.down);
    EXPECT_EQ(f.up, std::tan(0.55f));
    EXPECT_EQ(f.right, f.up * 640 / 360);
}

TEST(Frustum, IsKeptWherePixelsAreSquare) {
    Pose pose;
    pose.frustum = {1.25f, 0.75f, 0.5f, 0.25f};
    EXPECT_EQ(frustumOf(pose, 640, 240), pose.frustum);
}

TEST(Frustum, IsWidenedAboutItsMiddleUntilPixelsAreSquare) {
    Pose pose;
    pose.frustum = {1.25f, -0.25f, 0.5f, 0.75f};
    for (const auto& [width, height] : {std::pair(640u, 360u), std::pair(360u, 640u), std::pair(3u, 2u)}) {
        const Frustum f = frustumOf(pose, width, height);
        const float across = f.left + f.right, along = f.up + f.down;
        EXPECT_NEAR(across / float(width), along / float(height), 1e-6f * along); // roundings
        EXPECT_NEAR(f.right - f.left, -1.5f, 1e-6f);
        EXPECT_NEAR(f.up - f.down, -0.25f, 1e-6f);
        EXPECT_GE(across, 1.0f);
        EXPECT_GE(along, 1.25f);
        EXPECT_TRUE(across == 1.0f || along == 1.25f) << "one direction stays";
    }
}

TEST(Frustum, BelongsToItsEye) {
    Pose head;
    head.eye_separation = 0.5f;
    head.frustum = {1, 2, 3, 4};
    head.right_frustum = {2, 1, 3, 4};
    EXPECT_EQ(eyePose(head, 0, 2).frustum, head.frustum);
    EXPECT_EQ(eyePose(head, 1, 2).frustum, head.right_frustum);
    EXPECT_EQ(eyePose(head, 0, 1).frustum, head.frustum);
    EXPECT_EQ(eyePose(head, 0, 2).position.x, -0.25f);
    EXPECT_EQ(eyePose(head, 1, 2).position.x, 0.25f);
}

TEST(Frustum, ItsFarthestCornerIsTheLongestOfFour) {
    const Frustum f{-0.5f, 2, 1, 3};
    EXPECT_FLOAT_EQ(cornerLength(f), std::sqrt(1.0f + 4 + 9));
}

} // namespace
} // namespace brume
