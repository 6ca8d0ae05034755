// Whose pictures a submission draws: viewers and turns, without a clock and without a device.
#include <algorithm>
#include <limits>
#include <map>

#include <gtest/gtest.h>

#include "server/encode/picture.h"
#include "server/loop/batch_planner.h"
#include "server/loop/tick_source.h"
#include "tests/unit/planned_viewers.h"

namespace brume {
namespace {

using test::deliver, test::kStart, test::poseOf, test::viewerOf;

TEST(BatchPlanner, NobodyIsDueWithoutAPose) {
    BatchPlanner planner;
    BatchContents batch;
    const std::vector viewers{viewerOf(1)};
    EXPECT_FALSE(planner.plan(viewers, 1, {.budget_ms = 50}, kStart, batch));
    EXPECT_TRUE(batch.jobs.empty());
}

TEST(BatchPlanner, ViewersOfTheSamePictureShareIt) {
    BatchPlanner planner;
    BatchContents batch;
    const std::vector viewers{viewerOf(1), viewerOf(2), viewerOf(3)};
    for (const auto& viewer : viewers)
        viewer->setPose(poseOf(viewer->id(), 64, 36, viewer->id() == 2 ? 1.0f : 0.0f, 2));
    ASSERT_TRUE(planner.plan(viewers, 1, {.budget_ms = 50}, kStart, batch));
    ASSERT_EQ(batch.jobs.size(), 3u);
    EXPECT_EQ(batch.eyes.size(), 4u);
    EXPECT_EQ(batch.views.size(), 4u);
    EXPECT_TRUE(batch.eyes[1].second);
    for (const BatchJob& job : batch.jobs) {
        EXPECT_EQ(job.first_eye, job.viewer->id() == 2 ? 2u : 0u);
        EXPECT_EQ(batch.jobs[job.pictures].due.request.pose.position.x, job.due.request.pose.position.x);
    }
}

// One camera, two views: two pictures.
TEST(BatchPlanner, WhoLooksAtAnotherViewHasPicturesOfTheirOwn) {
    BatchPlanner planner;
    BatchContents batch;
    const std::vector viewers{viewerOf(1), viewerOf(2), viewerOf(3)};
    for (const auto& viewer : viewers) {
        PoseRequest pose = poseOf(viewer->id(), 64, 36, 0);
        pose.show = viewer->id() == 2 ? 5 : 0;
        viewer->setPose(pose);
    }
    ASSERT_TRUE(planner.plan(viewers, 1, {.budget_ms = 50}, kStart, batch));
    ASSERT_EQ(batch.jobs.size(), 3u);
    ASSERT_EQ(batch.eyes.size(), 2u);
    for (const BatchJob& job : batch.jobs) EXPECT_EQ(batch.eyes[job.first_eye].show, job.due.request.show);
}

// The plan is made for all who watched lately, also for those who are not due at this tick: it does not swing.
TEST(BatchPlanner, ThePlanIsMadeForAllOfTheLastSecond) {
    BatchPlanner planner;
    BatchContents batch;
    std::vector viewers{viewerOf(1), viewerOf(2)};
    viewers[1]->setPose(poseOf(1, 128, 72));
    using Widths = std::vector<uint32_t>;
    // The first one moves, the other stands still.
    const auto at = [&](uint32_t ms) {
        const Clock::time_point now = kStart + std::chrono::milliseconds(ms);
        if (viewers.size() == 2) viewers[0]->setPose(poseOf(ms, 64, 36, float(ms)));
        EXPECT_TRUE(planner.plan(viewers, 1, {.budget_ms = 50}, now, batch));
        EXPECT_EQ(batch.jobs.size(), ms == 1 ? 2u : 1u);
        deliver(batch, now);
        Widths widths;
        for (const PlanView& view : batch.views) widths.push_back(view.width);
        return widths;
    };
    for (uint32_t ms = 1; ms < 1000; ms += 16) EXPECT_EQ(at(ms), (Widths{64, 128})) << ms;
    EXPECT_EQ(at(1100), Widths{64});
    viewers.erase(viewers.begin());
    viewers[0]->setPose(poseOf(2, 128, 72, 1));
    EXPECT_EQ(at(1116), Widths{128}) << "who has left counts no more";
}

// Pictures of full colour take twice the bytes.
TEST(BatchPlanner, FullColourCountsInTheBytesOfABatch) {
    for (const bool full : {false, true}) {
        BatchPlanner planner;
        BatchContents batch;
        std::vector viewers{viewerOf(1), viewerOf(2)};
        for (size_t i = 0; i < viewers.size(); ++i) viewers[i]->setPose(poseOf(1, 64, 36, float(i)));
        const uint64_t bytes = 2 * PlaneLayout{64, 36, false}.bytes();
        EXPECT_TRUE(planner.plan(viewers, 1, {.budget_ms = 50, .full = full, .bytes = bytes}, kStart, batch));
        EXPECT_EQ(batch.jobs.size(), full ? 1u : 2u);
    }
}

// Snapshots neither hold up those who watch, nor wait for them, nor count in what the plan is made for.
TEST(BatchPlanner, OneShotPicturesTakeTurnsWithTheViewers) {
    BatchPlanner planner;
    BatchContents batch;
    std::vector viewers{viewerOf(1), viewerOf(2), viewerOf(3), viewerOf(4)};
    viewers[0]->setPose(poseOf(1, 64, 36));
    for (size_t i = 1; i < viewers.size(); ++i) { // the last two ask for the same picture
        PoseRequest once = poseOf(1, 640, 360, i == 1 ? 1.0f : 2.0f);
        once.one_shot = true;
        once.received = kStart + std::chrono::milliseconds(i == 1 ? 5 : 0);
        viewers[i]->setPose(once);
    }
    std::vector<std::vector<uint32_t>> drawn;
    for (uint64_t scene = 1; scene <= 6; ++scene) {
        const Clock::time_point now = kStart + std::chrono::milliseconds(20 * scene);
        if (!planner.plan(viewers, scene, {.budget_ms = 50}, now, batch)) continue;
        drawn.emplace_back();
        for (const BatchJob& job : batch.jobs) drawn.back().push_back(job.viewer->id());
        const bool once = drawn.back().front() != 1;
        EXPECT_EQ(batch.one_shot, once);
        EXPECT_EQ(batch.still_pictures, once);
        ASSERT_EQ(batch.views.size(), 1u);
        EXPECT_EQ(batch.views[0].width, once ? 640u : 64u);
        EXPECT_EQ(batch.full_batch_ratio, 1.0f);
        deliver(batch, now);
    }
    EXPECT_EQ(drawn, (std::vector<std::vector<uint32_t>>{{1}, {3, 4}, {1}, {2}, {1}, {1}}));
}

// Pictures whose shaders are not compiled yet: those who watch go on.
TEST(BatchPlanner, HeldSnapshotsAndStillPicturesWaitAndNobodyElseDoes) {
    BatchPlanner planner;
    BatchContents batch;
    std::vector viewers{viewerOf(1), viewerOf(2), viewerOf(3)};
    viewers[0]->setPose(poseOf(1, 64, 36));
    for (size_t i = 1; i < viewers.size(); ++i) {
        PoseRequest once = poseOf(1, 640, 360, float(i));
        once.one_shot = true;
        viewers[i]->setPose(once);
    }
    const uint32_t deferred[] = {2};
    std::vector<uint32_t> drawn;
    for (uint64_t scene = 1; scene <= 6; ++scene) {
        const Clock::time_point now = kStart + std::chrono::milliseconds(20 * scene);
        if (!planner.plan(viewers, scene, {.budget_ms = 50, .deferred = deferred}, now, batch)) continue;
        for (const BatchJob& job : batch.jobs) drawn.push_back(job.viewer->id());
        deliver(batch, now);
    }
    EXPECT_EQ(std::ranges::count(drawn, 2u), 0);
    EXPECT_EQ(std::ranges::count(drawn, 3u), 1);
    EXPECT_EQ(std::ranges::count(drawn, 1u), 5);
    const Clock::time_point later = kStart + std::chrono::seconds(2);
    viewers.resize(1);
    EXPECT_FALSE(planner.plan(viewers, 6, {.budget_ms = 50, .still = false}, later, batch));
    ASSERT_TRUE(planner.plan(viewers, 6, {.budget_ms = 50}, later, batch));
    EXPECT_TRUE(batch.still_pictures);
}

// Four who ask for snapshots without a pause, from one address, beside one who watches: each side has half of the time.
TEST(BatchPlanner, OneShotPicturesOfAnOwnerShareOneSeat) {
    BatchPlanner planner;
    BatchContents batch;
    const auto watcher = viewerOf(1);
    watcher->setPose(poseOf(1, 100, 100));
    uint32_t next = 2;
    std::vector<std::shared_ptr<Viewer>> askers(4);
    double watched_ms = 0, once_ms = 0;
    Clock::time_point now = kStart;
    while (now < kStart + std::chrono::seconds(20)) {
        const auto scene = uint64_t((now - kStart) / kTick); // it moves once a tick
        std::vector viewers{watcher};
        for (auto& asker : askers) {
            if (!asker) {
                asker = viewerOf(next);
                asker->known("", "address 1");
                PoseRequest once = poseOf(1, 200, 200, float(next++));
                once.one_shot = true;
                asker->setPose(once);
            }
            viewers.push_back(asker);
        }
        now += std::chrono::milliseconds(1);
        if (!planner.plan(viewers, scene, {.budget_ms = 50, .ms_per_pixel = 0.002}, now, batch)) continue;
        ASSERT_EQ(batch.jobs.size(), 1u);
        const double took = batch.one_shot ? 160 : 20;
        (batch.one_shot ? once_ms : watched_ms) += took;
        batch.jobs[0].gpu_ms = float(took);
        planner.took(batch, 0, 1, true);
        deliver(batch, now);
        now += std::chrono::milliseconds(int(took));
        for (auto& asker : askers)
            if (asker == batch.jobs[0].viewer) asker.reset();
    }
    EXPECT_GT(watched_ms, 0.8 * once_ms);
    EXPECT_GT(once_ms, 0.5 * watched_ms);
}

// What rests is drawn once more, finer, when nothing has changed for anybody; then nothing at all.
TEST(BatchPlanner, StillPicturesComeOnceNothingMoves) {
    BatchPlanner planner;
    BatchContents batch;
    const std::vector viewers{viewerOf(1)};
    viewers[0]->setPose(poseOf(1, 64, 36));
    Clock::time_point now = kStart;
    ASSERT_TRUE(planner.plan(viewers, 1, {.budget_ms = 50}, now, batch));
    EXPECT_FALSE(batch.still_pictures);
    deliver(batch, now);
    EXPECT_FALSE(planner.plan(viewers, 1, {.budget_ms = 50}, now + std::chrono::milliseconds(100), batch));
    now += std::chrono::milliseconds(200);
    ASSERT_TRUE(planner.plan(viewers, 1, {.budget_ms = 50}, now, batch));
    EXPECT_TRUE(batch.still_pictures);
    deliver(batch, now);
    EXPECT_FALSE(planner.plan(viewers, 1, {.budget_ms = 50}, now + std::chrono::seconds(1), batch));
    const double none = std::numeric_limits<double>::quiet_NaN(); // a ratio of a plan that there is not yet
    EXPECT_FALSE(planner.plan(viewers, 1, {.budget_ms = 50, .most_ms = 500, .ms_per_pixel = none, .still_ratio = none},
                              now + std::chrono::seconds(1), batch));
    ASSERT_TRUE(planner.plan(viewers, 2, {.budget_ms = 50}, now + std::chrono::seconds(2), batch));
    EXPECT_FALSE(batch.still_pictures); // the scene moved
}

// Fairness without a clock: the device takes 1 us a pixel, viewers of several sizes want a picture at every tick.
TEST(BatchPlanner, NobodyWaitsForeverUnderOverload) {
    BatchPlanner planner;
    BatchContents batch;
    std::vector<std::shared_ptr<Viewer>> viewers;
    for (uint32_t id = 1; id <= 6; ++id) viewers.push_back(viewerOf(id));
    const auto sideOf = [](uint32_t id) { return uint16_t(id == 1 ? 300 : 100); };
    std::map<uint32_t, int> frames;
    std::map<uint32_t, Clock::time_point> last;
    Clock::duration longest{};
    Clock::time_point now = kStart;
    for (uint32_t tick = 1; now < kStart + std::chrono::seconds(20); ++tick) {
        for (const auto& viewer : viewers)
            viewer->setPose(
                poseOf(tick, sideOf(viewer->id()), sideOf(viewer->id()), float(tick) + 0.1f * float(viewer->id())));
        Clock::duration took = kTick;
        if (planner.plan(viewers, tick, {.budget_ms = 40}, now, batch)) {
            double ms = 0;
            for (BatchJob& job : batch.jobs) {
                job.gpu_ms = float(job.due.request.width) * float(job.due.request.height) * 1e-3f;
                ms += double(job.gpu_ms);
                Clock::time_point& before = last.try_emplace(job.viewer->id(), kStart).first->second;
                longest = std::max(longest, now - before);
                before = now;
                ++frames[job.viewer->id()];
            }
            took = std::max<Clock::duration>(took, std::chrono::microseconds(int64_t(ms * 1e3)));
            planner.took(batch, 0, 1, true);
            deliver(batch, now + took);
            EXPECT_GE(batch.full_batch_ratio, 1);
        }
        now += took;
    }
    for (const auto& viewer : viewers) EXPECT_GT(frames[viewer->id()], 20) << viewer->id();
    EXPECT_LT(longest, std::chrono::milliseconds(1500));
    EXPECT_GT(frames[2], 2 * frames[1]); // nine times as many pixels come more rarely
}

TEST(BatchPlanner, ABatchKeepsWithinTheBytesThatTheDeviceAllows) {
    BatchPlanner planner;
    BatchContents batch;
    std::vector<std::shared_ptr<Viewer>> viewers;
    for (uint32_t id = 1; id <= 4; ++id) {
        viewers.push_back(viewerOf(id));
        viewers.back()->setPose(poseOf(1, 64, 64, float(id)));
    }
    const BatchPlanner::Limits limits{.budget_ms = 1000, .bytes = 2 * 64 * 64 * 3 / 2};
    ASSERT_TRUE(planner.plan(viewers, 1, limits, kStart, batch));
    EXPECT_EQ(batch.jobs.size(), 2u);
    ASSERT_TRUE(planner.plan(viewers, 1, limits, kStart + kTick, batch));
    EXPECT_EQ(batch.jobs.size(), 2u); // the others
    viewers.resize(1);
    viewers[0]->setPose(poseOf(2, 640, 640));
    ASSERT_TRUE(planner.plan(viewers, 1, limits, kStart + 2 * kTick, batch));
    EXPECT_EQ(batch.jobs.size(), 1u); // alone, for the device to judge
}

TEST(BatchPlanner, WhoIsRefusedIsNotDrawn) {
    BatchPlanner planner;
    BatchContents batch;
    const std::vector viewers{viewerOf(1)};
    viewers[0]->setPose(poseOf(1, 64, 36));
    viewers[0]->refuse("too large");
    EXPECT_FALSE(planner.plan(viewers, 1, {.budget_ms = 50}, kStart, batch));
    EXPECT_EQ(viewers[0]->refusal(), "too large");
}

} // namespace
} // namespace brume
