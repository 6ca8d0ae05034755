// Where the device's time goes.
#include <gtest/gtest.h>

#include "server/loop/device_ledger.h"

namespace brume {
namespace {

constexpr uint16_t kWide = 320, kNarrow = 160;

// Two viewers: one eye of 320x100, two of 160x100 each.
BatchContents twoViewers() {
    BatchContents batch;
    for (uint32_t i = 0; i < 2; ++i) {
        BatchJob& job = batch.jobs.emplace_back();
        job.viewer = std::make_shared<Viewer>(i + 1, PacingOptions{}, nullptr);
        job.pictures = i;
        job.first_eye = i;
        job.due.request.width = i == 0 ? kWide : kNarrow;
        job.due.request.height = 100;
        job.due.request.views = uint8_t(i + 1);
    }
    batch.eyes = {{{}, kWide, 100}, {{}, kNarrow, 100}, {{}, kNarrow, 100, true}};
    return batch;
}

TEST(DeviceLedger, TimeIsSharedByViewsAndPixels) {
    BatchContents batch = twoViewers();
    const gpu::PassSample samples[] = {{"light", gpu::kShared, 5, 0},
                                       {"medium", 0, 2, 0},
                                       {"medium", 1, 3, 0},
                                       {"medium", 2, 4, 0},
                                       {"compose", gpu::kEach, 8, 0}};
    DeviceLedger ledger;
    const DeviceLedger::Times times = ledger.book(samples, batch);
    EXPECT_DOUBLE_EQ(times.shared_ms, 5);
    EXPECT_DOUBLE_EQ(times.views_ms, 17);
    EXPECT_DOUBLE_EQ(times.shown_ms, 0);
    EXPECT_FLOAT_EQ(batch.jobs[0].gpu_ms, 2 + 4);     // half of the pixels
    EXPECT_FLOAT_EQ(batch.jobs[1].gpu_ms, 3 + 4 + 4); // both of its eyes, and the other half
}

TEST(DeviceLedger, ViewsOfHowAPictureIsMadeAreTheirViewersAlone) {
    BatchContents batch = twoViewers();
    const gpu::PassSample samples[] = {{"medium", gpu::kEach, 8, 0}, {"show", 0, 50, 0}};
    DeviceLedger ledger;
    const DeviceLedger::Times times = ledger.book(samples, batch);
    EXPECT_DOUBLE_EQ(times.views_ms, 58);
    EXPECT_DOUBLE_EQ(times.shown_ms, 50);
    EXPECT_FLOAT_EQ(batch.jobs[0].gpu_ms, 4 + 50);
    EXPECT_FLOAT_EQ(batch.jobs[1].gpu_ms, 4);
}

TEST(DeviceLedger, APassOfSeveralViewsCountsAsTheMeanOfOne) {
    BatchContents batch = twoViewers();
    DeviceLedger ledger;
    const gpu::PassSample first[] = {{"compose", gpu::kEach, 9, 0}, {"medium", 0, 2, 0}};
    ledger.book(first, batch);
    ASSERT_EQ(ledger.passes().size(), 2u);
    EXPECT_FLOAT_EQ(ledger.passes()[0].ms, 3);
    const gpu::PassSample second[] = {{"medium", 0, 12, 0}, {"medium", 1, 12, 0}};
    ledger.book(second, batch);
    EXPECT_FLOAT_EQ(ledger.passes()[0].ms, 3); // it was not in this batch
    EXPECT_GT(ledger.passes()[1].ms, 2);
    EXPECT_LT(ledger.passes()[1].ms, 12);
}

} // namespace
} // namespace brume
