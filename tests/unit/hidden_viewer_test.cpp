// A viewer whose window nobody sees: nothing is drawn for it.
#include <gtest/gtest.h>

#include "tests/unit/take_due.h"

namespace brume {
namespace {

TEST(HiddenViewer, NothingIsDueForAHiddenWindowAndAFrameAtOnceWhenItIsSeenAgain) {
    Viewer viewer(1, windowOf(2), nullptr);
    Clock::time_point now{std::chrono::hours(1)};
    PoseRequest pose = poseWithSeq(1);
    viewer.setPose(pose);
    for (uint64_t tick = 1; tick <= 2;
         ++tick) { // the window is full: a hidden page presents nothing, so acknowledges nothing
        const auto due = takeDue(viewer, now, tick);
        ASSERT_TRUE(due);
        viewer.deliver(frameFor(*due, now));
        ASSERT_TRUE(viewer.takeFrame(now));
    }
    pose.seq = 2;
    pose.hidden = true;
    viewer.setPose(pose);
    for (uint64_t tick = 3; tick < 100; ++tick) {
        now += std::chrono::seconds(1);
        EXPECT_FALSE(takeDue(viewer, now, tick));
        EXPECT_FALSE(takeDue(viewer, now, tick, true));
        EXPECT_EQ(viewer.observe(now).count(), 0) << "no acknowledgement is missing";
    }
    pose.seq = 3;
    pose.hidden = false;
    viewer.setPose(pose);
    EXPECT_EQ(viewer.observe(now).count(), 0) << "nor now";
    EXPECT_TRUE(takeDue(viewer, now, 100));
    EXPECT_TRUE(viewer.acknowledge(2, now)) << "a late acknowledgement is none for a frame never sent";
}

TEST(HiddenViewer, AHiddenWindowThatIsSeenAgainGetsThePictureOfARestingSceneOnceMore) {
    Viewer viewer(1, windowOf(6), nullptr);
    viewer.setPose(poseWithSeq(1));
    Clock::time_point now{std::chrono::hours(1)};
    ASSERT_TRUE(takeDue(viewer, now, 7));
    now += std::chrono::milliseconds(150);
    ASSERT_TRUE(takeDue(viewer, now, 7, true));
    PoseRequest pose = poseWithSeq(2);
    pose.hidden = true;
    viewer.setPose(pose);
    pose = poseWithSeq(3);
    viewer.setPose(pose);
    const auto again = takeDue(viewer, now, 7);
    ASSERT_TRUE(again);
    EXPECT_EQ(again->request.seq, 3u);
    EXPECT_FALSE(takeDue(viewer, now, 7)) << "once";
    now += std::chrono::milliseconds(150);
    EXPECT_TRUE(takeDue(viewer, now, 7, true)) << "and finer";
    pose.seq = 4;
    viewer.setPose(pose);
    EXPECT_FALSE(takeDue(viewer, now, 7)) << "it was not hidden";
}

// The window is hidden between the two steps of taking a frame: that frame would never be acknowledged.
TEST(HiddenViewer, NothingIsTakenForAWindowThatWasHiddenMeanwhile) {
    Viewer viewer(1, windowOf(2), nullptr);
    PoseRequest pose = poseWithSeq(1);
    viewer.setPose(pose);
    const auto now = Clock::now();
    const auto due = viewer.pollDue(now, 1, false);
    ASSERT_TRUE(due);
    pose.seq = 2;
    pose.hidden = true;
    viewer.setPose(pose);
    EXPECT_FALSE(viewer.take(*due, now, 1));
    EXPECT_EQ(viewer.counts().in_flight, 0u);
}

} // namespace
} // namespace brume
