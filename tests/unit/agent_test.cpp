// What HAProxy's agent-check is told.
#include "server/net/agent.h"

#include <limits>

#include <gtest/gtest.h>

namespace brume::net {
namespace {

std::string weight(float budget_used, uint32_t viewers, uint32_t places) {
    return agentLine({.ready = true,
                      .draining = false,
                      .stands = false,
                      .budget_used = budget_used,
                      .viewers = viewers,
                      .places = places});
}

TEST(Agent, TheWeightIsWhatIsFreeOfBudgetOrPlaces) {
    EXPECT_EQ(weight(0, 0, 32), "up ready 100%\n");
    EXPECT_EQ(weight(0.25f, 0, 32), "up ready 75%\n");
    EXPECT_EQ(weight(0.25f, 16, 32), "up ready 50%\n");
    EXPECT_EQ(weight(0.9f, 16, 32), "up ready 10%\n");
    EXPECT_EQ(weight(0.1f, 1, 3), "up ready 67%\n");
}

TEST(Agent, AFullServerKeepsALittleWeight) {
    EXPECT_EQ(weight(0, 32, 32), "up ready 1%\n");
    EXPECT_EQ(weight(0, 33, 32), "up ready 1%\n") << "the limit was lowered";
    EXPECT_EQ(weight(0, 0, 0), "up ready 1%\n");
    EXPECT_EQ(weight(1, 0, 32), "up ready 1%\n");
    EXPECT_EQ(weight(7, 0, 32), "up ready 1%\n");
    EXPECT_EQ(weight(std::numeric_limits<float>::infinity(), 0, 32), "up ready 1%\n");
    EXPECT_EQ(weight(std::numeric_limits<float>::quiet_NaN(), 0, 32), "up ready 100%\n") << "nothing is known";
}

TEST(Agent, OneThatDrainsKeepsItsViewersAndOneThatCannotDrawIsDown) {
    EXPECT_EQ(
        agentLine({.ready = false, .draining = false, .stands = false, .budget_used = 0, .viewers = 1, .places = 2}),
        "down\n");
    EXPECT_EQ(
        agentLine({.ready = false, .draining = true, .stands = false, .budget_used = 0, .viewers = 1, .places = 2}),
        "drain\n");
    EXPECT_EQ(
        agentLine({.ready = true, .draining = true, .stands = false, .budget_used = 0, .viewers = 1, .places = 2}),
        "drain\n");
}

} // namespace
} // namespace brume::net
