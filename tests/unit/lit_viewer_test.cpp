// A viewer who draws by itself: which messages it gets, whole or as changes, at which pace.
#include <gtest/gtest.h>

#include "server/viewer/viewer.h"

namespace brume {
namespace {

using namespace std::chrono_literals;

class LitViewer : public testing::Test {
protected:
    LitViewer() {
        PacingOptions pacing;
        pacing.most_frames = 4;
        viewer.emplace(1, pacing, [] {});
        request.seq = 1;
        request.draw_hz = 60;
        viewer->setPose(request);
    }

    // A message goes to the viewer if it is due. Returns what it got: 'w' whole, 'c' changes, '-' none, 'x' it was due
    // and could read neither.
    char give(bool with_whole = true, bool acknowledged = true) {
        now += 16667us;
        ++number;
        if (!rests) ++scene;
        const auto due = viewer->takeLit(number, 60, rests ? INFINITY : most_hz, scene, now);
        if (!due) return '-';
        auto lit = std::make_shared<LitTick>();
        lit->number = number;
        lit->reference = lit::referenceOf(number);
        lit->changes.bytes = {1, 2, 3};
        if (with_whole && due->whole) lit->whole.bytes = {1, 2, 3, 4, 5};
        auto frame = std::make_shared<EncodedFrame>();
        frame->id = due->frame_id;
        frame->lit = lit;
        frame->encoded = now;
        viewer->deliver(frame);
        if (!takes) return '?';
        const FramePtr sent = viewer->takeFrame(now);
        if (!sent) return 'x';
        sent_id = sent->id;
        if (acknowledged) viewer->acknowledge(sent_id, now);
        return sent->lit_whole || sent->lit->reference == 0 ? 'w' : 'c';
    }
    std::string give(int count) {
        std::string all;
        for (int i = 0; i < count; ++i) all += give();
        return all;
    }

    std::optional<Viewer> viewer;
    PoseRequest request;
    Clock::time_point now{1h};
    uint32_t number = 0, sent_id = 0;
    double most_hz = 60;
    uint64_t scene = 0;
    bool rests = false; // True: the scene does not change any more
    bool takes = true;  // False: the connection takes nothing
};

// The first of each layer are whole: 1, 2, 4 and 8.
TEST_F(LitViewer, GetsChangesOnceItHasAReference) { EXPECT_EQ(give(18), "wwcwcccwcccccccccc"); }

TEST_F(LitViewer, WhoComesLaterGetsWholeRowsUntilItHasEachLayer) {
    number = 12;
    EXPECT_EQ(give(14), "wwcwcccccccccc") << "13 and 14 refer to 12, 16 to 8; 15, 17 ... to what it has";
}

TEST_F(LitViewer, SlowerPacesLeaveOutTheUpperLayers) {
    request.seq = 2, request.draw_hz = 30;
    viewer->setPose(request);
    EXPECT_EQ(give(9), "ww-w-c-w-") << "the first in any case";
    most_hz = 15;
    EXPECT_EQ(give(8), "--c---c-");
    most_hz = 1;
    EXPECT_EQ(give(16), "------c-------c-") << "an eighth in any case";
    EXPECT_EQ(number, 33u);
}

TEST_F(LitViewer, WithoutWholeRowsItWaitsForTheNext) {
    number = 12;
    EXPECT_EQ(give(false), 'x');
    EXPECT_EQ(give(), 'w') << "nothing was kept of the one before";
}

TEST_F(LitViewer, AFullWindowSlowsItDownAndBreaksNoChain) {
    give(8);
    std::string all;
    for (int i = 0; i < 60; ++i) {
        all += give(true, false);
        if (i % 6 == 5) viewer->acknowledge(sent_id, now);
    }
    EXPECT_EQ(all.find('x'), all.npos);
    const auto count = [&](char kind) { return std::ranges::count(all, kind); };
    EXPECT_GT(count('-'), 20);
    EXPECT_LT(count('w'), count('c')) << all;
    std::string later;
    for (int i = 0; i < 800; ++i) later += give();
    EXPECT_EQ(later.substr(780), std::string(20, 'c')) << "the whole pace comes back";
}

TEST_F(LitViewer, ASupersededMessageIsNotWhatItHas) {
    give(8);
    takes = false;
    EXPECT_EQ(give(), '?');
    takes = true;
    EXPECT_EQ(give(), 'c') << "10 refers to 8, which it has";
    EXPECT_EQ(give(), 'c');
    takes = false;
    EXPECT_EQ(give(), '?'); // 12, to which 13 and 14 refer
    takes = true;
    EXPECT_EQ(give(), 'w');
}

// Whatever its pace, it gets the state in which the scene rests, once.
TEST_F(LitViewer, TheStateAtRestComesToTheSlowest) {
    most_hz = 1;
    EXPECT_EQ(give(11), "w------w---");
    rests = true;
    EXPECT_EQ(give(3), "c--") << "12 refers to 8, which it has";
    request.seq = 2, request.hidden = true;
    viewer->setPose(request);
    rests = false;
    EXPECT_EQ(give(3), "---");
    rests = true;
    EXPECT_FALSE(viewer->lags(scene, now));
    request.seq = 3, request.hidden = false;
    viewer->setPose(request);
    EXPECT_TRUE(viewer->lags(scene, now)) << "what came while it was hidden";
    EXPECT_NE(give(), '-');
    EXPECT_FALSE(viewer->lags(scene, now));
}

TEST_F(LitViewer, HiddenOrPicturesGetNone) {
    request.seq = 2, request.hidden = true;
    viewer->setPose(request);
    EXPECT_EQ(viewer->drawHz(), 0u);
    EXPECT_EQ(give(), '-');
    request.seq = 3, request.hidden = false, request.draw_hz = 0;
    viewer->setPose(request);
    EXPECT_EQ(give(), '-');
}

} // namespace
} // namespace brume
