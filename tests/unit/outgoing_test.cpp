// The server's messages, read again.
#include <gtest/gtest.h>

#include "server/net/outgoing.h"

namespace brume::net {
namespace {

// Whichever method it is: the distance of its rays and its slabs reach the viewers.
TEST(Outgoing, ASceneStateTellsThePlansRaysAndSlabs) {
    SceneReport report;
    report.plan.settings.method = "grid";
    report.plan.settings.rate = 6;
    report.plan.settings.slabs = 48;
    const wire::Packed packed = packSceneState(report, 1);
    const auto parsed = wire::parse(wire::bytesOf(packed));
    ASSERT_TRUE(parsed);
    const wire::Plan* plan = parsed->as<wire::SceneState>()->plan();
    EXPECT_EQ(plan->method()->str(), "grid");
    EXPECT_EQ(plan->rate(), 6u);
    EXPECT_EQ(plan->slabs(), 48u);
}

} // namespace
} // namespace brume::net
