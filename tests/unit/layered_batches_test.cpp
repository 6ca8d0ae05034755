// Batches of viewers that redraw their pictures from layers with depth.
#include <gtest/gtest.h>

#include "server/loop/batch_planner.h"

namespace brume {
namespace {

// Viewers that redraw their pictures need new ones at different times. A batch that is drawn anyway takes those along
// who would need one soon.
TEST(LayeredBatches, ViewersThatRedrawComeTogether) {
    using std::chrono::milliseconds;
    BatchPlanner planner;
    BatchContents batch;
    std::vector<std::shared_ptr<Viewer>> viewers;
    for (uint32_t id = 1; id <= 4; ++id) viewers.push_back(std::make_shared<Viewer>(id, PacingOptions{}, nullptr));
    const Clock::time_point start = Clock::time_point{} + std::chrono::hours(1);
    const auto draw = [&](milliseconds at, uint64_t scene) {
        const BatchPlanner::Limits limits{.budget_ms = 50, .layers_last = milliseconds(100)};
        if (!planner.plan(viewers, scene, limits, start + at, batch)) return size_t{0};
        for (const BatchJob& job : batch.jobs) {
            auto frame = std::make_shared<EncodedFrame>();
            frame->id = job.due.frame_id;
            frame->request = job.due.request;
            frame->encoded = start + at;
            auto layers = std::make_shared<FrameLayers>();
            layers->count = 4, layers->near = 4, layers->far = 9;
            frame->layers[0] = layers;
            job.viewer->deliver(std::move(frame));
            job.viewer->takeFrame(start + at);
            job.viewer->acknowledge(job.due.frame_id, start + at);
        }
        return batch.jobs.size();
    };
    uint64_t scene = 1;
    for (const auto& viewer : viewers) { // they come 20 ms apart
        PoseRequest pose{.seq = 1};
        pose.pose.position.x = float(viewer->id());
        pose.width = 64, pose.height = 36, pose.layers = 4;
        viewer->setPose(pose);
        EXPECT_GE(draw(milliseconds(20) * viewer->id(), scene++), 1u);
    }
    std::vector<size_t> batches;
    for (int ms = 100; ms < 700; ms += 5)
        if (const size_t drawn = draw(milliseconds(ms), scene++)) batches.push_back(drawn);
    ASSERT_GE(batches.size(), 4u);
    EXPECT_EQ(batches.back(), 4u);
    EXPECT_LE(batches.size(), 7u) << "and no more often than they need";
}

} // namespace
} // namespace brume
