// The window, the mailbox and the audience, without sockets or devices.
#include <atomic>
#include <thread>

#include <gtest/gtest.h>

#include "server/viewer/audience.h"
#include "tests/unit/take_due.h"

namespace brume {
namespace {

TEST(Viewer, NothingIsDueBeforeAPose) {
    Viewer viewer(1, windowOf(2), nullptr);
    EXPECT_FALSE(takeDue(viewer));
    EXPECT_EQ(viewer.takeFrame(), nullptr);
}

TEST(Viewer, RendersAgainForTheSamePoseUntilTheWindowIsFull) {
    Viewer viewer(1, windowOf(2), nullptr);
    viewer.setPose(poseWithSeq(5));
    const auto first = takeDue(viewer), second = takeDue(viewer);
    ASSERT_TRUE(first && second);
    EXPECT_EQ(first->frame_id, 1u);
    EXPECT_EQ(second->frame_id, 2u);
    EXPECT_EQ(second->request.seq, 5u);
    EXPECT_FALSE(takeDue(viewer));
    EXPECT_EQ(viewer.counts().in_flight, 2u);
}

TEST(Viewer, NewestPoseWinsAndSequenceWrapsAround) {
    Viewer viewer(1, windowOf(8), nullptr);
    viewer.setPose(poseWithSeq(0xfffffffe));
    viewer.setPose(poseWithSeq(0xfffffffd)); // older
    EXPECT_EQ(takeDue(viewer)->request.seq, 0xfffffffeu);
    viewer.setPose(poseWithSeq(1)); // three later, across the wrap
    EXPECT_EQ(takeDue(viewer)->request.seq, 1u);
    viewer.setPose(poseWithSeq(0xffffffff)); // late
    EXPECT_EQ(takeDue(viewer)->request.seq, 1u);
    auto repeated = poseWithSeq(1);
    repeated.width = 99;
    viewer.setPose(repeated); // equal is not newer
    EXPECT_NE(takeDue(viewer)->request.width, 99);
}

TEST(Viewer, AcknowledgingFreesThatFrameAndAllBefore) {
    Viewer viewer(1, windowOf(3), nullptr);
    viewer.setPose(poseWithSeq(1));
    for (int i = 0; i < 3; ++i) {
        viewer.deliver(frameFor(*takeDue(viewer)));
        ASSERT_NE(viewer.takeFrame(), nullptr);
    }
    EXPECT_FALSE(takeDue(viewer));
    EXPECT_TRUE(viewer.acknowledge(2));
    EXPECT_EQ(viewer.counts().in_flight, 1u);
    EXPECT_EQ(viewer.counts().acknowledged, 2u);
    EXPECT_TRUE(viewer.acknowledge(2)); // again: harmless
    EXPECT_EQ(viewer.counts().acknowledged, 2u);
    EXPECT_TRUE(takeDue(viewer));
}

TEST(Viewer, AcknowledgingWhatWasNeverSentIsRefused) {
    Viewer viewer(1, windowOf(2), nullptr);
    EXPECT_FALSE(viewer.acknowledge(0));
    EXPECT_FALSE(viewer.acknowledge(1));
    viewer.setPose(poseWithSeq(1));
    const auto due = takeDue(viewer);
    EXPECT_FALSE(viewer.acknowledge(1)); // handed out, not sent
    viewer.deliver(frameFor(*due));
    EXPECT_FALSE(viewer.acknowledge(1)); // ready, not sent
    viewer.takeFrame();
    EXPECT_FALSE(viewer.acknowledge(2));
    EXPECT_FALSE(viewer.acknowledge(0));
    EXPECT_TRUE(viewer.acknowledge(1));
    EXPECT_EQ(viewer.counts().in_flight, 0u);
}

TEST(Viewer, AFrameReplacedBeforeItWasTakenGivesItsPlaceBack) {
    Viewer viewer(1, windowOf(2), nullptr);
    viewer.setPose(poseWithSeq(1));
    viewer.deliver(frameFor(*takeDue(viewer)));
    viewer.deliver(frameFor(*takeDue(viewer)));
    EXPECT_EQ(viewer.counts().superseded, 1u);
    EXPECT_EQ(viewer.counts().in_flight, 1u);
    EXPECT_EQ(viewer.takeFrame()->id, 2u);
    EXPECT_EQ(viewer.takeFrame(), nullptr);
}

TEST(Viewer, AnOvertakenFrameIsDropped) {
    Viewer viewer(1, windowOf(3), nullptr);
    viewer.setPose(poseWithSeq(1));
    const auto first = takeDue(viewer), second = takeDue(viewer), third = takeDue(viewer);
    viewer.deliver(frameFor(*second));
    viewer.deliver(frameFor(*first)); // out of order, the newer one still waits
    EXPECT_EQ(viewer.takeFrame()->id, 2u);
    EXPECT_EQ(viewer.counts().in_flight, 2u);
    viewer.deliver(frameFor(*third));
    EXPECT_EQ(viewer.takeFrame()->id, 3u);
    viewer.deliver(frameFor(*second)); // twice, after newer ones went
    EXPECT_EQ(viewer.takeFrame(), nullptr);
    EXPECT_TRUE(viewer.acknowledge(3));
    EXPECT_EQ(viewer.counts().in_flight, 0u);
    EXPECT_EQ(viewer.counts().superseded, 2u);
}

// Where a frame takes longer than the ticks that a step leaves out, none is left out besides.
TEST(Viewer, RateIsGivenUpInTimeNotInLooks) {
    Viewer viewer(1, windowOf(2), nullptr);
    viewer.setPose(poseWithSeq(1));
    Clock::time_point now = Clock::now();
    const auto present = [&] {
        const auto due = takeDue(viewer, now);
        if (!due) return false;
        viewer.deliver(frameFor(*due, now));
        viewer.takeFrame(now);
        viewer.acknowledge(due->frame_id, now);
        return true;
    };
    ASSERT_TRUE(present());
    for (uint32_t step = 1; step < QualityControl::kSteps; ++step) { // a ping that waited in the link's queue
        viewer.ponged(std::chrono::milliseconds(step == 1 ? 1 : 200), now += std::chrono::milliseconds(300));
        viewer.observe(now);
        ASSERT_TRUE(present()) << step;
    }
    viewer.ponged(std::chrono::milliseconds(200), now += std::chrono::milliseconds(300));
    viewer.observe(now);
    viewer.observe(now += std::chrono::milliseconds(300));
    ASSERT_EQ(viewer.link().step.every, 4);
    ASSERT_TRUE(present());
    now += std::chrono::milliseconds(30);
    EXPECT_FALSE(present()) << "two ticks later";
    now += std::chrono::milliseconds(100);
    EXPECT_TRUE(present()) << "the first look after six more";
}

TEST(Viewer, AbandoningGivesThePlaceBack) {
    Viewer viewer(1, windowOf(1), nullptr);
    viewer.setPose(poseWithSeq(1));
    const auto due = takeDue(viewer);
    EXPECT_FALSE(takeDue(viewer));
    viewer.abandon(due->frame_id);
    EXPECT_TRUE(takeDue(viewer));
}

TEST(Viewer, TellsOfEveryFrameAndMayBeAskedFromTheNotice) {
    Viewer* self = nullptr;
    int told = 0, taken = 0;
    Viewer viewer(1, windowOf(1), [&] {
        ++told;
        if (self->takeFrame()) ++taken;
    });
    self = &viewer;
    viewer.setPose(poseWithSeq(1));
    viewer.deliver(frameFor(*takeDue(viewer)));
    viewer.acknowledge(1);
    viewer.deliver(frameFor(*takeDue(viewer)));
    EXPECT_EQ(told, 2);
    EXPECT_EQ(taken, 2);
}

TEST(Viewer, ClosedMeansNoWorkAndNoNotice) {
    int told = 0;
    Viewer viewer(1, windowOf(2), [&] { ++told; });
    viewer.setPose(poseWithSeq(1));
    const auto due = takeDue(viewer);
    viewer.close();
    viewer.deliver(frameFor(*due));
    EXPECT_EQ(told, 0);
    EXPECT_EQ(viewer.takeFrame(), nullptr);
    EXPECT_FALSE(takeDue(viewer));
    viewer.setPose(poseWithSeq(2));
    EXPECT_FALSE(takeDue(viewer));
}

TEST(Viewer, CloseWaitsForARunningNotice) {
    std::atomic<bool> inside{false}, release{false}, closed{false};
    Viewer viewer(1, windowOf(1), [&] {
        inside = true;
        while (!release) std::this_thread::yield();
        EXPECT_FALSE(closed.load());
    });
    viewer.setPose(poseWithSeq(1));
    const auto due = takeDue(viewer);
    std::thread loop([&] { viewer.deliver(frameFor(*due)); });
    while (!inside) std::this_thread::yield();
    std::thread closer([&] {
        viewer.close();
        closed = true;
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(20)); // room for a close that does not wait to be seen
    release = true;
    loop.join();
    closer.join();
    EXPECT_TRUE(closed.load());
}

TEST(Viewer, TwoThreadsNeverExceedTheWindow) {
    Viewer viewer(1, windowOf(2), nullptr);
    viewer.setPose(poseWithSeq(1));
    std::atomic<bool> done{false};
    std::thread connection([&] {
        uint32_t last = 0;
        while (!done) {
            const FramePtr frame = viewer.takeFrame();
            if (!frame) continue;
            EXPECT_GT(frame->id, last);
            last = frame->id;
            EXPECT_TRUE(viewer.acknowledge(frame->id));
        }
    });
    for (int rendered = 0; rendered < 20000;) {
        EXPECT_LE(viewer.counts().in_flight, 2u);
        const auto due = takeDue(viewer);
        if (!due) continue;
        viewer.deliver(frameFor(*due));
        ++rendered;
    }
    done = true;
    connection.join();
    const auto counts = viewer.counts();
    EXPECT_EQ(counts.rendered, 20000u);
    EXPECT_EQ(counts.sent + counts.superseded + (viewer.takeFrame() ? 1 : 0), 20000u);
}

// Everything rests: once finer after 150 ms, once without loss after as much again, then nothing.
TEST(Viewer, WhatRestsComesFinerThenWithoutLossThenNotAtAll) {
    for (const bool takes_png : {true, false}) {
        Viewer viewer(1, windowOf(4), nullptr);
        PoseRequest pose = poseWithSeq(1);
        pose.takes_png = takes_png;
        viewer.setPose(pose);
        Clock::time_point now{std::chrono::hours(1)};
        const auto pass = [&](int ms) { now += std::chrono::milliseconds(ms); };
        ASSERT_TRUE(takeDue(viewer, now, 7));
        EXPECT_FALSE(takeDue(viewer, now, 7)); // the same again
        pass(149);
        EXPECT_FALSE(takeDue(viewer, now, 7, true));
        pass(1);
        const auto still = takeDue(viewer, now, 7, true);
        ASSERT_TRUE(still);
        EXPECT_TRUE(still->request.still_picture);
        EXPECT_FALSE(still->request.lossless);
        EXPECT_GE(still->request.quality, 90);
        pass(149);
        EXPECT_FALSE(takeDue(viewer, now, 7, true));
        pass(1);
        const auto lossless = takeDue(viewer, now, 7, true);
        EXPECT_EQ(lossless.has_value(), takes_png);
        if (takes_png) {
            EXPECT_TRUE(lossless->request.still_picture && lossless->request.lossless);
        }
        pass(10'000);
        EXPECT_FALSE(takeDue(viewer, now, 7, true));
        EXPECT_FALSE(takeDue(viewer, now, 7));
        const auto moved = takeDue(viewer, now, 8); // the scene goes on
        ASSERT_TRUE(moved);
        EXPECT_FALSE(moved->request.still_picture || moved->request.lossless);
    }
}

// A busy device makes pictures smaller as long as they come again and again. One that rests comes once, and whole.
// The device's level goes up and down meanwhile, and no further picture comes.
TEST(Viewer, WhatRestsComesWholeHoweverBusyTheDeviceWas) {
    constexpr DeviceLoad kBusy{.own_ms = 100, .whole_ms = 100, .budget_ms = 16, .viewers = 1, .exhausted = true};
    constexpr DeviceLoad kIdle{.own_ms = 100, .whole_ms = 0, .budget_ms = 16, .viewers = 1, .exhausted = true};
    for (const double most_pixels : {1e9, 100.0 * 100}) {
        Viewer viewer(1, windowOf(8), nullptr);
        PoseRequest pose = poseWithSeq(1);
        pose.width = 640, pose.height = 360;
        pose.takes_png = true;
        viewer.setPose(pose);
        Clock::time_point now{std::chrono::hours(1)};
        const auto has = [&](const DeviceLoad& load) {
            now += std::chrono::milliseconds(300);
            viewer.deviceHas(load);
            viewer.observe(now, false);
        };
        has(kBusy);
        ASSERT_EQ(viewer.link().device_level, 1u);
        const auto moving = takeDue(viewer, now, 7);
        ASSERT_TRUE(moving);
        EXPECT_EQ(moving->request.width, 320);
        has(kBusy); // the load is that of the picture before
        EXPECT_FALSE(takeDue(viewer, now, 7));
        const uint16_t whole = most_pixels > 1e6 ? 640 : 320;
        for (const bool lossless : {false, true}) {
            now += kRestsFor;
            const auto request = viewer.pollDue(now, 7, true, {.pixels = most_pixels});
            ASSERT_TRUE(request);
            EXPECT_EQ(request->width, whole);
            EXPECT_EQ(request->lossless, lossless);
            EXPECT_EQ(request->reduced, whole == 640 ? Reduced::no : Reduced::device);
            ASSERT_TRUE(viewer.take(*request, now, 7));
        }
        for (int i = 0; i < 20; ++i) {
            has(i < 10 ? kIdle : kBusy);
            if (whole == 640) {
                EXPECT_FALSE(takeDue(viewer, now, 7)) << i;
                EXPECT_FALSE(takeDue(viewer, now, 7, true)) << i;
            }
        }
    }
}

// PNG is large: the next pose's picture would wait behind it.
TEST(Viewer, NothingWithoutLossOverALinkThatQueues) {
    Viewer viewer(1, {.least_frames = 4, .most_frames = 4}, nullptr);
    PoseRequest pose = poseWithSeq(1);
    pose.takes_png = true;
    viewer.setPose(pose);
    Clock::time_point now{std::chrono::hours(1)};
    viewer.ponged(std::chrono::milliseconds(1), now);
    const auto first = takeDue(viewer, now, 7);
    auto frame = std::make_shared<EncodedFrame>();
    frame->id = first->frame_id;
    frame->request = first->request;
    frame->encoded = now;
    frame->jpeg[0] = std::make_shared<const std::vector<uint8_t>>(10'000);
    viewer.deliver(frame);
    ASSERT_TRUE(viewer.takeFrame(now));
    ASSERT_TRUE(viewer.acknowledge(first->frame_id, now));
    viewer.ponged(std::chrono::milliseconds(90), now); // 89 ms of queue: the window of bytes closes
    const auto still = takeDue(viewer, now + std::chrono::milliseconds(200), 7, true);
    ASSERT_TRUE(still && still->request.still_picture);
    EXPECT_FALSE(takeDue(viewer, now + std::chrono::milliseconds(500), 7, true));
}

// Frames that come faster than they are taken: the link's fault only when bytes wait for it.
TEST(Viewer, ReplacedFramesCostQualityOnlyWhereTheLinkIsBehind) {
    for (const bool backlog : {false, true}) {
        Viewer viewer(1, windowOf(4), nullptr);
        Clock::time_point now{std::chrono::hours(1)};
        viewer.setPose(poseWithSeq(1));
        for (int i = 0; i < 2; ++i) {
            const auto due = takeDue(viewer, now);
            ASSERT_TRUE(due);
            auto frame = std::make_shared<EncodedFrame>();
            frame->id = due->frame_id;
            viewer.deliver(std::move(frame));
        }
        ASSERT_EQ(viewer.counts().superseded, 1u);
        viewer.observe(now, backlog);
        EXPECT_EQ(viewer.link().level > 0, backlog);
    }
}

// Its pose grows old while the medium moves, which says nothing of how long frames take.
TEST(Viewer, ARestingCameraKeepsItsRate) {
    Viewer viewer(1, {}, nullptr);
    Clock::time_point now{std::chrono::hours(1)};
    PoseRequest pose = poseWithSeq(1);
    pose.received = now;
    viewer.setPose(pose);
    viewer.ponged(std::chrono::milliseconds(1), now);
    for (uint64_t tick = 1; tick <= 1800; ++tick) {
        now += std::chrono::microseconds(16'667);
        const auto due = takeDue(viewer, now, tick);
        ASSERT_TRUE(due) << tick;
        EXPECT_EQ(due->repeats, tick > 1);
        auto frame = std::make_shared<EncodedFrame>();
        frame->id = due->frame_id;
        frame->request = due->request;
        frame->repeats = due->repeats;
        frame->wait_ms = std::chrono::duration<float, std::milli>(now - due->request.received).count();
        frame->render_ms = 5;
        frame->encoded = now + std::chrono::milliseconds(5);
        viewer.deliver(frame);
        ASSERT_TRUE(viewer.takeFrame(frame->encoded));
        ASSERT_TRUE(viewer.acknowledge(due->frame_id, now + std::chrono::milliseconds(6)));
    }
    EXPECT_LE(viewer.link().frames, 3u);
    EXPECT_NEAR(viewer.history().rate(now), 60, 1);
    EXPECT_EQ(viewer.history().of(0).p99, 0); // no pose has waited
}

TEST(Viewer, KnowsSinceWhenItsCameraRests) {
    Viewer viewer(1, windowOf(4), nullptr);
    const Clock::time_point start{std::chrono::hours(1)};
    PoseRequest pose = poseWithSeq(1);
    const auto at = [&](int ms) {
        pose.received = start + std::chrono::milliseconds(ms);
        ++pose.seq;
        viewer.setPose(pose);
        return viewer.pose()->since - start;
    };
    EXPECT_EQ(at(10), std::chrono::milliseconds(10));
    EXPECT_EQ(at(20), std::chrono::milliseconds(10)); // the same pose again
    pose.pose.position.x += 1;
    EXPECT_EQ(at(30), std::chrono::milliseconds(30));
}

} // namespace
} // namespace brume
