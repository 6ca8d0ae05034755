// People over the native client's picture: where dots and cones are seen.
#include <cmath>

#include <gtest/gtest.h>

#include "client/native/people.h"

namespace brume::client::native_people_test {
namespace {

constexpr Area kWhole{0, 0, 640, 360};

Pose fromFront() { return lookAt({0, 0, 10}, {0, 0, 0}, 2 * std::atan(0.5f)); } // a metre at 10 m is 36 pixels

TEST(NativePeople, APlaceIsSeenWhereThePictureShowsIt) {
    const auto middle = seenAt({0, 0, 0}, fromFront(), kWhole);
    ASSERT_TRUE(middle);
    EXPECT_NEAR(middle->x, 320, 1e-3f);
    EXPECT_NEAR(middle->y, 180, 1e-3f);
    const auto right_above = seenAt({2, 3, 0}, fromFront(), kWhole);
    ASSERT_TRUE(right_above);
    EXPECT_NEAR(right_above->x, 320 + 2 * 36, 1e-3f);
    EXPECT_NEAR(right_above->y, 180 - 3 * 36, 1e-3f);
    const auto turned = seenAt({0, 0, 2}, lookAt({10, 0, 0}, {0, 0, 0}, 2 * std::atan(0.5f)), kWhole);
    ASSERT_TRUE(turned);
    EXPECT_NEAR(turned->x, 320 - 2 * 36, 1e-3f) << "+Z is left of who looks along -X";
}

TEST(NativePeople, APictureWithMarginsIsWhatCounts) {
    const auto at = seenAt({2, 3, 0}, fromFront(), {100, 50, 320, 180});
    ASSERT_TRUE(at);
    EXPECT_NEAR(at->x, 100 + 160 + 2 * 18, 1e-3f);
    EXPECT_NEAR(at->y, 50 + 90 - 3 * 18, 1e-3f);
}

TEST(NativePeople, WhatIsBehindTheEyeOrNowhereIsNotSeen) {
    EXPECT_FALSE(seenAt({0, 0, 11}, fromFront(), kWhole));
    EXPECT_FALSE(seenAt({0, 0, 10}, fromFront(), kWhole));
    EXPECT_FALSE(seenAt({NAN, 0, 0}, fromFront(), kWhole));
    EXPECT_FALSE(seenAt({INFINITY, 0, 0}, fromFront(), kWhole));
}

TEST(NativePeople, LinesEndAtThePicturesSides) {
    const auto across = inside({{-100, 10}, {1000, 10}}, kWhole);
    ASSERT_TRUE(across);
    EXPECT_EQ(across->from, glm::vec2(0, 10));
    EXPECT_NEAR(across->to.x, 640, 1e-3f);
    const auto within = inside({{1, 2}, {3, 4}}, kWhole);
    ASSERT_TRUE(within);
    EXPECT_EQ(within->from, glm::vec2(1, 2));
    EXPECT_EQ(within->to, glm::vec2(3, 4));
    EXPECT_FALSE(inside({{-10, -10}, {-10, 500}}, kWhole));
    EXPECT_FALSE(inside({{-100, 50}, {50, -100}}, kWhole)) << "past a corner";
    const auto slanted = inside({{-10, -10}, {90, 90}}, {0, 0, 50, 1000});
    ASSERT_TRUE(slanted);
    EXPECT_NEAR(slanted->from.y, 0, 1e-3f);
    EXPECT_NEAR(slanted->to.y, 50, 1e-3f);
}

Look lookingAtMe() { // from 10 m behind the scene's middle, with a picture of 2 to 1
    const Pose pose = lookAt({0, 0, -10}, {0, 0, 0}, 0.8f);
    return {pose.position, pose.orientation, 0.5f, 0.25f};
}

TEST(NativePeople, AConeHasEightEdges) {
    const auto edges = coneSeen(lookingAtMe(), fromFront(), kWhole);
    ASSERT_EQ(edges.size(), 8u);
    // 20 m away it is 1.2 m long: its far side is 18.8 m away, and 1.2 m by 0.6 m.
    const float pixels = 360 / 18.8f;
    float left = INFINITY, right = -INFINITY, top = INFINITY, bottom = -INFINITY;
    for (const Line& edge : edges) {
        left = std::min({left, edge.from.x, edge.to.x}), right = std::max({right, edge.from.x, edge.to.x});
        top = std::min({top, edge.from.y, edge.to.y}), bottom = std::max({bottom, edge.from.y, edge.to.y});
    }
    EXPECT_NEAR(right - left, 1.2f * pixels, 1e-2f);
    EXPECT_NEAR(bottom - top, 0.6f * pixels, 1e-2f);
    size_t from_tip = 0;
    for (const Line& edge : edges) from_tip += glm::length(edge.from - glm::vec2(320, 180)) < 1e-3f;
    EXPECT_EQ(from_tip, 4u);
}

TEST(NativePeople, AConeAtTheEyeIsNotDrawn) {
    Look own{.position = fromFront().position, .orientation = fromFront().orientation, .right = 1, .up = 1};
    EXPECT_TRUE(coneSeen(own, fromFront(), kWhole).empty());
    own.position.z += 5;
    EXPECT_TRUE(coneSeen(own, fromFront(), kWhole).empty()) << "behind it";
}

TEST(NativePeople, DotsOfAllAndConesOfOthersAreMarked) {
    Person me{.id = 7, .name = "Ann", .colour = 0xe69f00}, other{.id = 9, .name = "Ben", .colour = 0x56b4e9};
    me.pointer = glm::vec3(1, 0, 0);
    me.look = other.look = lookingAtMe();
    other.pointer = glm::vec3(0, 20, 0); // above the picture
    const Marks without = marksOf({me, other}, 7, fromFront(), kWhole, false);
    EXPECT_TRUE(without.edges.empty());
    ASSERT_EQ(without.dots.size(), 1u);
    EXPECT_NEAR(without.dots[0].at.x, 356, 1e-3f);
    EXPECT_EQ(without.dots[0].colour, 0xe69f00u);
    const Marks with = marksOf({me, other}, 7, fromFront(), kWhole, true);
    ASSERT_EQ(with.edges.size(), 8u);
    EXPECT_EQ(with.edges[0].colour, 0x56b4e9u);
}

TEST(NativePeople, ATitleTellsNamesAndColours) {
    std::vector<Person> people{{.id = 1, .name = "Me"}, {.id = 2, .name = "Ann", .colour = 0xe69f00}};
    EXPECT_EQ(namesOf({people[0]}, 1), "");
    EXPECT_EQ(namesOf(people, 1), "Ann (orange)");
    people.push_back({.id = 3, .name = "Ben", .colour = 0x56b4ea, .pointer = glm::vec3(0)}); // nearly the server's
    EXPECT_EQ(namesOf(people, 1), "Ann (orange), Ben (blue, points)");
    for (uint32_t id = 4; id < 9; ++id) people.push_back({.id = id, .name = "Guest", .colour = 0xc8c8c8});
    EXPECT_EQ(namesOf(people, 1), "Ann (orange), Ben (blue, points), Guest (grey), Guest (grey) and 3 more");
}

} // namespace
} // namespace brume::client::native_people_test
