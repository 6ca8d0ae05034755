#include "server/loop/asks.h"

#include <string>

#include <gtest/gtest.h>

namespace brume {
namespace {

// Sliders and pushes come many times a second; how pictures are rendered is seldom changed, and is seen at once.
TEST(Asks, WhatComesManyTimesASecondMakesNoPlanAtOnce) {
    EXPECT_EQ(asksFor(Impulse{}), Asks::nothing);
    EXPECT_EQ(asksFor(SetParticles{}), Asks::nothing);
    EXPECT_EQ(asksFor(MoveVolume{}), Asks::soon);
    EXPECT_EQ(asksFor(Set{{"medium.anisotropy", 0.5f}}), Asks::soon);
    EXPECT_EQ(asksFor(Set{{"render.exposure", 2.0f}}), Asks::soon);
    EXPECT_EQ(asksFor(Set{{"medium.anisotropy", 0.5f}, {"render.method", std::string("slabs")}}), Asks::at_once);
    EXPECT_EQ(asksFor(Restart{}), Asks::at_once);
    EXPECT_EQ(asksFor(Add{}), Asks::at_once);
}

} // namespace
} // namespace brume
