// Windows and quality of one viewer, against links that are made up and a clock that the test turns.
#include <deque>

#include <gtest/gtest.h>

#include "server/viewer/pacing.h"
#include "server/viewer/quality.h"

namespace brume::pacing_test {
namespace {

using std::chrono::milliseconds;
using Ms = std::chrono::duration<float, std::milli>;

const Clock::time_point kStart = Clock::time_point{} + std::chrono::hours(1);

// A link of so many bytes a second and a round trip without queues; frames and pings go through one queue, in order.
struct Link {
    double rate; // bytes/s
    milliseconds trip;
    Clock::time_point free = kStart; // when the last byte is out

    Clock::time_point arrivesBack(size_t bytes, Clock::time_point now) {
        free = std::max(free, now) +
               std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(double(bytes) / rate));
        return free + trip;
    }
};

struct Outcome {
    int frames = 0;      // acknowledged
    Ms longest_queue{0}; // after the first three seconds
    Ms longest_pause{0}; // between frames; so on
    uint32_t window = 0, level = 0;
};

// 60 poses a second for `seconds`; frames of `bytes` at the best quality, ten milliseconds to make.
Outcome stream(Link link, size_t bytes, int seconds, bool adapts = false) {
    Pacing pacing{PacingOptions{}};
    QualityControl quality;
    struct Event {
        Clock::time_point at, sent;
        uint32_t frame; // 0: a pong
    };
    std::deque<Event> back;
    Outcome out;
    uint32_t id = 0;
    bool held = false;
    Clock::time_point last = kStart;
    for (Clock::time_point now = kStart; now < kStart + std::chrono::seconds(seconds); now += milliseconds(1)) {
        while (!back.empty() && back.front().at <= now) {
            if (back.front().frame)
                pacing.acknowledged(back.front().frame, now), ++out.frames;
            else
                pacing.ponged(now - back.front().sent, now);
            back.pop_front();
        }
        const auto ms = (now - kStart) / milliseconds(1);
        if (ms % 200 == 0) back.push_back({link.arrivesBack(40, now), now, 0});
        if (ms % 100 == 0) {
            const uint32_t level = quality.level();
            quality.observe({pacing.queueMs(), held, false}, now);
            held = false;
            if (quality.level() < level) pacing.probe();
        }
        if (ms % 17 == 0) {
            held = held || pacing.isHeldByBytes();
            if (pacing.isOpen(now)) {
                const QualityStep step = quality.step();
                const double scale =
                    adapts ? (step.quality < 75 ? double(step.quality) / 110 : 1) * (step.half ? 0.3 : 1) : 1;
                pacing.issued(++id, now);
                if (ms > 3000) out.longest_pause = std::max(out.longest_pause, Ms(now - last));
                last = now;
                const auto size = size_t(double(bytes) * scale);
                pacing.sent(id, size, 10, now);
                back.push_back({link.arrivesBack(size, now), now, id});
            }
        }
        if (ms > 3000) out.longest_queue = std::max(out.longest_queue, Ms(link.free - now));
    }
    out.window = pacing.frames();
    out.level = quality.level();
    return out;
}

TEST(Pacing, AFastLinkGetsEveryFrame) {
    const Outcome out = stream({12.5e6, milliseconds(2)}, 8000, 10);
    EXPECT_GT(out.frames, 570); // of 589
    EXPECT_EQ(out.level, 0u);
    EXPECT_EQ(out.window, 2u);
}

// What is on its way is a round trip's worth: the window follows, up to its end.
TEST(Pacing, ALongLinkGetsAWiderWindow) {
    EXPECT_GT(stream({12.5e6, milliseconds(60)}, 8000, 10).frames, 560);
    const Outcome far = stream({12.5e6, milliseconds(300)}, 8000, 10);
    EXPECT_EQ(far.window, 6u);
    EXPECT_GT(far.frames, 10 * 6 * 1000 / 330 * 9 / 10); // six a round trip,
    EXPECT_LT(far.longest_pause, Ms(2 * 330.0f / 6));    // and not six at once
}

// 1 Mbit/s carries 12 frames of 10 kB a second: rather those than a queue of old ones.
TEST(Pacing, ANarrowLinkGetsFewerFramesNotOlderOnes) {
    const Outcome out = stream({125e3, milliseconds(20)}, 10000, 20);
    EXPECT_GT(out.frames, 20 * 12 * 7 / 10);
    EXPECT_LT(out.longest_queue.count(), 260); // two frames and the one being sent take 80 ms each
}

TEST(Pacing, QualityMakesRoomOnANarrowLink) {
    const Outcome as_it_is = stream({125e3, milliseconds(20)}, 10000, 20),
                  adapted = stream({125e3, milliseconds(20)}, 10000, 20, true);
    EXPECT_GT(adapted.frames, 2 * as_it_is.frames);
    EXPECT_GT(adapted.level, 0u);
    // Also where a step up is tried and taken back: 58 ms a frame of the least quality, 17 of half the size.
    const Outcome swings = stream({125e3, milliseconds(20)}, 20000, 60, true);
    EXPECT_LT(swings.longest_queue, Ms(100));
}

TEST(Pacing, SilenceStopsRendering) {
    Pacing pacing{PacingOptions{.least_frames = 6, .most_frames = 6}};
    pacing.issued(1, kStart);
    EXPECT_TRUE(pacing.isOpen(kStart + std::chrono::seconds(60))); // nothing was sent: nobody owes an answer
    pacing.sent(1, 1000, 10, kStart);
    EXPECT_TRUE(pacing.isOpen(kStart + milliseconds(1900)));
    EXPECT_FALSE(pacing.isOpen(kStart + milliseconds(2100)));
    pacing.acknowledged(1, kStart + milliseconds(2200));
    EXPECT_TRUE(pacing.isOpen(kStart + milliseconds(2200)));
    // A link of half a second is given eight round trips.
    pacing.ponged(milliseconds(500), kStart + milliseconds(2200));
    pacing.issued(2, kStart + milliseconds(2200));
    pacing.sent(2, 1000, 10, kStart + milliseconds(2200));
    EXPECT_TRUE(pacing.isOpen(kStart + milliseconds(6000)));
    EXPECT_FALSE(pacing.isOpen(kStart + milliseconds(6300)));
    EXPECT_EQ(pacing.silence(kStart + milliseconds(6300)), milliseconds(4100));
}

TEST(Pacing, TheBaseRoundTripForgetsAfterTenSeconds) {
    Pacing pacing{PacingOptions{}};
    pacing.ponged(milliseconds(5), kStart);
    for (int s = 1; s < 9; ++s) pacing.ponged(milliseconds(40), kStart + std::chrono::seconds(s));
    EXPECT_FLOAT_EQ(pacing.baseRoundTripMs(), 5);
    EXPECT_FLOAT_EQ(pacing.queueMs(), 35);
    for (int s = 9; s < 13; ++s) pacing.ponged(milliseconds(40), kStart + std::chrono::seconds(s));
    EXPECT_FLOAT_EQ(pacing.baseRoundTripMs(), 40); // the way is longer now
}

TEST(Pacing, ABusyProgramBehindAQuickLinkIsNoQueue) {
    Pacing pacing{PacingOptions{}};
    pacing.ponged(milliseconds(1), kStart);
    pacing.issued(1, kStart);
    pacing.sent(1, 10'000, 10, kStart);
    pacing.acknowledged(1, kStart);
    pacing.ponged(milliseconds(200), kStart + milliseconds(200), milliseconds(2));
    EXPECT_FLOAT_EQ(pacing.queueMs(), 2);
    EXPECT_FALSE(pacing.bytes());
    pacing.ponged(milliseconds(200), kStart + milliseconds(400), milliseconds(300)); // now it is the link
    EXPECT_FLOAT_EQ(pacing.queueMs(), 199);
    EXPECT_TRUE(pacing.bytes());
}

TEST(Quality, DownAtOnceUpAfterACleanSecond) {
    QualityControl quality;
    Clock::time_point now = kStart;
    EXPECT_TRUE(quality.observe({60, false, false}, now));
    EXPECT_EQ(quality.level(), 1u);
    EXPECT_FALSE(quality.observe({60, false, false}, now += milliseconds(100))); // every 250 ms
    EXPECT_TRUE(quality.observe({0, false, true}, now += milliseconds(150)));
    EXPECT_EQ(quality.level(), 2u);
    for (int i = 0; i < 3; ++i) EXPECT_FALSE(quality.observe({0, false, false}, now += milliseconds(250)));
    EXPECT_TRUE(quality.observe({0, false, false}, now += milliseconds(250)));
    EXPECT_EQ(quality.level(), 1u);
    EXPECT_FALSE(quality.observe({30, false, false}, now += milliseconds(250))); // neither clean nor bad: as it is
    for (int i = 0; i < 40; ++i) quality.observe({0, true, false}, now += milliseconds(250));
    EXPECT_EQ(quality.level(), QualityControl::kSteps - 1);
}

// A link that carries level 1 and not level 0.
TEST(Quality, AStepThatHadToBeTakenBackIsTriedAgainLaterAndLater) {
    QualityControl quality;
    Clock::time_point now = kStart;
    quality.observe({60, false, false}, now);
    const auto untilUp = [&] {
        const Clock::time_point since = now;
        while (quality.level() > 0) quality.observe({0, false, false}, now += milliseconds(250));
        return (now - since) / milliseconds(1);
    };
    const auto down = [&](int after_ms) {
        while (after_ms > 0) quality.observe({0, false, false}, now += milliseconds(250)), after_ms -= 250;
        EXPECT_TRUE(quality.observe({60, false, false}, now += milliseconds(250)));
    };
    EXPECT_EQ(untilUp(), 1000);
    for (const int wait : {2000, 4000, 8000, 16000, 16000}) {
        down(250);
        EXPECT_EQ(untilUp(), wait);
    }
    down(3000); // it held for a while: what came now is news
    EXPECT_EQ(untilUp(), 1000);
}

TEST(Quality, EveryStepIsLessThanTheOneBefore) {
    for (uint32_t level = 1; level < QualityControl::kSteps; ++level) {
        const QualityStep a = QualityControl::stepAt(level - 1), b = QualityControl::stepAt(level);
        EXPECT_TRUE(b.quality <= a.quality && b.half >= a.half && b.every >= a.every) << level;
        EXPECT_TRUE(b.quality < a.quality || b.half > a.half || b.every > a.every) << level;
    }
}

} // namespace
} // namespace brume::pacing_test
