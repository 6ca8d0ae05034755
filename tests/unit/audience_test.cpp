// The audience: who may join, what leaving does, and when its revision grows.
#include <gtest/gtest.h>

#include "server/viewer/audience.h"
#include "tests/unit/take_due.h"

namespace brume {
namespace {

PoseRequest firstPose() {
    PoseRequest request;
    request.seq = 1;
    return request;
}

TEST(Audience, HasAsManyPlacesAsItSays) {
    Audience audience({}, sceneFacts({}), 2, 2);
    const auto first = audience.join(nullptr), second = audience.join(nullptr);
    ASSERT_TRUE(first && second);
    EXPECT_NE(first->id(), second->id());
    EXPECT_EQ(audience.join(nullptr), nullptr);
    audience.leave(first);
    EXPECT_EQ(audience.size(), 1u);
    const auto third = audience.join(nullptr);
    ASSERT_TRUE(third);
    std::vector<std::shared_ptr<Viewer>> viewers;
    audience.list(viewers);
    EXPECT_EQ(viewers, (std::vector<std::shared_ptr<Viewer>>{second, third}));
}

TEST(Audience, LeavingClosesTheViewer) {
    Audience audience({}, sceneFacts({}), 2, 2);
    const auto viewer = audience.join(nullptr);
    viewer->setPose(firstPose());
    audience.leave(viewer);
    EXPECT_FALSE(takeDue(*viewer));
    audience.leave(viewer); // again: harmless
    EXPECT_EQ(audience.size(), 0u);
}

TEST(Audience, AViewerMayAskForASmallerWindowNotALarger) {
    Audience audience({}, sceneFacts({}), 3, 2);
    const auto dueOf = [&](uint32_t window) {
        const auto viewer = audience.join(nullptr, window);
        viewer->setPose(firstPose());
        int due = 0;
        while (due < 100 && takeDue(*viewer)) ++due;
        return due;
    };
    EXPECT_EQ(dueOf(0), 2);
    EXPECT_EQ(dueOf(1), 1);
    EXPECT_EQ(dueOf(50), 2);
}

TEST(Audience, RevisionGrowsWithSettingsAndVisitorsNotWithTime) {
    Audience audience({}, sceneFacts({}), 2, 2);
    ASSERT_NE(audience.report(), nullptr);
    SceneReport report;
    audience.publish(std::make_shared<SceneReport>(report));
    uint64_t before = audience.revision();

    report.tick = 7, report.state_hash = 8, report.particles = 9;
    audience.publish(std::make_shared<SceneReport>(report));
    EXPECT_EQ(audience.revision(), before);
    EXPECT_EQ(audience.report()->tick, 7u);

    const auto grows = [&](auto&& change) {
        before = audience.revision();
        change();
        return audience.revision() > before;
    };
    EXPECT_TRUE(grows([&] { ++report.settings_version, audience.publish(std::make_shared<SceneReport>(report)); }));
    // A value that changes by itself, such as the direction of a turning light, is no news.
    EXPECT_FALSE(grows(
        [&] { report.settings[0] = glm::vec3(1, 0, 0), audience.publish(std::make_shared<SceneReport>(report)); }));
    std::shared_ptr<Viewer> viewer;
    EXPECT_TRUE(grows([&] { viewer = audience.join(nullptr); }));
    EXPECT_TRUE(grows([&] { audience.leave(viewer); }));
}

} // namespace
} // namespace brume
