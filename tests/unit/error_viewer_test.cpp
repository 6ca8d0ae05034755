// Who looks at errors of single pixels, without a device.
#include <gtest/gtest.h>

#include "common/view_names.h"
#include "server/viewer/viewer.h"
#include "tests/unit/take_due.h"

namespace brume {
namespace {

class ErrorViewer : public testing::Test {
protected:
    void look(uint32_t seq) {
        PoseRequest pose;
        pose.seq = seq;
        pose.pose.position.x = float(seq);
        pose.show = *viewNamed("error");
        viewer_.setPose(pose);
    }
    // Pictures at rest within the next two seconds, while the scene rests, too.
    int stills() {
        int count = 0;
        for (int ms = 0; ms < 2000; ms += 10, now_ += std::chrono::milliseconds(10))
            if (const auto due = takeDue(viewer_, now_, scene_, true)) {
                EXPECT_TRUE(due->request.still_picture);
                ++count;
            }
        return count;
    }

    Viewer viewer_{1, {.least_frames = 100, .most_frames = 100}, nullptr};
    Clock::time_point now_{std::chrono::hours(1)};
    uint64_t scene_ = 7;
};

// More pictures come at rest, so that more pixels are measured: four a second at most.
TEST_F(ErrorViewer, ErrorsAreCollectedWhileNothingMoves) {
    look(1);
    ASSERT_TRUE(takeDue(viewer_, now_, scene_));
    const int count = stills();
    EXPECT_GE(count, 6);
    EXPECT_LE(count, 8);
}

// One picture at rest comes, as for everyone. Another scene or another camera may have something to measure.
TEST_F(ErrorViewer, NothingIsCollectedWhereNothingCanBeMeasured) {
    look(1);
    for (const bool moved : {false, true, false}) {
        if (moved)
            look(2);
        else
            ++scene_;
        ASSERT_TRUE(takeDue(viewer_, now_, scene_));
        viewer_.cannotMeasure();
        EXPECT_EQ(stills(), 1);
        EXPECT_EQ(stills(), 0);
    }
    ++scene_;
    ASSERT_TRUE(takeDue(viewer_, now_, scene_));
    EXPECT_GE(stills(), 6);
}

} // namespace
} // namespace brume
