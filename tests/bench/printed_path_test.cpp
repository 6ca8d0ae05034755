// The printed path over sorted hits is that of merged intervals; icosahedra.
#include "tools/bench/printed_path.h"

#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tools/reference/geometry.h"

namespace brume::bench::printed_path_test {
namespace {

TEST(PrintedPath, CounterAndMergedIntervalsAgree) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> place(-2, 2), size(0.2, 0.7);
    for (int round = 0; round < 20; ++round) {
        reference::UnionMedium medium;
        for (int i = 0; i < 40; ++i)
            medium.balls.push_back({{place(random), place(random), place(random)}, size(random)});
        const glm::dvec3 to_light = glm::normalize(glm::dvec3(place(random), place(random), 2));
        for (size_t i = 0; i < medium.balls.size(); ++i) {
            const std::vector<PathHit> hits = hitsOf(medium, i, to_light);
            std::vector<reference::Interval> parts;
            reference::insideUnion(medium, {medium.balls[i].centre, to_light}, parts);
            double truth = 0;
            for (const reference::Interval part : parts) truth += part.end - part.begin;
            EXPECT_NEAR(double(mergedPath(hits)), truth, 1e-5);
            for (const PathSort sort : {PathSort::slots, PathSort::early, PathSort::stored}) {
                std::vector<PathHit> slots = hits; // with empty slots behind
                slots.resize(hits.size() + 7);
                EXPECT_NEAR(double(printedPath(slots, sort)), truth, 1e-5);
            }
        }
    }
}

TEST(PrintedPath, GapsDoNotCountAndNestedPartsCountOnce) {
    // Within two at the start until 1 and 2; a gap; one from 3 to 6 with another within it.
    const std::array<PathHit, 6> hits{{{1, -1}, {2, -1}, {3, 1}, {6, -1}, {4, 1}, {5, -1}}};
    EXPECT_EQ(mergedPath(hits), 5);
    std::array<PathHit, 8> slots{};
    std::ranges::copy(hits, slots.begin());
    EXPECT_EQ(printedPath(slots, PathSort::slots), 5);
    EXPECT_EQ(printedPath(std::span(slots).first(0), PathSort::slots), 0);
}

TEST(Icosahedron, ItsMeanChordIsFourVolumesOverItsSurface) {
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> across(-1, 1);
    const glm::dvec3 centre(3, -1, 2);
    const double radius = 1.5;
    double sum = 0;
    int count = 0, rays = 0;
    while (rays++ < 400'000) {
        const auto direction = [&] {
            return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
        };
        const glm::dvec3 along = direction(), u = glm::normalize(glm::cross(along, direction())),
                         v = glm::cross(along, u);
        const reference::Ray ray{centre + radius * (across(random) * u + across(random) * v) - 7.0 * along, along};
        const reference::Interval part = insideIcosahedron(centre, radius, ray);
        if (part.empty()) continue;
        sum += part.end - part.begin, ++count;
        const reference::Interval ball = reference::insideSphere(centre, radius, ray);
        EXPECT_GE(part.begin, ball.begin - 1e-12);
        EXPECT_LE(part.end, ball.end + 1e-12);
    }
    const double edge = radius / std::sin(2 * reference::kPi / 5);
    const double volume = 5 * (3 + std::sqrt(5.0)) / 12 * edge * edge * edge,
                 surface = 5 * std::sqrt(3.0) * edge * edge;
    const double mean = sum / count; // of so many chords: within 0.1 %
    EXPECT_NEAR(mean, 4 * volume / surface, 3e-3 * mean);
    EXPECT_NEAR(4 * volume / surface / (radius * 4 / 3), 0.7947, 1e-4);
    EXPECT_NEAR(surface / 4, 4 * radius * radius * count / rays, 5e-3 * surface); // Cauchy: the mean shadow's area
}

} // namespace
} // namespace brume::bench::printed_path_test
