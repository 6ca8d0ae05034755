// A viewer that redraws its pictures from layers with depth gets new ones when it cannot.
#include <cmath>

#include <glm/gtc/quaternion.hpp>
#include <gtest/gtest.h>

#include "tests/unit/take_due.h"

namespace brume {
namespace {

using std::chrono::milliseconds;

const Clock::time_point kStart = Clock::time_point{} + std::chrono::hours(1);
constexpr milliseconds kLast{150}; // that its pictures show the medium right

// Whose pictures show a medium 4 to 9 m away; with these layers, and a surface at `nearest` m.
class Layered {
public:
    explicit Layered(uint8_t layers = 4, float nearest = 0) : layers_(layers), nearest_(nearest) {
        viewer.setPose(pose());
        deliver(kStart);
    }

    PoseRequest pose(float x = 0, float turned = 0) {
        PoseRequest request = poseWithSeq(++seq_);
        request.layers = 4;
        request.pose.position.x = x;
        request.pose.orientation = glm::angleAxis(turned, glm::vec3(0, 1, 0));
        return request;
    }
    void deliver(Clock::time_point now) {
        const auto due = takeDue(viewer, now);
        ASSERT_TRUE(due);
        auto frame = std::make_shared<EncodedFrame>();
        frame->id = due->frame_id;
        frame->request = due->request;
        frame->encoded = now;
        FrameLayers layers;
        layers.count = layers_, layers.near = 4, layers.far = 9, layers.nearest = nearest_;
        if (layers_ > 0 || nearest_ > 0) frame->layers[0] = std::make_shared<const FrameLayers>(std::move(layers));
        viewer.deliver(std::move(frame));
        ASSERT_TRUE(viewer.takeFrame(now));
        ASSERT_TRUE(viewer.acknowledge(due->frame_id, now));
    }
    bool dueAfter(milliseconds time, Clock::duration last = kLast) {
        return viewer.pollDue(kStart + time, ++scene_, false, {}, last).has_value();
    }

    Viewer viewer{1, windowOf(4), nullptr};

private:
    uint8_t layers_;
    float nearest_;
    uint32_t seq_ = 0;
    uint64_t scene_ = 1;
};

TEST(LayeredViewer, GetsNoPictureThatItCanRedraw) {
    Layered one;
    one.viewer.setPose(one.pose(0.23f, 0.025f));
    EXPECT_FALSE(one.dueAfter(milliseconds(100)));
    EXPECT_TRUE(one.dueAfter(milliseconds(150)));
    EXPECT_EQ(one.viewer.every(), 9u) << "the schedule gives its time to others";
}

TEST(LayeredViewer, GetsOneWhenItsCameraHasMovedFar) {
    Layered one;
    one.viewer.setPose(one.pose(0.25f)); // more than 4 % of 6 m
    EXPECT_TRUE(one.dueAfter(milliseconds(17)));
    EXPECT_EQ(one.viewer.every(), 1u);
    Layered near(4, 2.0f); // before a column
    near.viewer.setPose(near.pose(0.05f));
    EXPECT_TRUE(near.dueAfter(milliseconds(17)));
}

TEST(LayeredViewer, GetsOneWhenItsCameraHasTurnedFar) {
    for (const float turned : {0.05f, -0.05f, 3.1f}) {
        Layered one;
        one.viewer.setPose(one.pose(0, turned));
        EXPECT_TRUE(one.dueAfter(milliseconds(17))) << turned;
    }
    Layered narrow; // a narrow field of view has a narrow margin
    PoseRequest narrow_pose = narrow.pose();
    narrow_pose.pose.fov_y = 0.1f;
    narrow.viewer.setPose(narrow_pose);
    narrow.deliver(kStart);
    narrow_pose.seq += 1;
    narrow_pose.pose.orientation = glm::angleAxis(0.01f, glm::vec3(0, 1, 0));
    narrow.viewer.setPose(narrow_pose);
    EXPECT_TRUE(narrow.dueAfter(milliseconds(17)));
    Layered same;
    PoseRequest pose = same.pose();
    pose.pose.orientation = -pose.pose.orientation; // the same orientation
    same.viewer.setPose(pose);
    EXPECT_FALSE(same.dueAfter(milliseconds(17)));
}

TEST(LayeredViewer, GetsOneAtOnceWhenAnythingElseIsAnother) {
    for (const auto change : {+[](PoseRequest& p) { p.width = 100; }, +[](PoseRequest& p) { p.show = 1; },
                              +[](PoseRequest& p) { p.pose.fov_y = 0.5f; }, +[](PoseRequest& p) { p.layers = 2; }}) {
        Layered one;
        PoseRequest pose = one.pose();
        change(pose);
        one.viewer.setPose(pose);
        EXPECT_TRUE(one.dueAfter(milliseconds(17)));
    }
}

TEST(LayeredViewer, GetsAllWhileTheMediumMovesOrItHasNoLayers) {
    Layered one;
    one.viewer.setPose(one.pose(0.1f));
    EXPECT_TRUE(one.dueAfter(milliseconds(17), {}));
    Layered none(0);
    none.viewer.setPose(none.pose(0.1f));
    EXPECT_TRUE(none.dueAfter(milliseconds(17)));
}

} // namespace
} // namespace brume
