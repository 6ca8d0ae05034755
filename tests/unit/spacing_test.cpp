// The typical distance of the points of a cloud.
#include "server/sim/spacing.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "common/random.h"

namespace brume {
namespace {

std::vector<glm::vec3> box(uint32_t count, glm::vec3 half, uint64_t seed = 1) {
    Random random(seed);
    std::vector<glm::vec3> points;
    for (uint32_t i = 0; i < count; ++i) points.push_back(random.inBox() * half);
    return points;
}

// The same without a tree, for all points.
float slowSpacing(const std::vector<glm::vec3>& points) {
    std::vector<float> all;
    for (const glm::vec3& p : points) {
        std::vector<float> distances;
        for (const glm::vec3& q : points) distances.push_back(glm::distance(p, q));
        std::nth_element(distances.begin(), distances.begin() + 8, distances.end());
        all.push_back(distances[8]);
    }
    std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2), all.end());
    return all[all.size() / 2];
}

TEST(Spacing, IsTheMedianDistanceToTheEighthNeighbour) {
    for (const glm::vec3 half : {glm::vec3(1), glm::vec3(100, 1, 0), glm::vec3(0, 0, 3)}) {
        const std::vector<glm::vec3> points = box(1500, half);
        EXPECT_EQ(spacing(points), slowSpacing(points)) << half.x;
    }
}

TEST(Spacing, OfALatticeIsKnown) {
    std::vector<glm::vec3> points;
    for (int i = 0; i < 30 * 30 * 30; ++i) points.push_back(0.25f * glm::vec3(i % 30, i / 30 % 30, i / 900));
    EXPECT_FLOAT_EQ(spacing(points), 0.25f * std::sqrt(2.0f)) << "6 neighbours at one step, 12 on diagonals";
}

TEST(Spacing, OutliersHardlyChangeIt) {
    std::vector<glm::vec3> points = box(20000, glm::vec3(1));
    const float before = spacing(points);
    for (const glm::vec3& far : box(400, glm::vec3(5e4f), 2)) points.push_back(far);
    EXPECT_NEAR(spacing(points), before, 0.03f * before);
}

TEST(Spacing, FewPointsHaveFewerNeighbours) {
    EXPECT_EQ(spacing({}), 0);
    EXPECT_EQ(spacing(std::vector<glm::vec3>{{1, 2, 3}}), 0);
    EXPECT_EQ(spacing(std::vector<glm::vec3>{{1, 2, 3}, {1, 2, 5}}), 2);
    EXPECT_EQ(spacing(std::vector<glm::vec3>(100'000, glm::vec3(7))), 0) << "all in one place";
}

// The bound is for slow hosts and sanitizers; a quadratic search would take hours.
TEST(Spacing, AMillionPointsTakeNoTimeToSpeakOf) {
    std::vector<glm::vec3> points = box(1'000'000, glm::vec3(1));
    points[17] = glm::vec3(4e4f);
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_NEAR(spacing(points), 0.0248f, 0.001f) << "8 = n 4/3 pi r^3 with n = 1e6 / 8";
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    EXPECT_LT(seconds, 100);
    RecordProperty("seconds", std::to_string(seconds));
}

} // namespace
} // namespace brume
