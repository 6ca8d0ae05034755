// How large a submission's pictures are: a frame of all viewers has its time.
#include <map>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "server/loop/tick_source.h"
#include "tests/unit/planned_viewers.h"

namespace brume::batch_sizes_test {
namespace {

using test::deliver, test::kStart, test::poseOf, test::viewerOf;

// Twenty who say hello and then all wish for two eyes of 1920x1080: a frame of all stays within its time from the
// first, and who wishes for little gets it.
TEST(BatchSizes, WishesThatDoNotFitAreMadeSmallerAtOnce) {
    BatchPlanner planner;
    BatchContents batch;
    std::vector<std::shared_ptr<Viewer>> viewers;
    for (uint32_t i = 0; i < 20; ++i) {
        viewers.push_back(viewerOf(i + 1));
        viewers[i]->setPose(i == 7 ? poseOf(1, 320, 180, float(i)) : poseOf(1, 1920, 1080, float(i), 2));
    }
    constexpr double kPerPixel = 660.0 / (1920 * 1080 * 2); // ms
    Clock::time_point now = kStart;
    std::map<uint32_t, uint32_t> widths;
    for (uint64_t scene = 1; scene < 60; ++scene) {
        now += std::chrono::milliseconds(100);
        ASSERT_TRUE(
            planner.plan(viewers, scene, {.budget_ms = 50, .most_ms = 500, .ms_per_pixel = kPerPixel}, now, batch));
        EXPECT_LE(planner.fullBatchMs(), 500) << scene;
        for (BatchJob& job : batch.jobs) {
            job.gpu_ms = float(pixelsOf(job.due.request) * kPerPixel);
            const auto [width, is_new] = widths.emplace(job.viewer->id(), job.due.request.width);
            EXPECT_EQ(width->second, job.due.request.width) << "sizes do not swing";
        }
        planner.took(batch, 0, 1, true);
        deliver(batch, now);
    }
    ASSERT_EQ(widths.size(), 20u);
    for (const auto& [id, width] : widths) EXPECT_EQ(width, id == 8 ? 320u : 360u) << id;
}

// A class: all but `others` have the camera of the first. A pixel costs `per_pixel` ms. Who is drawn how often, and
// with what width, in 20 s; the camera moves for ever.
struct Drawn {
    std::map<uint32_t, int> frames;           // by viewer
    std::map<uint32_t, std::set<int>> widths; // by viewer, of the second half
    int pictures = 0;
};
Drawn drawClass(uint32_t followers, uint32_t others, double per_pixel, bool keeps_size) {
    BatchPlanner planner;
    BatchContents batch;
    std::vector<std::shared_ptr<Viewer>> viewers;
    for (uint32_t id = 1; id <= 1 + followers + others; ++id) viewers.push_back(viewerOf(id));
    Drawn out;
    Clock::time_point now = kStart;
    const Clock::time_point end = kStart + std::chrono::seconds(20);
    for (uint32_t seq = 1; now < end; ++seq) {
        PoseRequest lead = poseOf(seq, 640, 360, float(seq));
        lead.keeps_size = keeps_size;
        for (const auto& viewer : viewers) {
            PoseRequest own = poseOf(seq, 640, 360, float(seq) + 0.01f * float(viewer->id()));
            own.keeps_size = keeps_size;
            if (viewer->id() == 1)
                viewer->setPose(lead);
            else if (viewer->id() <= 1 + followers)
                viewer->follow(1, lead, &own);
            else
                viewer->setPose(own);
        }
        now += std::chrono::milliseconds(17);
        if (!planner.plan(viewers, seq, {.budget_ms = 16, .most_ms = 50, .ms_per_pixel = per_pixel}, now, batch))
            continue;
        std::set<uint32_t> pictures;
        double took = 0;
        for (BatchJob& job : batch.jobs) {
            job.gpu_ms = float(pixelsOf(job.due.request) * per_pixel);
            if (pictures.insert(job.pictures).second) took += double(job.gpu_ms);
            ++out.frames[job.viewer->id()];
            if (now > kStart + std::chrono::seconds(10)) out.widths[job.viewer->id()].insert(job.due.request.width);
        }
        out.pictures += int(pictures.size());
        now += std::chrono::microseconds(int64_t(1e3 * took));
        planner.took(batch, 0, 1, true);
        deliver(batch, now);
    }
    return out;
}

// Those who follow cost one picture, and get it as large and as often as one viewer alone.
TEST(BatchSizes, AClassThatFollowsCostsOnePicture) {
    for (const bool keeps_size : {false, true}) {
        SCOPED_TRACE(keeps_size);
        constexpr double kPerPixel = 40.0 / (640 * 360);
        const Drawn alone = drawClass(0, 0, kPerPixel, keeps_size), all = drawClass(19, 0, kPerPixel, keeps_size);
        EXPECT_NEAR(all.pictures, alone.pictures, 0.1 * alone.pictures);
        for (uint32_t id = 1; id <= 20; ++id) {
            EXPECT_GE(all.frames.at(id), 0.9 * alone.frames.at(1)) << id;
            EXPECT_EQ(all.widths.at(id), std::set{640}) << id;
        }
    }
}

// A class of twenty and five who look for themselves have the time of twenty-five.
TEST(BatchSizes, WhoLooksForHimselfBesideAClassHasHisPart) {
    constexpr double kPerPixel = 100.0 / (640 * 360);
    const Drawn all = drawClass(19, 5, kPerPixel, true);
    const double whole = 20'000 / 100.0; // pictures of one viewer alone, half of their size
    double others = 0;
    for (uint32_t id = 21; id <= 25; ++id) others += all.frames.at(id);
    for (uint32_t id = 1; id <= 20; ++id) EXPECT_GT(all.frames.at(id), 0.6 * whole) << id;
    EXPECT_GT(others, 5 * 0.6 * whole / 25);
}

// Sixteen of 640x360 that take 110 ms each, of whom half would rather have fewer pictures than smaller ones. One whose
// single picture takes too long gets it smaller all the same.
TEST(BatchSizes, WhoKeepsTheSizeComesMoreSeldomInstead) {
    BatchPlanner planner;
    BatchContents batch;
    std::vector<std::shared_ptr<Viewer>> viewers;
    for (uint32_t i = 0; i < 16; ++i) viewers.push_back(viewerOf(i + 1));
    constexpr double kPerPixel = 110.0 / (640 * 360); // ms
    Clock::time_point now = kStart;
    std::map<uint32_t, std::pair<uint32_t, uint32_t>> drawn; // width and number of pictures
    for (uint32_t seq = 1; seq < 200; ++seq, now += std::chrono::milliseconds(50)) {
        for (uint32_t i = 0; i < 16; ++i) {
            PoseRequest pose = i == 1 ? poseOf(seq, 1920, 1080, float(seq)) : poseOf(seq, 640, 360, float(seq + i));
            pose.keeps_size = i % 2 == 1;
            viewers[i]->setPose(pose);
        }
        ASSERT_TRUE(
            planner.plan(viewers, seq, {.budget_ms = 50, .most_ms = 500, .ms_per_pixel = kPerPixel}, now, batch));
        for (BatchJob& job : batch.jobs) {
            job.gpu_ms = float(pixelsOf(job.due.request) * kPerPixel);
            auto& [width, count] = drawn[job.viewer->id()];
            width = job.due.request.width, ++count;
        }
        planner.took(batch, 0, 1, true);
        deliver(batch, now);
    }
    ASSERT_EQ(drawn.size(), 16u);
    for (const auto& [id, one] : drawn) {
        if (id == 2) {
            EXPECT_TRUE(one.first > 640 && one.first < 1920) << one.first;
        } else if (id % 2 == 0) {
            EXPECT_EQ(one.first, 640u) << id;
        } else {
            EXPECT_LT(one.first, 640u) << id;
        }
        EXPECT_GT(one.second, id % 2 == 0 ? 1u : 3u) << id << " is not forgotten";
    }
    EXPECT_GT(drawn[1].second, 2 * drawn[4].second) << "who takes smaller ones gets more of them";
}

// Sixteen pictures of 80x48 take 3 ms each, which is what their passes cost, however small they are. There is room for
// many more, and a large one is not taken for a dear one.
TEST(BatchSizes, SmallPicturesMakeNoPixelDear) {
    BatchPlanner planner;
    BatchContents batch;
    std::vector<std::shared_ptr<Viewer>> viewers;
    for (uint32_t id = 1; id <= 16; ++id) viewers.push_back(viewerOf(id));
    Clock::time_point now = kStart;
    for (uint32_t seq = 1; seq <= 40; ++seq, now += std::chrono::milliseconds(50)) {
        for (const auto& viewer : viewers) viewer->setPose(poseOf(seq, 80, 48, float(seq)));
        ASSERT_TRUE(planner.plan(viewers, seq, {.budget_ms = 50, .most_ms = 500}, now, batch));
        for (BatchJob& job : batch.jobs) job.gpu_ms = 3;
        planner.took(batch, 0, 1, true);
        deliver(batch, now);
    }
    EXPECT_NEAR(planner.viewersInTime(kLeastPixels, 500), 500 / 3.0, 1);
    const std::vector newcomer{viewerOf(17)};
    newcomer[0]->setPose(poseOf(1, 640, 360));
    ASSERT_TRUE(planner.plan(newcomer, 41, {.budget_ms = 50, .most_ms = 500}, now, batch));
    EXPECT_EQ(batch.jobs.front().due.request.width, 640);
}

// One frame that took far too long, since the machine had other work: the picture at rest is whole again soon.
TEST(BatchSizes, OneSlowFrameLeavesNoSmallPictureAtRest) {
    constexpr double kPerPixel = 1e-4; // ms
    BatchPlanner planner;
    BatchContents batch;
    const std::vector viewers{viewerOf(1)};
    viewers[0]->setPose(poseOf(1, 640, 360));
    Clock::time_point now = kStart;
    const auto draw = [&](double slower) {
        now += std::chrono::milliseconds(200);
        if (!planner.plan(viewers, 1, {.budget_ms = 50, .most_ms = 500, .ms_per_pixel = kPerPixel}, now, batch))
            return false;
        BatchJob& job = batch.jobs.front();
        job.gpu_ms = float(slower * pixelsOf(job.due.request) * kPerPixel * (batch.still_pictures ? 4 : 1));
        planner.took(batch, 0, 1, !batch.still_pictures);
        deliver(batch, now);
        return true;
    };
    ASSERT_TRUE(draw(1000));
    std::vector<uint16_t> widths;
    bool still = false;
    while (draw(1)) {
        ASSERT_LT(widths.size(), 8u);
        widths.push_back(batch.jobs.front().due.request.width);
        still = batch.still_pictures;
    }
    ASSERT_FALSE(widths.empty());
    EXPECT_LT(widths.front(), 640) << "nothing is tested";
    EXPECT_EQ(widths.back(), 640);
    EXPECT_TRUE(still);
}

} // namespace
} // namespace brume::batch_sizes_test
